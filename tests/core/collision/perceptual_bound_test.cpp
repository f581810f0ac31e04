/// QueryOptions::perceptualBound: what it promises about the contacts that it leaves out.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <thread>

#include "core/collision/contact_finder.h"
#include "core/collision/shell_hierarchy.h"
#include "core/collision/thinned_shell.h"
#include "core/collision/voxel_body_shell.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using oracle::findAll;
using oracle::middleOf;
using oracle::randomPose;
using testing_volumes::makeGrid;

// A knobbly ball that keeps away from the box's faces, where contacts end abruptly.
LabelGrid knobblyBall(const std::array<int, 3>& dims, const Eigen::Vector3d& spacing) {
  const Eigen::Vector3d middle(0.5 * (dims[0] - 1) * spacing.x(), 0.5 * (dims[1] - 1) * spacing.y(),
                               0.5 * (dims[2] - 1) * spacing.z());
  return makeGrid(dims, spacing, [&](int i, int j, int k) {
    const Eigen::Vector3d p = spacing.cwiseProduct(Eigen::Vector3d(i, j, k)) - middle;
    const double knobs = std::sin(900 * p.x()) + std::sin(1100 * p.y()) + std::sin(700 * p.z());
    return p.norm() < 10e-3 + 0.7e-3 * knobs;
  });
}

// Points on a ball of 8 mm: neighbours are near each other, as on an instrument.
PointShell ballShell(std::size_t count) {
  std::mt19937 rng(5);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(8e-3 * Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized());
  }
  return PointShell::fromPoints(points, points).value();
}

struct Scene {
  explicit Scene(const LabelGrid& world, LeafModel leaf)
      : grid(world),
        tree(VoxelTree::build(grid, {}, {Branching::Children64, leaf, false}).value()) {}
  LabelGrid grid;
  VoxelTree tree;
  PointShell shell = ballShell(6000);
};

std::vector<LabelGrid> worlds() {
  return {knobblyBall({64, 64, 64}, Eigen::Vector3d::Constant(0.5e-3)),
          knobblyBall({64, 40, 30}, Eigen::Vector3d(0.5e-3, 0.8e-3, 1.1e-3))};
}

// Of the header: how much deeper than its stand-in a point within `bound` can be.
double depthError(const LabelGrid& grid, LeafModel leaf, double bound) {
  const Eigen::Vector3d& h = grid.geometry.spacing;
  if (leaf == LeafModel::Voxel) return bound + 2 * h.norm();
  const Eigen::Array3d slope = 2.0 - h.minCoeff() / h.array();
  return std::sqrt(slope.square().sum()) * bound + 2e-3 * h.minCoeff();
}

bool isSame(const Contact& a, const Contact& b) {
  return a.shellIndex == b.shellIndex && a.depth == b.depth && a.label == b.label &&
         std::memcmp(a.p, b.p, sizeof a.p) == 0 && std::memcmp(a.n, b.n, sizeof a.n) == 0;
}

TEST(PerceptualBound, WhatIsLeftOutIsWithinTheBoundOfWhatStays) {
  constexpr std::uint32_t kSeed = 17;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  for (const LabelGrid& grid : worlds()) {
    for (const LeafModel leaf : {LeafModel::Distance, LeafModel::Voxel}) {
      const Scene scene(grid, leaf);
      const Eigen::Vector3d middle = middleOf(grid.geometry);
      std::size_t all = 0;
      std::size_t some = 0;
      for (int pose = 0; pose < 12; ++pose) {
        const double bound = pose % 2 == 0 ? 1.5e-3 : 5e-3;
        QueryOptions options;
        options.perceptualBound = bound;
        const Eigen::Isometry3d X = randomPose(rng, middle, 8e-3);
        const auto exact = findAll(scene.tree, scene.shell, {}, X);
        const auto felt = findAll(scene.tree, scene.shell, options, X);
        all += exact.size();
        some += felt.size();
        std::size_t at = 0;
        for (const Contact& c : felt) {
          while (at < exact.size() && exact[at].shellIndex < c.shellIndex) ++at;
          ASSERT_LT(at, exact.size());
          EXPECT_TRUE(isSame(c, exact[at])) << "not one of the exact contacts";
        }
        const double error = depthError(grid, leaf, bound);
        for (const Contact& e : exact) {
          if (e.depth <= error) continue;
          EXPECT_TRUE(std::any_of(
              felt.begin(), felt.end(),
              [&](const Contact& c) {
                const double d2 = (Eigen::Vector3d(c.p) - Eigen::Vector3d(e.p)).squaredNorm();
                return d2 <= bound * bound * (1 + 1e-9) && std::abs(c.depth - e.depth) <= error;
              }))
              << "nothing stands for a contact " << e.depth << " deep";
        }
      }
      EXPECT_LT(4 * some, all);
      EXPECT_GT(some, 50U);
    }
  }
}

