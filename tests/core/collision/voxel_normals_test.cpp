#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "core/collision/contact_finder.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using oracle::findAll;
using oracle::middleOf;
using oracle::randomPose;
using oracle::randomShell;
using testing_volumes::makeGrid;

constexpr Branching kBranchings[] = {Branching::Children8, Branching::Children64,
                                     Branching::Children512};

// A shell point in the middle of every voxel, at the identity.
PointShell centresOf(const GridGeometry& g) {
  std::vector<Eigen::Vector3d> points;
  for (int k = 0; k < g.dims[2]; ++k) {
    for (int j = 0; j < g.dims[1]; ++j) {
      for (int i = 0; i < g.dims[0]; ++i) points.push_back(g.centre_V(i, j, k));
    }
  }
  const std::vector<Eigen::Vector3d> normals(points.size(), Eigen::Vector3d::UnitX());
  return PointShell::fromPoints(points, normals).value();
}

TEST(VoxelNormals, OfABallPointAwayFromItsCentre) {
  const Eigen::Vector3d spacing(1e-3, 1.2e-3, 0.9e-3);
  const Eigen::Vector3d centre(17e-3, 17e-3, 17e-3);
  const auto grid = makeGrid({35, 30, 40}, spacing, [&](int i, int j, int k) {
    return (Eigen::Vector3d(i, j, k).cwiseProduct(spacing) - centre).norm() < 14e-3;
  });
  const PointShell shell = centresOf(grid.geometry);
  for (const Branching branching : kBranchings) {
    for (const bool surfaceOnly : {false, true}) {
      const auto tree = VoxelTree::build(grid, {}, {branching, LeafModel::Voxel, surfaceOnly});
      ASSERT_TRUE(tree);
      int checked = 0;
      double worst = 1;
      for (const Contact& c : findAll(*tree, shell, {}, Eigen::Isometry3d::Identity())) {
        const Eigen::Vector3d out = Eigen::Vector3d(c.p[0], c.p[1], c.p[2]) - centre;
        if (out.norm() < 6e-3) continue;  // near the middle every way out is as long
        const Eigen::Vector3d n(c.n[0], c.n[1], c.n[2]);
        EXPECT_NEAR(n.norm(), 1.0, 1e-9);
        worst = std::min(worst, n.dot(out.normalized()));
        ++checked;
      }
      // Distances jump between voxel centres; 1-2-1 smoothing leaves at most about 20 degrees.
      EXPECT_GT(worst, 0.93) << static_cast<int>(branching) << (surfaceOnly ? ", surface" : "");
      EXPECT_GT(checked, surfaceOnly ? 1500 : 5000);
    }
  }
}

TEST(VoxelNormals, WhereTheGradientVanishesAreUnitAndFixed) {
  for (const std::string name : {"voxel", "sheet", "all"}) {
    const auto grid = makeGrid({5, 5, 5}, Eigen::Vector3d::Ones(), [&](int i, int j, int k) {
      if (name == "voxel") return i == 2 && j == 2 && k == 2;
      return name == "all" || i == 2;
    });
    const Eigen::Vector3d expected = name == "sheet" ? Eigen::Vector3d(1, 0, 0)
                                     : name == "all" ? Eigen::Vector3d(0, 0, 1)
                                                     : Eigen::Vector3d(1, 1, 1).normalized();
    const PointShell shell = centresOf(grid.geometry);
    for (const Branching branching : kBranchings) {
      const auto tree = VoxelTree::build(grid, {}, {branching, LeafModel::Voxel, false});
      ASSERT_TRUE(tree);
      const auto found = findAll(*tree, shell, {}, Eigen::Isometry3d::Identity());
      EXPECT_EQ(found.size(), name == "sheet" ? 25U : name == "all" ? 125U : 1U);
      for (const Contact& c : found) {
        EXPECT_LT((Eigen::Vector3d(c.n[0], c.n[1], c.n[2]) - expected).norm(), 1e-9) << name;
      }
    }
  }
}

// A finder remembers the normals of voxels from query to query.
TEST(VoxelNormals, DoNotDependOnWhatWasAskedBefore) {
  constexpr std::uint32_t kSeed = 404;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  // More voxels than are remembered.
  const auto grid = makeGrid({40, 38, 36}, Eigen::Vector3d(1e-3, 1.1e-3, 0.8e-3),
                             [&rng](int, int, int) { return rng() % 12 == 0 ? 0 : 1; });
  const auto tree = VoxelTree::build(grid, {}, {Branching::Children64, LeafModel::Voxel, false});
  ASSERT_TRUE(tree);
  const Eigen::Vector3d middle = middleOf(grid.geometry);
  const PointShell shell = randomShell(rng, 20000, 0.8 * middle);
  ContactFinder finder(*tree, shell);
  std::vector<Contact> out(shell.size());
  for (int pose = 0; pose < 8; ++pose) {
    const Eigen::Isometry3d X = randomPose(rng, middle, 0.2 * middle.maxCoeff());
    const auto fresh = findAll(*tree, shell, {}, X);
    for (int again = 0; again < 2; ++again) {
      const QueryResult result = finder.find(X, out);
      ASSERT_EQ(result.contactCount, fresh.size());
      for (std::size_t i = 0; i < fresh.size(); ++i) {
        ASSERT_EQ(out[i].shellIndex, fresh[i].shellIndex);
        ASSERT_EQ(out[i].depth, fresh[i].depth);
        ASSERT_EQ(std::memcmp(out[i].n, fresh[i].n, sizeof out[i].n), 0);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
