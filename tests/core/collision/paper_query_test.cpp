/// QueryMethod::Paper with a voxel body: tree against tree.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/collision/contact_finder.h"
#include "core/collision/voxel_body_shell.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using oracle::findAll;
using oracle::middleOf;
using oracle::randomPose;
using testing_volumes::assortedGrids;
using testing_volumes::makeGrid;

constexpr Branching kBranchings[] = {Branching::Children8, Branching::Children64,
                                     Branching::Children512};
constexpr LeafModel kLeaves[] = {LeafModel::Voxel, LeafModel::Distance};

std::vector<QueryOptions> paperOptions() {
  std::vector<QueryOptions> all;
  for (const bool tight : {false, true}) {
    for (const bool skip : {false, true}) {
      for (const bool side : {false, true}) {
        all.push_back({QueryMethod::Paper, tight, skip, side, 0, 0xFFFFFFFF});
      }
    }
  }
  return all;
}

QueryOptions bruteForce() {
  QueryOptions options;
  options.method = QueryMethod::BruteForce;
  return options;
}

// The body as it lies in its own patient frame, askew.
PointShell shellAskew(std::mt19937& rng, LabelGrid body) {
  body.geometry.X_PV = randomPose(rng, Eigen::Vector3d(0.02, -0.05, 0.01), 0.03);
  return shellOfVoxelBody(body).value();
}

// A pose that brings the middle of the shell near a place.
Eigen::Isometry3d poseNear(std::mt19937& rng, const PointShell& shell, const Eigen::Vector3d& place,
                           double spread) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& p : shell.points_T()) middle += p / static_cast<double>(shell.size());
  Eigen::Isometry3d X = randomPose(rng, place, spread);
  X.translation() -= X.linear() * middle;
  return X;
}

void expectSame(const std::vector<Contact>& found, const std::vector<Contact>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].shellIndex, expected[i].shellIndex);
    EXPECT_EQ(found[i].depth, expected[i].depth);
    EXPECT_EQ(found[i].flags, expected[i].flags);
    EXPECT_EQ(std::memcmp(found[i].p, expected[i].p, sizeof found[i].p), 0);
    EXPECT_EQ(std::memcmp(found[i].n, expected[i].n, sizeof found[i].n), 0);
  }
}

TEST(PaperQuery, ABodyMeetsTheSamePointsAsBruteForceWhateverTheOptions) {
  constexpr std::uint32_t kSeed = 92;
  std::mt19937 rng(kSeed);
  const auto worlds = assortedGrids(kSeed);
  const auto bodies = assortedGrids(kSeed + 1);
  std::size_t contacts = 0;
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    const auto& world = worlds[w].grid;
    const Eigen::Vector3d middle = middleOf(world.geometry);
    for (const std::size_t b : {w, (w + 3) % bodies.size(), (w + 7) % bodies.size()}) {
      const PointShell shell = shellAskew(rng, bodies[b].grid);
      for (const LeafModel leaf : kLeaves) {
        for (const Branching branching : kBranchings) {
          const auto tree = VoxelTree::build(world, {}, {branching, leaf, false});
          ASSERT_TRUE(tree);
          for (int pose = 0; pose < 3; ++pose) {
            const Eigen::Isometry3d X = poseNear(rng, shell, middle, 0.8 * middle.maxCoeff());
            const auto expected = findAll(*tree, shell, bruteForce(), X);
            contacts += expected.size();
            for (const QueryOptions& options : paperOptions()) {
              SCOPED_TRACE(bodies[b].name + " in " + worlds[w].name + ", seed " +
                           std::to_string(kSeed) + ", leaf " +
                           std::to_string(static_cast<int>(leaf)) + ", branching " +
                           std::to_string(static_cast<int>(branching)));
              expectSame(findAll(*tree, shell, options, X), expected);
            }
          }
        }
      }
    }
  }
  EXPECT_GT(contacts, 10000U);
}

