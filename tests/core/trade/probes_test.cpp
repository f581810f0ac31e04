#include "core/trade/probes.h"

#include <gtest/gtest.h>

#include <random>

#include "core/trade/grid_reference.h"

namespace palpate {
namespace {

/// A ball of 1 mm voxels whose box of centres ends beside it: some places have no distance.
std::unique_ptr<ReferenceShape> voxelBall() {
  auto grid = std::make_shared<LabelGrid>(voxelsOf(KnownShape::Sphere, 1e-3));
  return gridReference(grid, {false, true});
}

Result<PointShell> cloud(std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-8e-3, 8e-3);
  std::vector<Eigen::Vector3d> points, normals;
  for (int i = 0; i < 500; ++i) {
    points.emplace_back(part(random), part(random), part(random));
    normals.push_back(Eigen::Vector3d::UnitZ());
  }
  return PointShell::fromPoints(points, normals);
}

/// Small and large moves, from far outside to deep inside and out again.
std::vector<ProbedPose> walk(std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  std::vector<ProbedPose> poses(120);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double height = 44e-3 - 0.4e-3 * static_cast<double>(i < 60 ? i : 120 - i);
    poses[i].X_WT = Eigen::AngleAxisd(0.3 * part(random), Eigen::Vector3d::UnitX());
    poses[i].X_WT.translation() = Eigen::Vector3d(1e-3 * part(random), 1e-3 * part(random), height);
  }
  return poses;
}

TEST(Probes, PointsThatWereFarAreNotForgotten) {
  const auto shape = voxelBall();
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const auto shell = cloud(random);
    ASSERT_TRUE(shell);
    const auto poses = walk(random);
    constexpr double kUndecided = 0.2e-3;
    const auto found = probedWith(poses, *shell, *shape);
    const auto lists = judged(poses, *shell, *shape, kUndecided);
    ASSERT_EQ(found.size(), poses.size());
    ASSERT_EQ(lists.size(), poses.size());
    std::size_t inside = 0, undecided = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      ProbedPose asked;
      JudgedPose list;
      for (std::uint32_t p = 0; p < shell->size(); ++p) {
        const Eigen::Vector3d p_W = poses[i].X_WT * shell->points_T()[p];
        const double d = shape->distance(p_W);
        if (d < 0.0) {
          ++asked.inside;
          asked.deepest = std::max(asked.deepest, -d);
          asked.normal_W -= d * shape->normal(p_W);
        }
        if (d <= kUndecided) (d < -kUndecided ? list.inside : list.undecided).push_back(p);
      }
      EXPECT_EQ(found[i].inside, asked.inside);
      EXPECT_EQ(found[i].deepest, asked.deepest);
      EXPECT_EQ(found[i].normal_W, asked.normal_W);
      EXPECT_EQ(lists[i].inside, list.inside);
      EXPECT_EQ(lists[i].undecided, list.undecided);
      inside += list.inside.size();
      undecided += list.undecided.size();
    }
    EXPECT_GT(inside, 1000U);
    EXPECT_GT(undecided, 100U);
  }
}

}  // namespace
}  // namespace palpate
