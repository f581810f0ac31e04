#include "core/collision/contact_finder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using oracle::findAll;
using oracle::middleOf;
using oracle::randomPose;
using oracle::randomShell;
using testing_volumes::assortedGrids;
using testing_volumes::makeGrid;

constexpr Branching kBranchings[] = {Branching::Children8, Branching::Children64,
                                     Branching::Children512};
constexpr LeafModel kLeaves[] = {LeafModel::Voxel, LeafModel::Distance};

std::vector<QueryOptions> exactOptions() {
  std::vector<QueryOptions> all;
  for (const bool tight : {false, true}) {
    for (const bool skip : {false, true}) {
      for (const bool side : {false, true}) {
        all.push_back({QueryMethod::Paper, tight, skip, side, 0, 0xFFFFFFFF});
      }
    }
  }
  all.push_back({QueryMethod::Hierarchy, true, true, false, 0, 0xFFFFFFFF});
  all.push_back({QueryMethod::BruteForce, true, true, false, 0, 0xFFFFFFFF});
  return all;
}

// Exactly those points that the oracle finds inside, but where its value is zero up to rounding.
void expectOracle(const LabelGrid& grid, const std::vector<double>& distance, LeafModel leaf,
                  const PointShell& shell, const Eigen::Isometry3d& X_VT,
                  const std::vector<Contact>& found) {
  const double voxel = grid.geometry.spacing.minCoeff();
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < shell.size(); ++i) {
    const Eigen::Vector3d p = X_VT * shell.points_T()[i];
    const oracle::Truth truth = oracle::contactAt(grid, distance, leaf, p);
    const bool hit = at < found.size() && found[at].shellIndex == i;
    // Stored depths are quantised to within 1/1000 voxel.
    if (leaf == LeafModel::Distance && std::abs(truth.value) < 1e-3 * voxel) {
      at += hit ? 1 : 0;
      continue;
    }
    ASSERT_EQ(hit, truth.inside) << "point " << i << " at " << p.transpose();
    if (!hit) continue;
    const Contact& c = found[at++];
    const Eigen::Vector3d n(c.n[0], c.n[1], c.n[2]);
    EXPECT_NEAR(n.norm(), 1.0, 1e-12);
    EXPECT_LT((Eigen::Vector3d(c.p[0], c.p[1], c.p[2]) - p).norm(), 1e-15);
    EXPECT_GE(c.depth, 0.0);
    EXPECT_NE(c.label, 0);
    double depth = 0;
    bool saturated = false;
    if (leaf == LeafModel::Distance) {
      saturated = -truth.value > 16 * voxel;
      depth = std::min(-truth.value, 16 * voxel);
    } else {
      const auto v = grid.geometry.voxelAt(p);
      const std::size_t index = grid.geometry.index(v[0], v[1], v[2]);
      EXPECT_EQ(c.label, grid.labels[index]);
      if (std::isinf(distance[index])) continue;  // nothing to measure to: depth is only "far"
      depth = std::max(0.0, -distance[index] + n.dot(grid.geometry.centre_V(v[0], v[1], v[2]) - p));
    }
    EXPECT_NEAR(c.depth, depth, 1e-3 * voxel);
    EXPECT_EQ((c.flags & kContactSaturated) != 0, saturated);
    EXPECT_EQ(c.flags & kContactApproximate, 0);
  }
  EXPECT_EQ(at, found.size());
}

TEST(ContactFinder, EveryOptionFindsTheOraclesContactsAtRandomPoses) {
  constexpr std::uint32_t kSeed = 31;
  std::mt19937 rng(kSeed);
  for (const auto& [name, grid] : assortedGrids(kSeed)) {
    const auto distance = oracle::signedDistances(grid);
    const Eigen::Vector3d middle = middleOf(grid.geometry);
    const std::vector<PointShell> shells{randomShell(rng, 1, middle),
                                         randomShell(rng, 17, 0.2 * middle),
                                         randomShell(rng, 900, middle)};
    for (const LeafModel leaf : kLeaves) {
      for (const Branching branching : kBranchings) {
        const auto tree = VoxelTree::build(grid, {}, {branching, leaf, false});
        ASSERT_TRUE(tree);
        for (int pose = 0; pose < 3; ++pose) {
          const Eigen::Isometry3d X_VT = randomPose(rng, middle, 0.4 * middle.maxCoeff());
          for (const PointShell& shell : shells) {
            for (const QueryOptions& options : exactOptions()) {
              SCOPED_TRACE(name + ", seed " + std::to_string(kSeed) + ", leaf " +
                           std::to_string(static_cast<int>(leaf)) + ", branching " +
                           std::to_string(static_cast<int>(branching)) + ", method " +
                           std::to_string(static_cast<int>(options.method)));
              const auto found = findAll(*tree, shell, options, X_VT);
              expectOracle(grid, distance, leaf, shell, X_VT, found);
              if (HasFatalFailure()) return;
            }
          }
        }
      }
    }
  }
}