// Points of a body just inside the corner of the world's only voxel: spheres touch it, hardly more.
TEST(PaperQuery, SpheresThatOnlyJustReachHideNoContact) {
  constexpr std::uint32_t kSeed = 93;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const Eigen::Vector3d spacing(1e-3, 0.7e-3, 1.3e-3);
  const auto world =
      makeGrid({9, 9, 9}, spacing, [](int i, int j, int k) { return i == 4 && j == 4 && k == 4; });
  const auto body = makeGrid({70, 3, 4}, Eigen::Vector3d(0.4e-3, 0.9e-3, 0.6e-3),
                             [](int, int j, int k) { return j == 1 && k == 2; });
  const Eigen::Vector3d corner = world.geometry.centre_V(4.5, 4.5, 4.5);
  const Eigen::Vector3d out = spacing.normalized();  // from the voxel's centre to its corner
  for (const Branching branching : kBranchings) {
    const auto tree = VoxelTree::build(world, {}, {branching, LeafModel::Voxel, false});
    ASSERT_TRUE(tree);
    std::size_t contacts = 0;
    for (int trial = 0; trial < 150; ++trial) {
      const PointShell shell = shellAskew(rng, body);
      // The rod's end touches the corner from outside, the rest points away.
      const Eigen::Vector3d along = (shell.points_T()[69] - shell.points_T()[0]).normalized();
      std::uniform_real_distribution<double> inside(-1e-11, 1e-11);
      Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
      X.linear() = Eigen::Quaterniond::FromTwoVectors(along, out).toRotationMatrix();
      X.translation() = corner - inside(rng) * out - X.linear() * shell.points_T()[0];
      const auto expected = findAll(*tree, shell, bruteForce(), X);
      contacts += expected.size();
      for (const QueryOptions& options : paperOptions()) {
        expectSame(findAll(*tree, shell, options, X), expected);
      }
    }
    EXPECT_GT(contacts, 30U);
    EXPECT_LT(contacts, 120U);
  }
}

// A pose that is taken may be longer than a rotation by 0.4 millionths: 40 nm at the end of a
// needle of 0.1 m, and the tip is 10 nm within the corner of the voxel.
TEST(PaperQuery, APoseThatStretchesALittleHidesNoContact) {
  const auto world = makeGrid({9, 9, 9}, Eigen::Vector3d::Constant(1e-3),
                              [](int i, int j, int k) { return i == 4 && j == 4 && k == 4; });
  const auto tree = VoxelTree::build(world, {}, {Branching::Children64, LeafModel::Voxel, false});
  ASSERT_TRUE(tree);
  const PointShell points =
      PointShell::fromPoints({{-0.1, 0, 0}, {0.1, 0, 0}}, {{1, 0, 0}, {1, 0, 0}}).value();
  const auto body = makeGrid({257, 2, 2}, Eigen::Vector3d(0.2 / 256, 1e-3, 1e-3),
                             [](int, int j, int k) { return j == 0 && k == 0; });
  for (const PointShell& shell : {points, shellOfVoxelBody(body).value()}) {
    const Eigen::Vector3d out = Eigen::Vector3d::Ones().normalized();
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() =
        (1 + 4e-7) *
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), out).toRotationMatrix();
    X.translation() =
        world.geometry.centre_V(4.5, 4.5, 4.5) - 1e-8 * out - X.linear() * shell.points_T()[0];
    ASSERT_EQ(findAll(*tree, shell, bruteForce(), X).size(), 1U);
    for (const QueryOptions& options : paperOptions()) {
      EXPECT_EQ(findAll(*tree, shell, options, X).size(), 1U);
    }
  }
}

TEST(PaperQuery, StopLevelAndBudgetAgreeWithBruteForce) {
  constexpr std::uint32_t kSeed = 94;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto grids = assortedGrids(kSeed);
  const auto& world = grids[1].grid;
  const PointShell shell = shellAskew(rng, grids[9].grid);
  const Eigen::Vector3d middle = middleOf(world.geometry);
  for (const LeafModel leaf : kLeaves) {
    for (const Branching branching : kBranchings) {
      const auto tree = VoxelTree::build(world, {}, {branching, leaf, false});
      ASSERT_TRUE(tree);
      for (const int stopLevel : {0, 1, 2, 9}) {
        for (const std::uint32_t budget : {0xFFFFFFFFU, 20U}) {
          QueryOptions brute = bruteForce();
          brute.stopLevel = stopLevel;
          brute.contactBudget = budget;
          const Eigen::Isometry3d X = poseNear(rng, shell, middle, 0.5 * middle.maxCoeff());
          const auto expected = findAll(*tree, shell, brute, X);
          for (QueryOptions options : paperOptions()) {
            options.stopLevel = stopLevel;
            options.contactBudget = budget;
            expectSame(findAll(*tree, shell, options, X), expected);
          }
        }
      }
    }
  }
}

// Flat cells make spheres that reach over hundreds of neighbours: the frontier overflows, and the
// rest is descended depth-first.
TEST(PaperQuery, AFrontierThatOverflowsLosesNothing) {
  constexpr std::uint32_t kSeed = 95;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto world = makeGrid({60, 60, 6}, Eigen::Vector3d(0.2e-3, 0.2e-3, 8e-3),
                              [&rng](int, int, int) { return rng() % 4 != 0; });
  const auto body = makeGrid({8, 8, 8}, Eigen::Vector3d::Constant(1e-3),
                             [&rng](int, int, int) { return rng() % 3 == 0; });
  const PointShell shell = shellAskew(rng, body);
  const Eigen::Vector3d middle = middleOf(world.geometry);
  for (const Branching branching : kBranchings) {
    const auto tree = VoxelTree::build(world, {}, {branching, LeafModel::Voxel, false});
    ASSERT_TRUE(tree);
    for (int pose = 0; pose < 3; ++pose) {
      const Eigen::Isometry3d X = poseNear(rng, shell, middle, 2e-3);
      const auto expected = findAll(*tree, shell, bruteForce(), X);
      EXPECT_GT(expected.size(), 20U);
      for (const QueryOptions& options : paperOptions()) {
        expectSame(findAll(*tree, shell, options, X), expected);
      }
    }
  }
}