TEST(PerceptualBound, IsTheSameWhateverTheMethodThreadsAndExactOptions) {
  constexpr std::uint32_t kSeed = 18;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  auto body = knobblyBall({30, 30, 30}, Eigen::Vector3d::Constant(0.8e-3));
  body.geometry.X_PV.translation() = -middleOf(body.geometry);
  const PointShell voxels = shellOfVoxelBody(body).value();
  for (const LeafModel leaf : {LeafModel::Distance, LeafModel::Voxel}) {
    const Scene scene(worlds()[0], leaf);
    for (const PointShell& shell : {scene.shell, voxels}) {
      for (const std::uint32_t budget : {0xFFFFFFFFU, 30U}) {
        for (const int stopLevel : {0, 1}) {
          QueryOptions options;
          options.method = QueryMethod::BruteForce;
          options.perceptualBound = 1.6e-3;
          options.contactBudget = budget;
          options.stopLevel = stopLevel;
          const Eigen::Isometry3d X = randomPose(rng, middleOf(scene.grid.geometry), 6e-3);
          const auto expected = findAll(scene.tree, shell, options, X);
          EXPECT_FALSE(expected.empty());
          EXPECT_LE(expected.size(), budget);
          for (const QueryMethod method : {QueryMethod::Hierarchy, QueryMethod::Paper}) {
            options.method = method;
            options.tightSpheres = !options.tightSpheres;
            options.threads = 3;
            const auto found = findAll(scene.tree, shell, options, X);
            ASSERT_EQ(found.size(), expected.size());
            for (std::size_t i = 0; i < found.size(); ++i) {
              EXPECT_TRUE(isSame(found[i], expected[i]));
              EXPECT_EQ(found[i].flags, expected[i].flags);
            }
          }
        }
      }
    }
  }
}

TEST(PerceptualBound, SavesTestsAndFlagsWhatStandsForMore) {
  const Scene scene(worlds()[0], LeafModel::Distance);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = middleOf(scene.grid.geometry) + Eigen::Vector3d(12e-3, 0, 0);
  std::vector<Contact> out(scene.shell.size());
  std::uint32_t before = ~0U;
  for (const double bound : {0.0, 1.5e-3, 5e-3}) {
    for (const QueryMethod method : {QueryMethod::Hierarchy, QueryMethod::BruteForce}) {
      QueryOptions options;
      options.method = method;
      options.perceptualBound = bound;
      ContactFinder finder(scene.tree, scene.shell, options);
      const QueryResult result = finder.find(X, out);
      EXPECT_EQ(result.status, bound > 0 ? QueryStatus::Approximate : QueryStatus::Complete);
      EXPECT_GT(result.contactCount, 0U);
      bool flagged = false;
      for (std::size_t i = 0; i < result.contactCount; ++i) {
        flagged = flagged || (out[i].flags & kContactApproximate) != 0;
      }
      EXPECT_EQ(flagged, bound > 0);
      if (method == QueryMethod::BruteForce) continue;
      EXPECT_LT(result.tests, before);
      before = result.tests;
    }
  }
}

TEST(PerceptualBound, BelowTheDistanceOfPointsIsExact) {
  const Scene scene(worlds()[0], LeafModel::Distance);
  for (const double bound : {1e-9, -1.0, std::nan("")}) {
    QueryOptions options;
    options.perceptualBound = bound;
    ContactFinder finder(scene.tree, scene.shell, options);
    std::vector<Contact> out(scene.shell.size());
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = middleOf(scene.grid.geometry);
    const QueryResult result = finder.find(X, out);
    EXPECT_EQ(result.status, QueryStatus::Complete);
    EXPECT_EQ(result.contactCount, findAll(scene.tree, scene.shell, {}, X).size());
  }
}

TEST(ThinnedShells, FindersOfOneBoundShareWhatWasMade) {
  const PointShell shell = ballShell(6000);
  const PointShell::Data& data = shell.data();
  std::vector<std::shared_ptr<const ThinnedShell>> made(4);
  std::vector<std::thread> threads;
  for (auto& mine : made) {
    threads.emplace_back([&] { mine = data.thinned->toBound(data.hierarchy, data.blocks, 1e-3); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& mine : made) EXPECT_EQ(mine, made[0]);
  const auto other = data.thinned->toBound(data.hierarchy, data.blocks, 2e-3);
  EXPECT_NE(other, made[0]);
  EXPECT_LT(other->hierarchy.size(), made[0]->hierarchy.size());
  EXPECT_EQ(made[0]->hierarchy.order,
            thinToBound(data.hierarchy, data.blocks, 1e-3).hierarchy.order);
}

}  // namespace
}  // namespace palpate
