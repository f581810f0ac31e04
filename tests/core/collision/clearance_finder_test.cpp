/// The clearance against an oracle that tries every point with every solid voxel.

#include "core/collision/clearance_finder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using oracle::middleOf;
using oracle::randomPose;
using oracle::randomShell;
using testing_volumes::makeGrid;

constexpr Branching kBranchings[] = {Branching::Children8, Branching::Children64,
                                     Branching::Children512};
// Metres. Far above what a handful of roundings make of a decimetre, far below any real difference
// between random pairs: what is nearer together than this is equal (shared faces, inside).
constexpr double kEqual = 1e-13;

struct Truth {
  double distance = std::numeric_limits<double>::infinity();
  std::uint32_t index = 0;
  std::array<std::int32_t, 3> voxel{};
};

// The distance from p to the closed box of a voxel.
double toVoxel(const GridGeometry& g, const Eigen::Vector3d& p, int i, int j, int k) {
  const Eigen::Vector3d outside = (p - g.centre_V(i, j, k)).cwiseAbs() - 0.5 * g.spacing;
  return outside.cwiseMax(0.0).norm();
}

Truth bruteForce(const LabelGrid& grid, const PointShell& shell, const Eigen::Isometry3d& X_VT) {
  const GridGeometry& g = grid.geometry;
  std::vector<std::array<std::int32_t, 3>> solid;  // in the grid's order
  for (int k = 0; k < g.dims[2]; ++k) {
    for (int j = 0; j < g.dims[1]; ++j) {
      for (int i = 0; i < g.dims[0]; ++i) {
        if (grid.at(i, j, k) != 0) solid.push_back({i, j, k});
      }
    }
  }
  Truth truth;
  for (std::uint32_t index = 0; index < shell.size(); ++index) {
    const Eigen::Vector3d p = X_VT * shell.points_T()[index];
    for (const auto& v : solid) {
      const double d = toVoxel(g, p, v[0], v[1], v[2]);
      if (d < truth.distance - kEqual) truth = {d, index, v};
    }
  }
  return truth;
}

ClearanceFinder finderOf(const VoxelTree& tree, const PointShell& shell,
                         const ClearanceOptions& options = {}) {
  return ClearanceFinder::create(tree, shell, options).value();
}

VoxelTree voxelTree(const LabelGrid& grid, Branching branching,
                    std::span<const std::uint8_t> labels = {}) {
  return VoxelTree::build(grid, labels, {branching, LeafModel::Voxel, false}).value();
}

void expectTruth(const LabelGrid& grid, const PointShell& shell, const Eigen::Isometry3d& X_VT,
                 const Truth& truth, const Clearance& found) {
  ASSERT_EQ(found.status, ClearanceStatus::Complete);
  EXPECT_NEAR(found.distance, truth.distance, kEqual);
  EXPECT_EQ(found.shellIndex, truth.index);
  EXPECT_EQ(found.voxel, truth.voxel);
  const Eigen::Vector3d tool(found.tool[0], found.tool[1], found.tool[2]);
  const Eigen::Vector3d anatomy(found.anatomy[0], found.anatomy[1], found.anatomy[2]);
  EXPECT_LT((tool - X_VT * shell.points_T()[truth.index]).norm(), kEqual);
  EXPECT_NEAR((tool - anatomy).norm(), found.distance, kEqual);
  EXPECT_LT(toVoxel(grid.geometry, anatomy, truth.voxel[0], truth.voxel[1], truth.voxel[2]),
            kEqual);
}

// All but `tests`, to the bit.
auto bitsOf(const Clearance& c) {
  return std::make_tuple(c.status, c.distance, c.shellIndex, std::to_array(c.tool),
                         std::to_array(c.anatomy), c.voxel);
}

std::vector<testing_volumes::NamedGrid> grids(std::uint32_t seed) {
  auto all = testing_volumes::assortedGrids(seed);
  std::mt19937 rng(seed + 1);
  std::bernoulli_distribution rare(4e-4);
  // Three levels of 512 children, and walls around the tool.
  all.push_back({"wide", makeGrid({70, 66, 65}, Eigen::Vector3d(0.7e-3, 0.9e-3, 0.8e-3),
                                  [&](int, int, int) { return rare(rng) ? 1 : 0; })});
  all.push_back(
      {"hollow", makeGrid({20, 18, 16}, Eigen::Vector3d::Constant(1e-3), [](int i, int j, int k) {
         return i % 19 == 0 || j % 17 == 0 || k % 15 == 0 ? 5 : 0;
       })});
  return all;
}

