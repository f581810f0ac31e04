/// What no closed loop shows (haptics_facts.md §4): free rotation, the quaternion, impacts, slopes.

#include <gtest/gtest.h>

#include <cmath>

#include "core/dynamics/contact_response.h"
#include "tests/core/dynamics/shapes.h"

namespace palpate::stability {
namespace {

MassProperties massOf(double mass, const Eigen::Vector3d& principal) {
  MassProperties m;
  m.mass = mass;
  m.I_C = principal.asDiagonal();
  return m;
}

struct Shape {
  const char* name;
  Eigen::Vector3d principal;  // kg·m², I1 <= I2 + I3
  bool extreme;
};
const Shape kShapes[] = {
    {"sphere", {1e-5, 1e-5, 1e-5}, false},       {"block", {1e-5, 2e-5, 2.5e-5}, false},
    {"disc", {1e-5, 1e-5, 2e-5}, false},         {"thin disc", {1e-5, 1e-5 + 1e-9, 2e-5}, false},
    {"needle 1:1e2", {1e-5, 1e-5, 1e-7}, false}, {"needle 1:1e3", {1e-5, 1e-5, 1e-8}, false},
    {"needle 1:1e4", {1e-5, 1e-5, 1e-9}, true}};

TEST(FreeBody, KeepsMomentumAndEnergyForAMinuteAtEveryStep) {
  for (const Shape& shape : kShapes) {
    for (const double h : {0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3}) {
      for (const double rate : {1.0, 10.0, 50.0}) {
        SCOPED_TRACE(testing::Message() << shape.name << " h " << h << " rate " << rate);
        RigidBody body(massOf(0.05, shape.principal));
        body.setTwist({0, 0, 0}, rate * Eigen::Vector3d(1.0, 0.3, 0.2).normalized());
        const double E = body.kineticEnergy();
        const Eigen::Vector3d L = body.angularMomentum();
        double worst = 0.0;
        for (int i = 0; i < static_cast<int>(60.0 / h); ++i) {
          body.integratePose(h);
          worst = std::max(worst, std::abs(body.kineticEnergy() - E) / E);
        }
        EXPECT_LE((body.angularMomentum() - L).norm(), 1e-9 * L.norm());
        EXPECT_LE(worst, shape.extreme && rate >= 50.0 ? 2e-3 : 1e-5);
      }
    }
  }
}

TEST(FreeBody, TheQuaternionStaysAUnitOneOverTenMillionSteps) {
  RigidBody body(massOf(0.05, {1e-5, 2e-5, 2.5e-5}));
  body.setTwist({0, 0, 0}, 100.0 * Eigen::Vector3d(0.5, 0.5, 0.7).normalized());
  double worst = 0.0;
  for (int i = 0; i < 10'000'000; ++i) {
    body.integratePose(1e-3);
    if (i % 100 == 0) worst = std::max(worst, std::abs(body.orientation().norm() - 1.0));
  }
  EXPECT_LE(worst, 1e-12);
}

ContactResponse strike(const RigidBody& body, const Contact& c, double friction,
                       double restitution) {
  ContactResolver resolver;
  SurfaceTable surface{};
  surface[1] = {friction, restitution};
  ContactBody moving;
  moving.p_WC = body.centre();
  moving.twist << body.velocity(), body.angularVelocity();
  moving.mobility = body.mobility();
  return resolver.resolveContacts(moving, {&c, 1}, surface, {}, 1e-3);
}

TEST(Impact, KeepsMomentumAndNeverGainsEnergy) {
  for (const double e : {0.0, 0.5, 1.0}) {
    for (const double mu : {0.0, 0.3, 1.0}) {
      for (const double off : {0.0, 0.005, 0.02, 0.05}) {
        for (const double along : {0.0, 0.1, 1.0}) {
          SCOPED_TRACE(testing::Message()
                       << "e " << e << " mu " << mu << " off " << off << " along " << along);
          RigidBody body(massOf(0.05, {1e-5, 2e-5, 2.5e-5}));
          const Eigen::Vector3d w(1.0, -2.0, 0.5);
          body.setTwist({along, 0.5 * along, -0.3}, w);
          const Contact c = test::contactAt({off, 0.5 * off, -0.01}, {0, 0, 1}, 2e-5);
          const ContactResponse r = strike(body, c, mu, e);
          Vector6d before;
          before << body.velocity(), body.angularVelocity();
          const Matrix6d M = body.inertia();
          const Vector6d change = M * (r.twist - before);
          EXPECT_LE((change - r.impulse).norm(), 1e-12 * (M * before).norm());
          EXPECT_LE(r.twist.dot(M * r.twist), before.dot(M * before) * (1.0 + 1e-12));
          const Eigen::Vector3d p(off, 0.5 * off, -0.01);
          const double in = before[2] + w.cross(p).z();
          const double out = r.twist[2] + r.twist.tail<3>().cross(p).z();
          if (in < -0.02) {
            // Newton's where nothing rubs. Friction turns an off-centre body, which may take from
            // the rebound (the impulses are bounded by energy) but never adds to it.
            EXPECT_GE(out, mu == 0.0 ? -e * in - 1e-5 : -1e-5);
            EXPECT_LE(out, -e * in + 1e-5);
          }
          EXPECT_LE(r.impulse.head<2>().norm(), mu * r.impulse[2] + 1e-12);
        }
      }
    }
  }
}

TEST(Slope, ABodySticksIfAndOnlyIfTanAlphaIsAtMostMu) {
  for (const double mu : {0.1, 0.3, 0.6, 1.0}) {
    for (const double excess : {-0.1, -0.01, -0.001, 0.001, 0.01, 0.1}) {
      SCOPED_TRACE(testing::Message() << "mu " << mu << " beyond by " << excess << " rad");
      const double alpha = std::atan(mu) + excess;
      RigidBody body(massOf(0.05, {1e-5, 1e-5, 1e-5}));
      const Eigen::Vector3d g(9.81 * std::sin(alpha), 0, -9.81 * std::cos(alpha));
      const Contact c = test::contactAt({0, 0, 0}, {0, 0, 1}, 2e-5);
      Eigen::Vector3d v(0, 0, 0);
      for (int i = 0; i < 100; ++i) {
        body.setTwist(v + 1e-3 * g, {0, 0, 0});
        v = strike(body, c, mu, 0.0).twist.head<3>();
      }
      const double slides = 0.1 * 9.81 * (std::sin(alpha) - mu * std::cos(alpha));
      EXPECT_NEAR(v.norm(), std::max(0.0, slides), 1e-10);
    }
  }
}

}  // namespace
}  // namespace palpate::stability
