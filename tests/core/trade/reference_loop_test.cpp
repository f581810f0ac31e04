#include "core/trade/reference_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/geometry/pose.h"

namespace palpate {
namespace {

constexpr double kRadius = 3e-3;

/// A ball about T's origin, evenly covered with points.
ReferenceTool ballTool(double friction) {
  ReferenceTool tool;
  tool.mass.mass = 0.02;
  tool.mass.I_C = Eigen::Matrix3d::Identity() * 1e-6;
  constexpr int kPoints = 4000;
  for (int i = 0; i < kPoints; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / kPoints;
    const double turn = std::numbers::pi * (1.0 + std::sqrt(5.0)) * i, r = std::sqrt(1.0 - z * z);
    tool.points_T.push_back(kRadius * Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z));
  }
  tool.stiffness = 600.0;
  tool.damping = 2.0;
  tool.stiffnessR = 0.24;
  tool.dampingR = 8e-4;
  if (friction > 0.0) tool.frictionAt = [friction](const Eigen::Vector3d&) { return friction; };
  return tool;
}

std::vector<DeviceSample> path(const Eigen::Vector3d& from, const Eigen::Vector3d& to, int ticks,
                               int still) {
  std::vector<DeviceSample> samples;
  for (int i = 0; i < ticks + still; ++i) {
    DeviceSample sample;
    sample.index = samples.size();
    const double part = std::min(1.0, static_cast<double>(i) / ticks);
    sample.pose = plain(from + part * (to - from), Eigen::Quaterniond::Identity());
    const Eigen::Vector3d v = i < ticks ? Eigen::Vector3d((to - from) / (1e-3 * ticks))
                                        : Eigen::Vector3d(Eigen::Vector3d::Zero());
    std::copy_n(v.data(), 3, sample.v);
    samples.push_back(sample);
  }
  return samples;
}

class Pressed : public testing::TestWithParam<KnownShape> {};
INSTANTIATE_TEST_SUITE_P(All, Pressed,
                         testing::Values(KnownShape::Sphere, KnownShape::Plane,
                                         KnownShape::Cylinder, KnownShape::Wedge,
                                         KnownShape::Torus),
                         [](const auto& row) { return std::string(nameOf(row.param)); });

TEST_P(Pressed, ABallRestsARadiusAboveTheTopAndTheForceIsThatOfTheSpring) {
  const auto shape = closedForm(GetParam());
  const Eigen::Vector3d top = topOf(GetParam()), up = Eigen::Vector3d::UnitZ();
  const double pressed = 2e-3;
  const auto samples = path(top + 8e-3 * up, top + (kRadius - pressed) * up, 500, 300);
  const auto run = runReference(ballTool(0.0), *shape, samples);
  // Between points the ball is lower by at most their spacing's sagitta; the edge of a wedge
  // passes between them.
  const double lower = GetParam() == KnownShape::Wedge ? 6e-5 : 5e-6;
  EXPECT_NEAR((position(run.tool.back()) - top).z(), kRadius, lower);
  EXPECT_NEAR((position(run.tool.back()) - top).head<2>().norm(), 0.0, 5e-5);
  const double force = 600.0 * (position(run.tool.back()) - position(samples.back().pose)).z();
  EXPECT_NEAR(force, 600.0 * pressed, 600.0 * lower + 2e-3);
  EXPECT_LT(run.v.back().norm(), 1e-4);
}

TEST(ReferenceLoop, NeverLetsTheToolIn) {
  const auto shape = closedForm(KnownShape::Plane);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const auto run =
      runReference(ballTool(0.3), *shape, path(20e-3 * up, -10e-3 * up, 150, 100));  // 0.2 m/s
  for (const PlainPose& pose : run.tool) EXPECT_GT(position(pose).z(), kRadius - 1e-5);
}

TEST(ReferenceLoop, SlidingFrictionIsItsShareOfTheNormalForce) {
  constexpr double kFriction = 0.3;
  const auto shape = closedForm(KnownShape::Plane);
  auto samples = path({-10e-3, 0, 4e-3}, {-10e-3, 0, 1e-3}, 200, 100);
  for (const auto& s : path({-10e-3, 0, 1e-3}, {10e-3, 0, 1e-3}, 1000, 0)) samples.push_back(s);
  ReferenceTool tool = ballTool(kFriction);
  tool.stiffnessR = 1e3;  // does not roll
  const auto run = runReference(tool, *shape, samples);
  const Eigen::Vector3d lag = position(run.tool[1200]) - position(samples[1201].pose);
  EXPECT_NEAR(lag.z(), 2e-3, 1e-5);
  EXPECT_NEAR(-lag.x() / lag.z(), kFriction, 0.01);
  EXPECT_NEAR(lag.y(), 0.0, 1e-5);
}

TEST(ReferenceLoop, FreeMotionFollowsTheHand) {
  const auto shape = closedForm(KnownShape::Plane);
  const auto samples = path({0, 0, 20e-3}, {30e-3, 0, 20e-3}, 500, 0);
  const auto run = runReference(ballTool(0.3), *shape, samples);
  EXPECT_LT((position(run.tool[398]) - position(samples[399].pose)).norm(), 1e-6);
}

TEST(ReferenceLoop, ATurnedHandTurnsTheTool) {
  const auto shape = closedForm(KnownShape::Plane);
  std::vector<DeviceSample> samples(600);
  const Eigen::Quaterniond goal(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 1, 0).normalized()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].index = i;
    samples[i].pose =
        plain(Eigen::Vector3d(0, 0, 20e-3), i == 0 ? Eigen::Quaterniond::Identity() : goal);
  }
  const auto run = runReference(ballTool(0.0), *shape, samples);
  EXPECT_LT(orientation(run.tool.back()).angularDistance(goal), 1e-4);
}