TEST(ClearanceFinder, FindsTheOraclesPairAtRandomPoses) {
  constexpr std::uint32_t kSeed = 37;
  std::mt19937 rng(kSeed);
  int inside = 0;
  int outside = 0;
  for (const auto& [name, grid] : grids(kSeed)) {
    const Eigen::Vector3d middle = middleOf(grid.geometry);
    const std::vector<PointShell> shells{
        randomShell(rng, 1, middle), randomShell(rng, 17, 0.1 * middle),
        randomShell(rng, 400, 0.5 * middle), randomShell(rng, 150, 0.01 * middle)};
    std::vector<VoxelTree> trees;
    for (const Branching branching : kBranchings) trees.push_back(voxelTree(grid, branching));
    for (const PointShell& shell : shells) {
      std::vector<ClearanceFinder> finders;
      for (const VoxelTree& tree : trees) finders.push_back(finderOf(tree, shell));
      for (const double spread : {0.3, 1.0, 3.0, 3.0, 20.0}) {
        const auto X_VT = randomPose(rng, middle, spread * middle.maxCoeff());
        const Truth truth = bruteForce(grid, shell, X_VT);
        (truth.distance > 0 ? outside : inside) += 1;
        for (std::size_t t = 0; t < trees.size(); ++t) {
          SCOPED_TRACE(name + ", seed " + std::to_string(kSeed) + ", branching " +
                       std::to_string(static_cast<int>(kBranchings[t])) + ", points " +
                       std::to_string(shell.size()) + ", spread " + std::to_string(spread));
          expectTruth(grid, shell, X_VT, truth, finders[t].find(X_VT));
          if (HasFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(inside, 30);  // both kinds were tried
  EXPECT_GT(outside, 100);
}

// On a lattice of powers of two every distance is exact, so ties are ties: the lowest index, then
// the lowest voxel. Points come in random order, some of them twice.
TEST(ClearanceFinder, OfEqualPairsTheLowestPointAndVoxelWin) {
  constexpr std::uint32_t kSeed = 5;
  constexpr double kStep = 0x1p-10;
  std::mt19937 rng(kSeed);
  Eigen::Matrix3d quarter;  // a permutation of the axes: exact
  quarter << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  for (const double share : {0.002, 0.05, 0.5, 1.0}) {
    std::bernoulli_distribution solid(share);
    LabelGrid grid = makeGrid({17, 12, 14}, Eigen::Vector3d::Constant(kStep),
                              [&](int, int, int) { return solid(rng) ? 1 : 0; });
    grid.labels[grid.geometry.index(9, 5, 7)] = 1;
    for (const int reach : {2, 12}) {
      std::uniform_int_distribution<int> place(-reach, reach);
      std::vector<Eigen::Vector3d> points;
      for (int i = 0; i < 300; ++i) {
        points.push_back(0.5 * kStep * Eigen::Vector3d(place(rng), place(rng), place(rng)));
      }
      const auto shell = PointShell::fromPoints(
          points, std::vector<Eigen::Vector3d>(points.size(), Eigen::Vector3d::UnitX()));
      ASSERT_TRUE(shell);
      for (const Branching branching : kBranchings) {
        const VoxelTree tree = voxelTree(grid, branching);
        ClearanceFinder finder = finderOf(tree, *shell);
        for (int pose = 0; pose < 12; ++pose) {
          SCOPED_TRACE("share " + std::to_string(share) + ", seed " + std::to_string(kSeed) +
                       ", branching " + std::to_string(static_cast<int>(branching)) + ", pose " +
                       std::to_string(pose));
          std::uniform_int_distribution<int> where(-20, 50);
          Eigen::Isometry3d X_VT = Eigen::Isometry3d::Identity();
          if (pose % 2 == 1) X_VT.linear() = quarter;
          X_VT.translation() = 0.5 * kStep * Eigen::Vector3d(where(rng), where(rng), where(rng));
          expectTruth(grid, *shell, X_VT, bruteForce(grid, *shell, X_VT), finder.find(X_VT));
          if (HasFailure()) return;
        }
      }
    }
  }
}

TEST(ClearanceFinder, WhatWasAskedBeforeNeverChangesTheResult) {
  constexpr std::uint32_t kSeed = 91;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  for (const auto& [name, grid] : grids(kSeed)) {
    SCOPED_TRACE(name);
    const Eigen::Vector3d middle = middleOf(grid.geometry);
    const PointShell shell = randomShell(rng, 700, 0.2 * middle);
    for (const Branching branching : kBranchings) {
      const VoxelTree tree = voxelTree(grid, branching);
      ClearanceFinder warm = finderOf(tree, shell);
      Eigen::Isometry3d X = randomPose(rng, middle, middle.maxCoeff());
      for (int step = 0; step < 150; ++step) {
        if (step % 40 == 39) {
          X = randomPose(rng, middle, 3 * middle.maxCoeff());  // a teleport
        } else {
          X = X * randomPose(rng, Eigen::Vector3d::Zero(), 0.0)
                      .rotate(Eigen::AngleAxisd(0.01, Eigen::Vector3d::UnitX()));
          X.translation() += 0.02 * (middle - X.translation());
        }
        if (step % 50 == 20) {
          Eigen::Isometry3d bad = X;
          bad.translation().x() = std::nan("");
          EXPECT_EQ(warm.find(bad).status, ClearanceStatus::BadPose);
        }
        ClearanceFinder fresh = finderOf(tree, shell);
        ASSERT_EQ(bitsOf(warm.find(X)), bitsOf(fresh.find(X))) << "step " << step;
      }
    }
  }
}

TEST(ClearanceFinder, EveryBranchingGivesTheSameBits) {
  constexpr std::uint32_t kSeed = 19;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  for (const auto& [name, grid] : grids(kSeed)) {
    SCOPED_TRACE(name);
    const Eigen::Vector3d middle = middleOf(grid.geometry);
    const PointShell shell = randomShell(rng, 500, 0.3 * middle);
    const VoxelTree a = voxelTree(grid, Branching::Children8);
    const VoxelTree b = voxelTree(grid, Branching::Children64);
    const VoxelTree c = voxelTree(grid, Branching::Children512);
    for (int i = 0; i < 30; ++i) {
      const auto X = randomPose(rng, middle, (i % 3 + 0.3) * middle.maxCoeff());
      const auto expected = bitsOf(finderOf(a, shell).find(X));
      EXPECT_EQ(bitsOf(finderOf(b, shell).find(X)), expected);
      EXPECT_EQ(bitsOf(finderOf(c, shell).find(X)), expected);
    }
  }
}

TEST(ClearanceFinder, AReachHidesWhatIsFartherAndChangesNothingElse) {
  constexpr std::uint32_t kSeed = 77;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  for (const auto& [name, grid] : grids(kSeed)) {
    SCOPED_TRACE(name);
    const Eigen::Vector3d middle = middleOf(grid.geometry);
    const PointShell shell = randomShell(rng, 300, 0.2 * middle);
    const VoxelTree tree = voxelTree(grid, Branching::Children64);
    for (int i = 0; i < 20; ++i) {
      const auto X = randomPose(rng, middle, 2 * middle.maxCoeff());
      const Clearance all = finderOf(tree, shell).find(X);
      const Clearance wide = finderOf(tree, shell, {all.distance * (1 + 1e-12)}).find(X);
      EXPECT_EQ(bitsOf(wide), bitsOf(all));
      if (all.distance == 0) {
        EXPECT_EQ(bitsOf(finderOf(tree, shell, {0.0}).find(X)), bitsOf(all));
        continue;
      }
      ClearanceFinder narrow = finderOf(tree, shell, {all.distance * (1 - 1e-12)});
      Clearance nothing;
      nothing.status = ClearanceStatus::BeyondReach;
      EXPECT_EQ(bitsOf(narrow.find(X)), bitsOf(nothing));
    }
  }
}

TEST(ClearanceFinder, ExactlyAtItsReachIsWithin) {
  const auto grid =
      makeGrid({4, 4, 4}, Eigen::Vector3d::Constant(0x1p-10), [](int, int, int) { return 1; });
  const VoxelTree tree = voxelTree(grid, Branching::Children64);
  const auto shell =
      PointShell::fromPoints({Eigen::Vector3d::Zero()}, {Eigen::Vector3d::UnitX()}).value();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(3.5 * 0x1p-10 + 0x1p-8, 0, 0);
  const Clearance c = finderOf(tree, shell, {0x1p-8}).find(X);
  ASSERT_EQ(c.status, ClearanceStatus::Complete);
  EXPECT_EQ(c.distance, 0x1p-8);
  EXPECT_EQ(c.voxel, (std::array<std::int32_t, 3>{3, 0, 0}));
  X.translation().x() = std::nextafter(X.translation().x(), 1.0);
  EXPECT_EQ(finderOf(tree, shell, {0x1p-8}).find(X).status, ClearanceStatus::BeyondReach);
}

TEST(ClearanceFinder, HowFarAwayAPoseIsNeverMatters) {
  std::mt19937 rng(3);
  const auto grid = testing_volumes::assortedGrids(3)[1].grid;
  const Eigen::Vector3d middle = middleOf(grid.geometry);
  const PointShell shell = randomShell(rng, 2000, 0.2 * middle);
  const VoxelTree tree = voxelTree(grid, Branching::Children64);
  ClearanceFinder finder = finderOf(tree, shell);
  for (const double away : {1.0, 1e3, 9e5}) {
    Eigen::Isometry3d X = randomPose(rng, middle, 0.0);
    X.translation().y() += away;
    const Clearance c = finder.find(X);
    EXPECT_EQ(c.status, ClearanceStatus::Complete);
    EXPECT_NEAR(c.distance, away, 0.2);
    EXPECT_LT(c.tests, 100000U);
  }
  for (const double away : {1.1e6, 1e12, 1e150, 1e160, 1e200, 1e300, 1.7e308}) {
    for (const double sign : {-1.0, 1.0}) {
      Eigen::Isometry3d X = randomPose(rng, middle, 0.0);
      X.translation().z() = sign * away;
      const Clearance c = finder.find(X);
      EXPECT_EQ(c.status, ClearanceStatus::BeyondReach) << away;
      EXPECT_LT(c.tests, 100U) << away;
    }
  }
}

TEST(ClearanceFinder, OnlyTheChosenLabelsCount) {
  // Bone everywhere but a nerve (7) behind it.
  const auto grid = makeGrid({30, 10, 10}, Eigen::Vector3d::Constant(1e-3), [](int i, int j, int) {
    if (i == 25 && j == 4) return 7;
    return i > 4 && i < 20 ? 1 : 0;
  });
  const std::uint8_t nerve[] = {7};
  const auto shell =
      PointShell::fromPoints({Eigen::Vector3d::Zero()}, {Eigen::Vector3d::UnitX()}).value();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = grid.geometry.centre_V(10, 4, 5);  // inside the bone
  const VoxelTree all = voxelTree(grid, Branching::Children64);
  const VoxelTree chosen = voxelTree(grid, Branching::Children64, nerve);
  EXPECT_EQ(finderOf(all, shell).find(X).distance, 0.0);
  const Clearance c = finderOf(chosen, shell).find(X);
  EXPECT_NEAR(c.distance, 14.5e-3, 1e-15);
  EXPECT_EQ(c.voxel, (std::array<std::int32_t, 3>{25, 4, 5}));
  EXPECT_EQ(grid.at(c.voxel[0], c.voxel[1], c.voxel[2]), 7);
}

TEST(ClearanceFinder, ABadPoseIsSaidAndNothingIsWritten) {
  std::mt19937 rng(2);
  const auto grid = testing_volumes::assortedGrids(2)[3].grid;
  const PointShell shell = randomShell(rng, 50, Eigen::Vector3d::Constant(1e-3));
  const VoxelTree tree = voxelTree(grid, Branching::Children8);
  ClearanceFinder finder = finderOf(tree, shell);
  std::vector<Eigen::Isometry3d> bad(6, Eigen::Isometry3d::Identity());
  bad[0].translation().y() = std::nan("");
  bad[1].translation().z() = -std::numeric_limits<double>::infinity();
  bad[2].linear()(1, 2) = std::nan("");
  bad[3].linear() *= 1.00001;
  bad[4].linear()(0, 0) = -1;  // a reflection
  bad[5].linear().setZero();
  Clearance nothing;
  nothing.status = ClearanceStatus::BadPose;
  for (const auto& X : bad) EXPECT_EQ(bitsOf(finder.find(X)), bitsOf(nothing));
  EXPECT_EQ(finder.find(Eigen::Isometry3d::Identity()).status, ClearanceStatus::Complete);
}

TEST(ClearanceFinder, WhatItCannotMeasureIsRefused) {
  std::mt19937 rng(2);
  const auto grid = testing_volumes::assortedGrids(2)[9].grid;
  const PointShell shell = randomShell(rng, 5, Eigen::Vector3d::Constant(1e-3));
  const auto distance = VoxelTree::build(grid, {}, {Branching::Children64, LeafModel::Distance});
  const auto refused = ClearanceFinder::create(*distance, shell);
  ASSERT_FALSE(refused);
  EXPECT_EQ(sentence(refused.error()),
            "Clearance is measured to whole voxels, which this tree does not hold. Field: leaf. "
            "Found: distance leaves. Expected: a tree of all solid voxels with voxel leaves. Build "
            "a tree with voxel leaves for the labels in question.");
  const auto hull = VoxelTree::build(grid, {}, {Branching::Children64, LeafModel::Voxel, true});
  const auto thin = ClearanceFinder::create(*hull, shell);
  ASSERT_FALSE(thin);
  EXPECT_EQ(thin.error().field, "surfaceOnly");
  const VoxelTree tree = voxelTree(grid, Branching::Children64);
  for (const double reach : {-1e-3, std::nan("")}) {
    const auto no = ClearanceFinder::create(tree, shell, {reach});
    ASSERT_FALSE(no);
    EXPECT_EQ(no.error().field, "maxReach");
  }
}

}  // namespace
}  // namespace palpate
