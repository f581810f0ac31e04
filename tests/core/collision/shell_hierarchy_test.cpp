#include "core/collision/shell_hierarchy.h"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

TEST(ShellHierarchy, EverySphereHoldsThePointsOfItsNode) {
  constexpr std::uint32_t kSeed = 8;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::normal_distribution<double> normal(0, 0.01);
  for (const std::size_t count : {1U, 2U, 16U, 17U, 128U, 129U, 1000U, 5000U}) {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < count; ++i) points.emplace_back(normal(rng), normal(rng), 0.0);
    const ShellHierarchy h = buildShellHierarchy(points);
    ASSERT_EQ(h.size(), count);
    EXPECT_EQ(h.level.back().size(), 1U);
    std::vector<int> seen(count, 0);
    for (const auto i : h.order) ++seen[i];
    EXPECT_EQ(seen, std::vector<int>(count, 1)) << "order is not a permutation";
    for (std::size_t l = 0; l < h.level.size(); ++l) {
      const std::size_t step = ShellHierarchy::pointsPerNode(l);
      EXPECT_EQ(h.level[l].size(), (count + step - 1) / step);
      for (std::size_t rank = 0; rank < count; ++rank) {
        const ShellSphere& s = h.level[l][rank / step];
        const Eigen::Vector3d p = points[h.order[rank]];
        EXPECT_EQ(p.x(), h.x[rank]);
        EXPECT_LE((p - Eigen::Vector3d(s.c[0], s.c[1], s.c[2])).norm(), s.r * (1 + 1e-12));
      }
    }
  }
}

// What makes the hierarchy worth having: groups of neighbours, not of strangers.
TEST(ShellHierarchy, GroupsAreCompact) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 16384; ++i) points.emplace_back(uniform(rng), uniform(rng), 0.0);
  const ShellHierarchy h = buildShellHierarchy(points);
  double mean = 0;
  for (const auto& s : h.level[0]) mean += s.r / static_cast<double>(h.level[0].size());
  // A square of 16 points of 16384 has the circumradius 0.022.
  EXPECT_LT(mean, 0.03);
}

TEST(ShellHierarchy, EqualPointsAreNoTrouble) {
  const std::vector<Eigen::Vector3d> points(300, Eigen::Vector3d(1, 2, 3));
  const ShellHierarchy h = buildShellHierarchy(points);
  EXPECT_EQ(h.level.back()[0].r, 0.0);
}

}  // namespace
}  // namespace palpate
