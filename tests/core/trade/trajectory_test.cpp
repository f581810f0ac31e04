#include "core/trade/trajectory.h"

#include <gtest/gtest.h>

#include "core/geometry/pose.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

/// The stated velocity is that of the path, so that the coupling's damper pulls rightly.
void expectConsistent(const Trajectory& path, double fastest) {
  for (std::size_t i = 1; i < path.samples.size(); ++i) {
    const DeviceSample &a = path.samples[i - 1], &b = path.samples[i];
    ASSERT_EQ(b.index, i);
    const Eigen::Vector3d v(b.v[0], b.v[1], b.v[2]);
    EXPECT_LT(((position(b.pose) - position(a.pose)) / 1e-3 - v).norm(), 0.026) << i;
    EXPECT_LT(v.norm(), fastest);
    EXPECT_TRUE(isRigid(b.pose));
  }
}

TEST(Trajectory, TheSlideComesDownAndGoesToAndFro) {
  const auto scene = prepared(ball());
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Trajectory path = slidePath(*scene, seed);
    ASSERT_EQ(path.samples.size(), 900U);
    expectConsistent(path, 0.2);
    const Eigen::Isometry3d X_DW = scene->X_WD.inverse();
    EXPECT_NEAR((X_DW * position(path.samples.front().pose)).y(), 10e-3, 1e-9);
    EXPECT_NEAR((X_DW * position(path.samples.back().pose)).y(), -1.5e-3, 1e-9);
  }
}

TEST(Trajectory, TheApproachEndsStill) {
  const auto scene = prepared(ball());
  const Trajectory path = approachPath(*scene);
  ASSERT_EQ(path.restFrom, 1000U);
  expectConsistent(path, 0.05);
  for (std::size_t i = path.restFrom + 1; i < path.samples.size(); ++i) {
    EXPECT_EQ(position(path.samples[i].pose), position(path.samples.back().pose));
  }
}

TEST(Trajectory, RandomApproachesEndInTheSurfaceFromEverywhere) {
  const auto shape = closedForm(KnownShape::Sphere);
  Surround surround;
  surround.radius = 30e-3;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Trajectory path = randomPath(*shape, surround, seed);
    ASSERT_FALSE(path.samples.empty()) << seed;
    const Eigen::Vector3d end = position(path.samples.back().pose);
    EXPECT_NEAR(shape->distance(end), -1.5e-3, 0.2e-3) << seed;
    EXPECT_NEAR(shape->distance(position(path.samples.front().pose)), 8e-3, 0.2e-3);
    // Tip first: the shaft points the way that it came from.
    EXPECT_GT((orientation(path.samples[0].pose) * Eigen::Vector3d::UnitZ()).dot(end.normalized()),
              0.999);
    sum += end.normalized() / 200.0;
  }
  EXPECT_LT(sum.norm(), 0.15);  // no side is preferred
  expectConsistent(randomPath(*shape, surround, 1), 0.051);
}

TEST(Trajectory, RandomApproachesKeepToTheCone) {
  const auto shape = closedForm(KnownShape::Plane);
  Surround surround;
  surround.radius = 20e-3;
  surround.up_W = Eigen::Vector3d::UnitZ();
  surround.leastCosine = 0.5;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Trajectory path = randomPath(*shape, surround, seed);
    ASSERT_FALSE(path.samples.empty());
    EXPECT_GE((orientation(path.samples[0].pose) * Eigen::Vector3d::UnitZ()).z(), 0.5 - 1e-9);
  }
}

TEST(Trajectory, TheCavityIsTheHoleOfTheTorusRatherThanItsOutside) {
  const auto shape = closedForm(KnownShape::Torus);
  Surround surround;
  surround.radius = 30e-3;
  const Trajectory path = cavityPath(*shape, surround, 1);
  ASSERT_FALSE(path.samples.empty());
  const Eigen::Vector3d end = position(path.samples.back().pose);
  EXPECT_LT(end.head<2>().norm(), 18e-3) << end.transpose();
  expectConsistent(path, 0.15);
}

TEST(Trajectory, NothingToTouchIsAnEmptyPath) {
  const auto shape = closedForm(KnownShape::Sphere);
  Surround surround;
  surround.centre_W = Eigen::Vector3d(1.0, 0.0, 0.0);
  surround.radius = 10e-3;
  EXPECT_TRUE(randomPath(*shape, surround, 1).samples.empty());
  EXPECT_TRUE(cavityPath(*shape, surround, 1).samples.empty());
}

TEST(Trajectory, SurroundHoldsAllThatIsFelt) {
  const auto scene = prepared(ball(20.0));
  const Surround surround = surroundOf(*scene);
  EXPECT_GT(surround.radius, 20e-3);
  EXPECT_LT(surround.radius, 40e-3);
  const auto& g = scene->labels->geometry;
  EXPECT_LT((surround.centre_W - g.X_PV * g.centre_V(31.5, 31.5, 31.5)).norm(), 1e-6);
}

}  // namespace
}  // namespace palpate
