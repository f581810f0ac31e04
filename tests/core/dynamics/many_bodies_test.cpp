#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/dynamics/contact_response.h"
#include "tests/core/dynamics/shapes.h"

namespace palpate {
namespace {

using test::contactAt;
using test::randomVector;
constexpr double kStep = 1e-3;

SurfaceTable surface(double friction, double restitution) {
  SurfaceTable t{};
  t[1] = {friction, restitution};
  return t;
}

ContactBody bodyOf(double mass, const Eigen::Vector3d& inertia, const Eigen::Vector3d& p,
                   const Eigen::Vector3d& v, const Eigen::Vector3d& w = {0, 0, 0}) {
  ContactBody b;
  b.p_WC = p;
  b.twist << v, w;
  b.mobility.setZero();
  b.mobility.diagonal() << Eigen::Vector3d::Constant(1.0 / mass), inertia.cwiseInverse();
  return b;
}

/// Linear momentum, and angular about the origin of W.
Vector6d momentumOf(const ContactBody& b, const Vector6d& twist) {
  const Vector6d own = b.mobility.inverse() * twist;
  Vector6d m = own;
  m.tail<3>() += b.p_WC.cross(own.head<3>());
  return m;
}

double energyOf(const ContactBody& b, const Vector6d& twist) {
  return 0.5 * twist.dot(b.mobility.inverse() * twist);
}

Eigen::Vector3d velocityAt(const ContactBody& b, const Vector6d& twist, const Contact& c) {
  return twist.head<3>() + twist.tail<3>().cross(Eigen::Vector3d(c.p[0], c.p[1], c.p[2]) - b.p_WC);
}

TEST(ManyBodies, TwoBallsMeetHeadOnAsTheClosedFormSays) {
  for (const double e : {0.0, 0.5, 1.0}) {
    const ContactBody bodies[] = {bodyOf(0.02, {1e-6, 1e-6, 1e-6}, {-0.01, 0, 0}, {0.3, 0, 0}),
                                  bodyOf(0.05, {2e-6, 2e-6, 2e-6}, {0.01, 0, 0}, {-0.1, 0, 0})};
    const Contact c = contactAt({0, 0, 0}, {-1, 0, 0}, 2e-5);  // out of the second body
    const SurfaceTable table = surface(0.3, e);
    const ContactSet set{0, 1, {&c, 1}, &table};
    BodyResponse out[2];
    ContactResolver resolver(2);
    const auto effort = resolver.resolve(bodies, {&set, 1}, {}, kStep, out);
    EXPECT_EQ(effort.iterations, 1u);
    // m1 v1 + m2 v2 and the closing speed times -e.
    const double v1 = (0.02 * 0.3 - 0.05 * 0.1 - e * 0.05 * 0.4) / 0.07;
    EXPECT_NEAR(out[0].twist[0], v1, 1e-14) << e;
    EXPECT_NEAR(out[1].twist[0], v1 + e * 0.4, 1e-14) << e;
  }
}

TEST(ManyBodies, ABodyThatIsImmovableIsTheAnatomy) {
  std::mt19937_64 random(41);
  ContactResolver one, two(2);
  for (int trial = 0; trial < 100; ++trial) {
    const ContactBody moving = bodyOf(0.05, {1e-5, 2e-5, 2e-5}, randomVector(random, 0.02),
                                      randomVector(random, 0.3), randomVector(random, 5.0));
    ContactBody wall;
    wall.mobility.setZero();
    std::vector<Contact> contacts;
    for (int i = 0; i < 20; ++i) {
      contacts.push_back(
          contactAt(randomVector(random, 0.02), randomVector(random, 1.0).normalized(), 1e-4));
    }
    const SurfaceTable table = surface(0.4, 0.0);
    const auto alone = one.resolveContacts(moving, contacts, table, {}, kStep);
    const ContactBody bodies[] = {moving, wall};
    const ContactSet set{0, 1, contacts, &table};
    BodyResponse out[2];
    ResponseSettings settings;
    settings.iterations = 100;  // a body: the cap of an island of two is that of one alone
    (void)two.resolve(bodies, {&set, 1}, settings, kStep, out);
    ASSERT_LT((out[0].twist - alone.twist).norm(), 1e-9 * (1.0 + alone.twist.norm())) << trial;
    EXPECT_EQ(out[1].twist, Vector6d::Zero());
  }
}

TEST(ManyBodies, MomentumStaysAndEnergyNeverRises) {
  constexpr int kSeed = 29;
  std::mt19937_64 random(kSeed);
  ContactResolver resolver(6);
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<ContactBody> bodies;
    for (int i = 0; i < 6; ++i) {
      const double heavy = std::pow(10.0, -i);  // 10 kg to 100 mg
      bodies.push_back(bodyOf(10 * heavy, Eigen::Vector3d(1e-3, 2e-3, 2.5e-3) * heavy,
                              randomVector(random, 0.05), randomVector(random, 0.3),
                              randomVector(random, 5.0)));
    }
    const SurfaceTable table = surface((trial % 4) * 0.35, (trial % 3) * 0.5);
    std::vector<std::vector<Contact>> contacts(15);
    std::vector<ContactSet> sets;
    std::size_t next = 0;
    for (std::uint16_t a = 0; a < 6; ++a) {
      for (std::uint16_t b = 0; b < a; ++b, ++next) {
        for (int i = 0; i < trial % 7; ++i) {
          contacts[next].push_back(
              contactAt(randomVector(random, 0.05), randomVector(random, 1.0).normalized(), 1e-4));
        }
        sets.push_back({a, b, contacts[next], &table});
      }
    }
    std::vector<BodyResponse> out(6);
    const auto effort = resolver.resolve(bodies, sets, {}, kStep, out);
    Vector6d before = Vector6d::Zero(), after = before, impulses = before;
    double energyBefore = 0.0, energyAfter = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
      before += momentumOf(bodies[i], bodies[i].twist);
      after += momentumOf(bodies[i], out[i].twist);
      impulses.head<3>() += out[i].impulse.head<3>();
      energyBefore += energyOf(bodies[i], bodies[i].twist);
      energyAfter += energyOf(bodies[i], out[i].twist);
    }
    ASSERT_LE((after - before).norm(), 1e-12 * before.norm()) << "seed " << kSeed << " " << trial;
    ASSERT_LE(impulses.norm(), 1e-12 * before.norm()) << trial;
    ASSERT_LE(energyAfter, energyBefore * (1.0 + 1e-12)) << "seed " << kSeed << " " << trial;
    if (effort.capReached) continue;
    for (const ContactSet& set : sets) {
      for (const Contact& c : set.contacts_W) {
        const Eigen::Vector3d u = velocityAt(bodies[set.body], out[set.body].twist, c) -
                                  velocityAt(bodies[set.other], out[set.other].twist, c);
        ASSERT_GE(u.dot(Eigen::Vector3d(c.n[0], c.n[1], c.n[2])), -1.1e-5) << trial;
      }
    }
  }
}

