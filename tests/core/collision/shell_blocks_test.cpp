#include "core/collision/shell_blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "core/collision/cell_pose.h"
#include "core/collision/shell_hierarchy.h"
#include "tests/core/collision/oracle.h"

namespace palpate {
namespace {

using oracle::randomPose;
using oracle::randomShell;

constexpr std::uint32_t kSeed = 1789;

PointShell moved(const PointShell& shell, const Eigen::Vector3d& by) {
  std::vector<Eigen::Vector3d> points(shell.points_T().begin(), shell.points_T().end());
  for (auto& p : points) p += by;
  return PointShell::fromPoints(points, {shell.normals_T().begin(), shell.normals_T().end()})
      .value();
}

TEST(ShellBlocks, HoldEveryPointOnceAndEverySphereHoldsItsPoints) {
  std::mt19937 rng(kSeed);
  for (const std::size_t count : {1U, 2U, 15U, 16U, 17U, 255U, 256U, 257U, 4097U, 20000U}) {
    for (const double far : {0.0, 5.0, 1e4}) {
      SCOPED_TRACE("seed " + std::to_string(kSeed) + ", points " + std::to_string(count) +
                   ", far " + std::to_string(far));
      const PointShell shell = moved(randomShell(rng, count, Eigen::Vector3d(0.02, 0.1, 0.03)),
                                     far * Eigen::Vector3d(1, -2, 0.5));
      const ShellBlocks& blocks = shell.data().blocks;
      const ShellHierarchy& hierarchy = shell.data().hierarchy;
      // Points by rank, as stored; a single precision's rounding off those of the shell.
      std::set<std::uint32_t> seen;
      ASSERT_EQ(blocks.leaf.size(), (count + 15) / 16);
      std::vector<Eigen::Vector3d> stored(count);
      for (std::size_t rank = 0; rank < 16 * blocks.leaf.size(); ++rank) {
        const PointBlock& leaf = blocks.leaf[rank / 16];
        const std::size_t l = rank % 16;
        const Eigen::Vector3d p(static_cast<double>(leaf.x[l]), static_cast<double>(leaf.y[l]),
                                static_cast<double>(leaf.z[l]));
        if (rank >= count) {
          EXPECT_GT(p.norm(), 1e6);
          continue;
        }
        ASSERT_EQ(leaf.index[l], hierarchy.order[rank]);
        EXPECT_TRUE(seen.insert(leaf.index[l]).second);
        const Eigen::Vector3d exact = shell.points_T()[leaf.index[l]] - blocks.middle;
        ASSERT_LE((p - exact).cwiseAbs().maxCoeff(), 1e-7 * 0.2) << rank;
        ASSERT_LE(exact.norm(), blocks.reach * (1 + 1e-12) + 1e-15);
        stored[rank] = p;
      }
      EXPECT_EQ(seen.size(), count);
      // The middle is one: nothing is farther from it than the shell is long.
      EXPECT_LT(blocks.reach, 0.25);
      for (std::size_t level = 0; level < blocks.level.size(); ++level) {
        const std::size_t points = ShellHierarchy::pointsPerNode(level);
        const std::size_t nodes = (count + points - 1) / points;
        ASSERT_EQ(blocks.count[level], nodes);
        for (std::size_t n = 0; n < 16 * blocks.level[level].size(); ++n) {
          const SphereBlock& block = blocks.level[level][n / 16];
          const std::size_t l = n % 16;
          if (n >= nodes) {
            EXPECT_EQ(block.r[l], -1e9f);
            continue;
          }
          const Eigen::Vector3d c(static_cast<double>(block.x[l]), static_cast<double>(block.y[l]),
                                  static_cast<double>(block.z[l]));
          for (std::size_t rank = n * points; rank < std::min((n + 1) * points, count); ++rank) {
            // A point's own rounding is in the pose's slack, not in the radius.
            ASSERT_LE((stored[rank] - c).norm(), static_cast<double>(block.r[l]) + 1e-7 * 0.2)
                << "level " << level << ", node " << n;
          }
        }
      }
      // The finest level of at most kStart nodes. (The header's words, "the highest level of more
      // nodes than this", would be the level below it.)
      std::size_t start = blocks.level.size() - 1;
      while (start > 0 && blocks.count[start - 1] <= ShellBlocks::kStart) --start;
      EXPECT_EQ(blocks.start, start);
    }
  }
}

TEST(CellPose, ErrsByLessThanItsSlack) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 20000; ++trial) {
    const Eigen::Vector3d spacing =
        1e-3 * Eigen::Vector3d(0.3 + std::abs(uniform(rng)), 0.3 + std::abs(uniform(rng)),
                               0.3 + 3 * std::abs(uniform(rng)));
    const double reach = std::pow(10.0, -2 + 2 * uniform(rng));
    const Eigen::Isometry3d X =
        randomPose(rng, Eigen::Vector3d::Zero(), std::pow(10.0, 3 * uniform(rng)));
    const Eigen::Vector3d middle = std::pow(10.0, 2 * uniform(rng)) * Eigen::Vector3d(1, 0.4, -2);
    const CellPose pose(X, middle, reach, spacing);
    // A point as a shell has it: single precision, relative to the middle.
    const Eigen::Vector3d direction(uniform(rng), uniform(rng), uniform(rng));
    const Eigen::Vector3f p = (reach * direction.normalized() * 0.999).cast<float>();
    const Eigen::Vector3d exact = X * (middle + p.cast<double>());
    double error2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double u = static_cast<double>(pose.apply(a, p[0], p[1], p[2]));
      const double error = u * spacing[a] - exact[a];
      error2 += error * error;
    }
    ASSERT_LE(std::sqrt(error2) / spacing.minCoeff(), static_cast<double>(pose.slack)) << trial;
    ASSERT_NEAR(static_cast<double>(pose.perUnit) * spacing.minCoeff(), 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace palpate