// Tests of an approach: a bent rod into a rough tube.
double meanTests(const VoxelTree& tree, const PointShell& shell, const QueryOptions& options) {
  constexpr std::uint32_t kSeed = 96;
  std::mt19937 rng(kSeed);
  ContactFinder finder(tree, shell, options);
  std::vector<Contact> out(shell.size());
  const Eigen::Vector3d middle = middleOf(tree.geometry());
  double tests = 0;
  constexpr int kPoses = 60;
  for (int pose = 0; pose < kPoses; ++pose) {
    tests += finder.find(poseNear(rng, shell, middle, middle.maxCoeff()), out).tests;
  }
  return tests / kPoses;
}

TEST(PaperQuery, EveryOptionSavesTestsOrCostsNone) {
  const auto world =
      makeGrid({48, 48, 40}, Eigen::Vector3d(0.8e-3, 0.8e-3, 1.25e-3), [](int i, int j, int k) {
        const double x = i - 23.5;
        const double y = j - 23.5;
        const double r = std::hypot(x, y) + std::sin(0.5 * k) + std::sin(0.7 * x);
        return r > 13 && r < 18;
      });
  const auto body =
      makeGrid({16, 16, 60}, Eigen::Vector3d(0.5e-3, 0.5e-3, 0.7e-3), [](int i, int j, int k) {
        const double bend = 0.004 * (k - 29.5) * (k - 29.5);
        return std::hypot(i - 5.0 - bend, j - 7.5) < 4;
      });
  const PointShell shell = shellOfVoxelBody(body).value();
  for (const LeafModel leaf : kLeaves) {
    for (const Branching branching : kBranchings) {
      SCOPED_TRACE("leaf " + std::to_string(static_cast<int>(leaf)) + ", branching " +
                   std::to_string(static_cast<int>(branching)));
      const auto tree = VoxelTree::build(world, {}, {branching, leaf, false});
      ASSERT_TRUE(tree);
      const auto tests = [&](bool tight, bool skip, bool side) {
        return meanTests(*tree, shell, {QueryMethod::Paper, tight, skip, side, 0, 0xFFFFFFFF});
      };
      const double plain = tests(false, false, false);
      const double side = tests(false, false, true);
      const double tight = tests(true, false, false);
      EXPECT_LT(side, 0.95 * plain);
      EXPECT_LT(tight, side);
      EXPECT_LT(tests(false, true, false), plain);
      EXPECT_LE(tests(false, true, true), side);
      EXPECT_LE(tests(true, true, false), tight);
      EXPECT_EQ(tests(true, true, true), tests(true, true, false)) << "tight goes before side";
    }
  }
}

// A voxel against a voxel, each at the end of a chain: with the skip one test of spheres and one
// of the point decide, however deep the trees are.
TEST(PaperQuery, AChainOfOnlyChildrenIsTestedOnceOnEitherSide) {
  const auto grid = makeGrid({100, 100, 100}, Eigen::Vector3d::Constant(1e-3),
                             [](int i, int j, int k) { return i == 80 && j == 9 && k == 77; });
  auto two = grid;
  two.labels[two.geometry.index(10, 90, 3)] = 1;  // two chains under one root
  const PointShell one = shellOfVoxelBody(grid).value();
  const PointShell pair = shellOfVoxelBody(two).value();
  for (const Branching branching : kBranchings) {
    const auto tree = VoxelTree::build(grid, {}, {branching, LeafModel::Voxel, false});
    ASSERT_TRUE(tree);
    const auto tests = [&](const PointShell& shell, bool skip) {
      ContactFinder finder(*tree, shell, {QueryMethod::Paper, true, skip, false, 0, 0xFFFFFFFF});
      std::vector<Contact> out(shell.size());
      const QueryResult result = finder.find(Eigen::Isometry3d::Identity(), out);
      EXPECT_EQ(result.contactCount, 1U);
      return result.tests;
    };
    EXPECT_EQ(tests(one, true), 2U);
    EXPECT_GT(tests(one, false), 2U);
    // The root, its two children, the point.
    EXPECT_EQ(tests(pair, true), 1U + 2U + 1U);
    EXPECT_GT(tests(pair, false), 4U);
  }
}

}  // namespace
}  // namespace palpate