// Lattice points, faces and corners of voxels at the identity: boxes are half-open, the box of
// centres is closed.
TEST(ContactFinder, PointsOnVoxelFacesBelongToTheUpperVoxel) {
  for (const auto& [name, grid] : assortedGrids(7)) {
    SCOPED_TRACE(name);
    const GridGeometry& g = grid.geometry;
    const auto distance = oracle::signedDistances(grid);
    std::vector<Eigen::Vector3d> points;
    for (int k = -1; k <= 2 * std::min(g.dims[2], 6); ++k) {
      for (int j = -1; j <= 2 * std::min(g.dims[1], 6); ++j) {
        for (int i = -1; i <= 2 * g.dims[0]; ++i) {
          points.push_back(g.centre_V(0.5 * i, 0.5 * j, 0.5 * k));
        }
      }
    }
    const auto shell = PointShell::fromPoints(
        points, std::vector<Eigen::Vector3d>(points.size(), Eigen::Vector3d::UnitX()));
    ASSERT_TRUE(shell);
    for (const LeafModel leaf : kLeaves) {
      for (const Branching branching : kBranchings) {
        const auto tree = VoxelTree::build(grid, {}, {branching, leaf, false});
        ASSERT_TRUE(tree);
        for (const QueryOptions& options : exactOptions()) {
          const auto X = Eigen::Isometry3d::Identity();
          expectOracle(grid, distance, leaf, *shell, X, findAll(*tree, *shell, options, X));
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

TEST(ContactFinder, MethodsAgreeBitForBit) {
  constexpr std::uint32_t kSeed = 99;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto grid = assortedGrids(kSeed)[9].grid;
  const Eigen::Vector3d middle = middleOf(grid.geometry);
  const PointShell shell = randomShell(rng, 3000, 0.6 * middle);
  for (const LeafModel leaf : kLeaves) {
    for (const bool surfaceOnly : {false, true}) {
      const auto tree = VoxelTree::build(grid, {}, {Branching::Children64, leaf, surfaceOnly});
      ASSERT_TRUE(tree);
      for (int pose = 0; pose < 20; ++pose) {
        const Eigen::Isometry3d X_VT = randomPose(rng, middle, middle.maxCoeff());
        const auto expected = findAll(*tree, shell, {QueryMethod::BruteForce}, X_VT);
        for (const QueryOptions& options : exactOptions()) {
          const auto found = findAll(*tree, shell, options, X_VT);
          ASSERT_EQ(found.size(), expected.size());
          for (std::size_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i].shellIndex, expected[i].shellIndex);
            EXPECT_EQ(found[i].depth, expected[i].depth);
            EXPECT_EQ(std::memcmp(found[i].n, expected[i].n, sizeof found[i].n), 0);
          }
        }
      }
    }
  }
}

TEST(ContactFinder, SurfaceOnlyFindsASubsetThatTouchesTheSurface) {
  std::mt19937 rng(5);
  const auto grid = assortedGrids(5)[9].grid;
  const Eigen::Vector3d middle = middleOf(grid.geometry);
  const PointShell shell = randomShell(rng, 4000, 0.6 * middle);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = middle;
  for (const LeafModel leaf : kLeaves) {
    const auto solid = VoxelTree::build(grid, {}, {Branching::Children64, leaf, false});
    const auto thin = VoxelTree::build(grid, {}, {Branching::Children64, leaf, true});
    const auto all = findAll(*solid, shell, {}, X);
    const auto some = findAll(*thin, shell, {}, X);
    EXPECT_LT(some.size(), all.size());
    EXPECT_GT(some.size(), 0U);
    for (const Contact& c : some) {
      // Normals of a surface-only tree are stored, in four bytes each.
      const auto same = std::find_if(all.begin(), all.end(), [&](const Contact& o) {
        return o.shellIndex == c.shellIndex &&
               std::abs(o.depth - c.depth) < 1e-3 * grid.geometry.spacing.minCoeff();
      });
      ASSERT_NE(same, all.end());
    }
  }
}

// Of a half space the distance model is exact: D is linear across the face.
TEST(ContactFinder, DepthOfAPlaneIsExact) {
  const double s = 0.8e-3;
  const auto grid = makeGrid({20, 20, 20}, Eigen::Vector3d::Constant(s),
                             [](int, int, int k) { return k < 10 ? 3 : 0; });
  const double face = 9.5 * s;
  std::mt19937 rng(17);
  const PointShell shell = randomShell(rng, 500, Eigen::Vector3d::Constant(9 * s));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d::Constant(9.5 * s);
  for (const LeafModel leaf : kLeaves) {
    const auto tree = VoxelTree::build(grid, {}, {Branching::Children64, leaf, false});
    const auto found = findAll(*tree, shell, {}, X);
    std::size_t below = 0;
    for (const auto& p : shell.points_T()) below += (X * p).z() < face ? 1 : 0;
    EXPECT_EQ(found.size(), below);
    for (const Contact& c : found) {
      // Seen from voxel centres the nearest empty centre is half a voxel beyond the face, and
      // D takes that half off again.
      EXPECT_NEAR(c.depth, face - c.p[2], 5e-4 * s);  // stored to 1/3300 of a voxel
      EXPECT_NEAR(c.n[2], 1.0, 1e-9);
      EXPECT_EQ(c.label, 3);
    }
  }
}

TEST(ContactFinder, DepthOfABallIsThatOfTheSphereWithinAVoxel) {
  const double s = 0.5e-3;
  const double radius = 11e-3;
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(15e-3);
  const auto grid = makeGrid({61, 61, 61}, Eigen::Vector3d::Constant(s), [&](int i, int j, int k) {
    return (s * Eigen::Vector3d(i, j, k) - centre).norm() < radius ? 1 : 0;
  });
  std::mt19937 rng(23);
  const PointShell shell = randomShell(rng, 4000, Eigen::Vector3d::Constant(14e-3));
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = centre;
  const auto tree = VoxelTree::build(grid, {}, {});
  ASSERT_TRUE(tree);
  std::size_t sure = 0;
  double alignment = 0;
  int outer = 0;
  const auto found = findAll(*tree, shell, {}, X);
  for (const auto& p : shell.points_T()) sure += p.norm() < radius - s ? 1 : 0;
  EXPECT_GE(found.size(), sure);
  for (const Contact& c : found) {
    const Eigen::Vector3d out = Eigen::Vector3d(c.p[0], c.p[1], c.p[2]) - centre;
    const double depth = radius - out.norm();
    EXPECT_NEAR(c.depth, std::min(depth, 16 * s), s);  // voxels know the sphere to a voxel
    EXPECT_EQ((c.flags & kContactSaturated) != 0, c.depth == 16 * s);
    if (out.norm() > 0.5 * radius) {
      alignment += Eigen::Vector3d(c.n[0], c.n[1], c.n[2]).dot(out.normalized());
      ++outer;
    }
  }
  // The definition's gradient follows the steps between voxels: single normals stray, the mean not.
  EXPECT_GT(alignment / outer, 0.98);
}

TEST(ContactFinder, FewerShellPointsNeverAddContacts) {
  constexpr std::uint32_t kSeed = 71;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto grid = assortedGrids(kSeed)[1].grid;
  const Eigen::Vector3d middle = middleOf(grid.geometry);
  const PointShell all = randomShell(rng, 1000, middle);
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<std::uint32_t> from;
  for (std::uint32_t i = 0; i < all.size(); i += 3) {
    points.push_back(all.points_T()[i]);
    normals.push_back(all.normals_T()[i]);
    from.push_back(i);
  }
  const PointShell some = PointShell::fromPoints(points, normals).value();
  const auto tree = VoxelTree::build(grid, {}, {});
  for (int pose = 0; pose < 10; ++pose) {
    const Eigen::Isometry3d X = randomPose(rng, middle, 0.3 * middle.maxCoeff());
    const auto many = findAll(*tree, all, {}, X);
    std::size_t at = 0;
    for (const Contact& c : findAll(*tree, some, {}, X)) {
      while (at < many.size() && many[at].shellIndex < from[c.shellIndex]) ++at;
      ASSERT_LT(at, many.size());
      EXPECT_EQ(many[at].shellIndex, from[c.shellIndex]);
      // Points are placed from the middle of the shell they belong to, in single precision.
      EXPECT_NEAR(many[at].depth, c.depth, 1e-4 * grid.geometry.spacing.minCoeff());
    }
  }
}

// The tree knows the tool only through X_VT = X_WV^-1 · X_WT: moving both bodies together leaves
// it as it is up to rounding.
TEST(ContactFinder, DepthIsUnchangedByRigidMotionOfBoth) {
  constexpr std::uint32_t kSeed = 41;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto grid = assortedGrids(kSeed)[9].grid;
  const Eigen::Vector3d middle = middleOf(grid.geometry);
  const PointShell shell = randomShell(rng, 1500, 0.7 * middle);
  for (const LeafModel leaf : kLeaves) {
    const auto tree = VoxelTree::build(grid, {}, {Branching::Children64, leaf, false});
    for (int pose = 0; pose < 10; ++pose) {
      const Eigen::Isometry3d X_WV = randomPose(rng, Eigen::Vector3d::Zero(), 0.1);
      const Eigen::Isometry3d X_WT = X_WV * randomPose(rng, middle, 0.3 * middle.maxCoeff());
      const Eigen::Isometry3d X_NW = randomPose(rng, Eigen::Vector3d::Zero(), 0.5);
      const auto before = findAll(*tree, shell, {}, X_WV.inverse() * X_WT);
      const auto after = findAll(*tree, shell, {}, (X_NW * X_WV).inverse() * (X_NW * X_WT));
      ASSERT_EQ(before.size(), after.size());
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_EQ(before[i].shellIndex, after[i].shellIndex);
        // Voxel leaves: metres of half a unit rounded at 2^-53, over a handful of products.
        // Distance leaves: cells in single precision, tens of them.
        const double rounding =
            leaf == LeafModel::Voxel ? 1e-14 : 1e-4 * grid.geometry.spacing.minCoeff();
        EXPECT_NEAR(before[i].depth, after[i].depth, rounding);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
