#include "core/dynamics/tool_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/dynamics/shapes.h"

namespace palpate {
namespace {

using test::contactAt;

MassProperties rod(double mass) {
  MassProperties m;
  m.mass = mass;
  m.p_TC = {0.0, 0.0, 0.06};
  const double across = mass * 0.12 * 0.12 / 12.0;
  m.I_C = Eigen::Vector3d(across, across, 0.5 * mass * 1.6e-5).asDiagonal();
  return m;
}

ToolTarget at(const Eigen::Vector3d& p,
              const Eigen::Quaterniond& q = Eigen::Quaterniond::Identity()) {
  ToolTarget t;
  t.pose = plain(p, q);
  return t;
}

SurfaceTable surface(double friction) {
  SurfaceTable t{};
  t[1] = {friction, 0.0};
  return t;
}

/// haptics_facts.md §4: 1e-4 to 10 kg, 0.2 to 10 ms, far beyond the explicit limit. The spring is
/// stretched by 5 mm and 0.2 rad and let go: it must come to rest on the device, not beyond reason.
TEST(ToolBody, SettlesOnTheDeviceAtAnyMassAndStep) {
  for (const double mass : {1e-4, 1e-3, 0.02, 0.1, 0.5, 10.0}) {
    for (const double h : {2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2}) {
      ToolBody tool(rod(mass), {});
      ASSERT_TRUE(tool.reset({}));
      const ToolTarget target = at({0.005, 0, 0}, expMap({0, 0.2, 0}));
      double overshoot = 0.0;
      for (double t = 0.0; t < 8.0; t += h) {
        ASSERT_TRUE(tool.applyCoupling(target, h));
        tool.advance(h);
        overshoot = std::max(overshoot, tool.pose().p[0] - 0.005);
      }
      EXPECT_NEAR(tool.pose().p[0], 0.005, 5e-5) << mass << " kg, " << h << " s";
      EXPECT_LT(overshoot, 0.005) << mass << " kg, " << h << " s";
      EXPECT_LT(tool.originVelocity().norm(), 1e-3) << mass << " kg, " << h << " s";
    }
  }
}

TEST(ToolBody, HeavyToolsAreDampedToZetaOfSevenTenths) {
  // A central body (no lever): the overshoot of a second-order system of ζ = 0.7 is 4.6 %.
  MassProperties m;
  m.mass = 0.5;
  m.I_C = Eigen::Matrix3d::Identity() * 1e-4;
  ToolBody tool(m, {});
  tool.reset({});
  double most = 0.0;
  for (int i = 0; i < 20000; ++i) {
    tool.applyCoupling(at({0.01, 0, 0}), 1e-4);
    tool.advance(1e-4);
    most = std::max(most, tool.pose().p[0]);
  }
  EXPECT_NEAR(most / 0.01 - 1.0, 0.046, 0.006);
}

TEST(ToolBody, SteadyMotionMakesNoForce) {
  // The device moves evenly; after the start the tool is where the device is, at the step's end.
  ToolBody tool(rod(0.1), {});
  tool.reset({});
  const double h = 1e-3, v = 0.1;
  ToolTarget target = at(Eigen::Vector3d::Zero());
  target.v[0] = v;
  for (int i = 0; i < 3000; ++i) {
    target.pose.p[0] = v * h * i;
    tool.applyCoupling(target, h);
    tool.advance(h);
  }
  EXPECT_NEAR(tool.pose().p[0], v * h * 3000, 1e-9);
  EXPECT_NEAR(tool.originVelocity().x(), v, 1e-9);
}

// In rest the contact's force is the coupling's: K · depth of the device, not an artefact of the
// step or of the mass.
TEST(ToolBody, ThePressedContactCarriesTheCouplingsForce) {
  for (const double mass : {0.005, 0.05, 0.5}) {
    for (const double h : {1e-3, 5e-3}) {
      ToolBody tool(rod(mass), {});
      tool.reset({});
      ContactResolver resolver;
      for (double t = 0.0; t < 2.0; t += h) {
        tool.applyCoupling(at({0, 0, -0.002}), h);
        const double depth = -tool.pose().p[2];
        const Contact c = contactAt({tool.pose().p[0], tool.pose().p[1], tool.pose().p[2]},
                                    {0, 0, 1}, std::max(depth, 0.0));
        (void)tool.resolve(resolver, {&c, depth > 0.0 ? 1u : 0u}, surface(0.2), {}, h);
        tool.advance(h);
      }
      EXPECT_NEAR(tool.contactWrench()[2], 600.0 * (0.002 - 2e-5), 0.02)
          << mass << " kg, " << h << " s";
      EXPECT_LT(std::abs(tool.pose().p[2]), 4e-5);
    }
  }
}

TEST(ToolBody, NoPointMovesFartherThanItMay) {
  ToolSettings settings;
  settings.maxTravel = 1e-3;
  settings.reach = 0.12;
  ToolBody tool(rod(0.05), settings);
  tool.reset({});
  const Eigen::Vector3d far_T(0, 0, 0.12);
  bool capped = false;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d before = tool.X_WT() * far_T, tip = tool.X_WT().translation();
    tool.applyCoupling(at({0.1, 0.05, 0}, expMap({0, 3.0, 0})), 1e-3);
    capped = capped || tool.speedCapped();
    tool.advance(1e-3);
    // 1 % for the arc against its chord and the momentum midpoint.
    ASSERT_LE((tool.X_WT() * far_T - before).norm(), 1.01e-3);
    ASSERT_LE((tool.X_WT().translation() - tip).norm(), 1.01e-3);
  }
  EXPECT_TRUE(capped);
}

TEST(ToolBody, ATargetThatIsNoPoseIsIgnored) {
  ToolBody tool(rod(0.05), {});
  tool.reset({});
  ToolTarget bad = at({0, 0, 0});
  bad.pose.p[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(tool.applyCoupling(bad, 1e-3));
  bad = at({0, 0, 0});
  bad.v[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(tool.applyCoupling(bad, 1e-3));
  tool.advance(1e-3);
  EXPECT_TRUE(isRigid(tool.pose()));
}

TEST(ToolBody, ADeepStartLeavesNoFasterThanTenCentimetresASecond) {
  ToolBody tool(rod(0.05), {});
  tool.reset({});
  ContactResolver resolver;
  double z = -0.01;
  tool.reset(plain(Eigen::Vector3d(0, 0, z), Eigen::Quaterniond::Identity()));
  for (int i = 0; i < 500; ++i) {
    tool.applyCoupling(at({0, 0, -0.01}), 1e-3);
    const Contact c = contactAt(position(tool.pose()), {0, 0, 1}, std::max(0.0, -z));
    (void)tool.resolve(resolver, {&c, z < 0.0 ? 1u : 0u}, surface(0.2), {}, 1e-3);
    tool.advance(1e-3);
    const double moved = tool.pose().p[2] - z;
    ASSERT_LE(moved, 0.1 * 1e-3 + 1e-6);
    z = tool.pose().p[2];
  }
  EXPECT_GT(z, -5e-5);
}

}  // namespace
}  // namespace palpate