/// Two walls that come together below, and push sideways only: nothing keeps a hand from driving a
/// tool in.
class Vice final : public ReferenceShape {
 public:
  double distance(const Eigen::Vector3d& p) const override {
    return 2e-3 + 0.1 * p.z() - std::abs(p.x());
  }
  double clearance(const Eigen::Vector3d& p, double margin) const override {
    return distance(p) - margin;
  }
  Eigen::Vector3d normal(const Eigen::Vector3d& p) const override {
    return {p.x() > 0.0 ? -1.0 : 1.0, 0.0, 0.0};
  }
};

TEST(ReferenceLoop, ThatCannotSettleSaysSoAndEnds) {
  ReferenceTool tool = ballTool(0.0);
  tool.points_T = {{-1.9e-3, 0, 0}, {1.9e-3, 0, 0}};
  const auto down = path({0, 0, 0}, {0, 0, -10e-3}, 200, 0);
  const ReferenceRun run = runReference(tool, Vice{}, down);
  EXPECT_FALSE(run.settled);
  EXPECT_LT(run.tool.size(), down.size());
  // Narrower where the tool has room: a millimetre down at 0.1.
  ASSERT_FALSE(run.tool.empty());
  EXPECT_LT(run.tool.back().p[2], -1e-3);
  const ReferenceRun fits = runReference(tool, Vice{}, path({0, 0, 5e-3}, {0, 0, 0}, 200, 0));
  EXPECT_TRUE(fits.settled);
  EXPECT_EQ(fits.tool.size(), 200U);
}

TEST(ReferenceLoop, AStartInsideComesOutAndIsNoLoss) {
  const ReferenceTool tool = ballTool(0.0);
  const auto shape = closedForm(KnownShape::Plane);
  const Eigen::Vector3d start(0, 0, topOf(KnownShape::Plane).z() + kRadius - 0.5e-3);
  const ReferenceRun run = runReference(tool, *shape, path(start, start, 1, 200));
  EXPECT_TRUE(run.settled);
  ASSERT_EQ(run.tool.size(), 201U);
  EXPECT_NEAR(run.tool.back().p[2], start.z() + 0.5e-3, 0.05e-3);
}

}  // namespace
}  // namespace palpate