TEST(ManyBodies, IslandsDoNotSeeEachOther) {
  const ContactBody bodies[] = {bodyOf(0.05, {1e-5, 1e-5, 1e-5}, {0, 0, 0}, {0.1, 0, -0.3}),
                                bodyOf(0.02, {1e-6, 1e-6, 1e-6}, {1, 0, 0}, {0.2, 0.1, -0.2}),
                                bodyOf(0.03, {1e-6, 2e-6, 2e-6}, {1, 0, 0.02}, {0, 0, -0.4})};
  const Contact floor = contactAt({0.001, 0, -0.01}, {0, 0, 1}, 5e-5);
  const Contact between = contactAt({1.002, 0, 0.01}, {0, 0.1, std::sqrt(0.99)}, 5e-5);
  const SurfaceTable table = surface(0.3, 0.2);
  const ContactSet sets[] = {{0, kAnatomy, {&floor, 1}, &table}, {2, 1, {&between, 1}, &table}};
  ContactResolver resolver(3);
  BodyResponse together[3], first[3], second[3];
  (void)resolver.resolve(bodies, sets, {}, kStep, together);
  (void)resolver.resolve(bodies, {sets, 1}, {}, kStep, first);
  (void)resolver.resolve(bodies, {sets + 1, 1}, {}, kStep, second);
  EXPECT_EQ(together[0].twist, first[0].twist);
  EXPECT_EQ(together[1].twist, second[1].twist);
  EXPECT_EQ(together[2].twist, second[2].twist);
  EXPECT_EQ(first[1].twist, bodies[1].twist);
  EXPECT_EQ(second[0].twist, bodies[0].twist);
}

TEST(ManyBodies, PenetrationGoesWithoutVelocityAndTheLighterGivesWay) {
  const ContactBody bodies[] = {bodyOf(0.01, {1e-6, 1e-6, 1e-6}, {0, 0, 0.01}, {0, 0, 0}),
                                bodyOf(0.09, {1e-5, 1e-5, 1e-5}, {0, 0, -0.01}, {0, 0, 0})};
  const Contact c = contactAt({0, 0, 0}, {0, 0, 1}, 1e-4);
  const SurfaceTable table = surface(0.3, 0.0);
  const ContactSet set{0, 1, {&c, 1}, &table};
  ContactResolver resolver(2);
  BodyResponse out[2];
  const ResponseSettings settings;
  (void)resolver.resolve(bodies, {&set, 1}, settings, kStep, out);
  const double push = settings.pushFraction * (1e-4 - settings.allowedDepth);
  EXPECT_NEAR(out[0].shift[2] - out[1].shift[2], push, 2e-9);
  EXPECT_NEAR(out[0].shift[2] / -out[1].shift[2], 9.0, 1e-9);
  EXPECT_EQ(out[0].twist, Vector6d::Zero());
  EXPECT_EQ(out[1].twist, Vector6d::Zero());
}

TEST(ManyBodies, SetsThatMakeNoSenseAreLeftOut) {
  ContactBody bodies[] = {bodyOf(0.05, {1e-5, 1e-5, 1e-5}, {0, 0, 0}, {0, 0, -0.3}),
                          bodyOf(0.05, {1e-5, 1e-5, 1e-5}, {0, 0, -0.02}, {0, 0, 0})};
  bodies[1].twist[0] = std::nan("");
  const Contact c = contactAt({0, 0, -0.01}, {0, 0, 1}, 5e-5);
  const SurfaceTable table = surface(0.3, 0.0);
  const ContactSet sets[] = {{0, 1, {&c, 1}, &table},
                             {0, 0, {&c, 1}, &table},
                             {0, 7, {&c, 1}, &table},
                             {0, kAnatomy, {}, &table}};
  ContactResolver resolver(2);
  BodyResponse out[2];
  const auto effort = resolver.resolve(bodies, {sets, 3}, {}, kStep, out);
  EXPECT_EQ(effort.iterations, 0u);
  EXPECT_EQ(out[0].twist, bodies[0].twist);
}

}  // namespace
}  // namespace palpate
