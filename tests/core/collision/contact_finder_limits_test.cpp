#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/collision/contact_finder.h"
#include "core/collision/shell_hierarchy.h"
#include "core/voxels/voxel_tree_data.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using oracle::findAll;
using oracle::middleOf;
using oracle::randomPose;
using oracle::randomShell;
using testing_volumes::assortedGrids;

constexpr QueryMethod kMethods[] = {QueryMethod::Hierarchy, QueryMethod::Paper,
                                    QueryMethod::BruteForce};

struct Scene {
  explicit Scene(std::uint32_t seed, LeafModel leaf = LeafModel::Distance)
      : rng(seed),
        grid(assortedGrids(seed)[9].grid),
        middle(middleOf(grid.geometry)),
        tree(VoxelTree::build(grid, {}, {Branching::Children64, leaf, false}).value()),
        shell(randomShell(rng, 2000, 0.6 * middle)) {
    X.translation() = middle;
  }
  std::mt19937 rng;
  LabelGrid grid;
  Eigen::Vector3d middle;
  VoxelTree tree;
  PointShell shell;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
};

TEST(ContactFinderLimits, APoseThatIsNotRigidWritesNothing) {
  Scene scene(1);
  ContactFinder finder(scene.tree, scene.shell);
  std::vector<Contact> out(scene.shell.size());
  out[0].shellIndex = 77;
  std::vector<Eigen::Isometry3d> bad(5, scene.X);
  bad[0].translation().y() = std::numeric_limits<double>::quiet_NaN();
  bad[1].matrix()(0, 1) = std::numeric_limits<double>::infinity();
  bad[2].matrix()(0, 0) = 1.001;
  bad[3].linear() *= -1.0;  // a reflection
  bad[4].linear().setZero();
  for (const auto& X : bad) {
    const QueryResult result = finder.find(X, out);
    EXPECT_EQ(result.status, QueryStatus::BadPose);
    EXPECT_EQ(result.contactCount, 0U);
    EXPECT_EQ(out[0].shellIndex, 77U);
  }
  EXPECT_EQ(finder.find(scene.X, out).status, QueryStatus::Complete);
}

TEST(ContactFinderLimits, FarPosesFindNothingAndFarOriginsFindTheSame) {
  Scene scene(2);
  for (const QueryMethod method : kMethods) {
    QueryOptions options;
    options.method = method;
    for (const double far : {1.0, 1e6, 1e18, 1e160, 1e308}) {
      Eigen::Isometry3d X = scene.X;
      X.translation() = Eigen::Vector3d(far, -far, far);
      EXPECT_TRUE(findAll(scene.tree, scene.shell, options, X).empty()) << far;
    }
  }
  // A tool whose points lie a kilometre from its origin: culling must stay conservative there.
  const Eigen::Vector3d away(1000, -700, 400);
  std::vector<Eigen::Vector3d> points(scene.shell.points_T().begin(), scene.shell.points_T().end());
  const std::vector<Eigen::Vector3d> normals(points.size(), Eigen::Vector3d::UnitX());
  for (auto& p : points) p += away;
  const PointShell shell = PointShell::fromPoints(points, normals).value();
  for (int pose = 0; pose < 5; ++pose) {
    Eigen::Isometry3d X = randomPose(scene.rng, scene.middle, 2e-3);
    X.translation() -= X.linear() * away;
    QueryOptions brute;
    brute.method = QueryMethod::BruteForce;
    const auto expected = findAll(scene.tree, shell, brute, X);
    EXPECT_GT(expected.size(), 50U);
    for (const QueryMethod method : kMethods) {
      QueryOptions options;
      options.method = method;
      EXPECT_EQ(findAll(scene.tree, shell, options, X).size(), expected.size());
    }
  }
}

// Ten thousand kilometres from the tool's origin a transform rounds to 2 nm. The tip of a needle is
// put that close to a voxel's face, with the sphere around tip and shaft only just reaching it.
TEST(ContactFinderLimits, RoundingFarFromTheToolsOriginHidesNoContact) {
  constexpr std::uint32_t kSeed = 12;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  const auto grid = testing_volumes::makeGrid({9, 9, 9}, Eigen::Vector3d::Constant(1e-3),
                                              [](int i, int, int) { return i == 5 ? 1 : 0; });
  const auto tree = VoxelTree::build(grid, {}, {Branching::Children8, LeafModel::Voxel, false});
  ASSERT_TRUE(tree);
  std::uniform_real_distribution<double> nanometres(-5e-9, 5e-9);
  int touching = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Matrix3d R = randomPose(rng, Eigen::Vector3d::Zero(), 1).linear();
    const Eigen::Vector3d away = R * Eigen::Vector3d(7e6, -5e6, 6e6);
    const Eigen::Vector3d tip_V(4.5e-3 + nanometres(rng), 4e-3, 4e-3);
    const Eigen::Vector3d shaft = R.transpose() * Eigen::Vector3d(-4e-3, 0, 0);
    const PointShell needle = PointShell::fromPoints({away, away + shaft}, {shaft, shaft}).value();
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = R;
    X.translation() = tip_V - R * away;
    QueryOptions brute;
    brute.method = QueryMethod::BruteForce;
    const std::size_t expected = findAll(*tree, needle, brute, X).size();
    touching += expected > 0 ? 1 : 0;
    for (const QueryMethod method : {QueryMethod::Hierarchy, QueryMethod::Paper}) {
      QueryOptions options;
      options.method = method;
      ASSERT_EQ(findAll(*tree, needle, options, X).size(), expected) << "trial " << trial;
    }
  }
  EXPECT_GT(touching, 500);
  EXPECT_LT(touching, 1500);
}

// The end of a needle of 0.1 m, 40 nm longer than a rotation would have it, 10 nm within the corner
// of the only voxel, which is the corner of its node too.
TEST(ContactFinderLimits, APoseThatStretchesALittleHidesNoContact) {
  const auto grid =
      testing_volumes::makeGrid({9, 9, 9}, Eigen::Vector3d::Constant(1e-3),
                                [](int i, int j, int k) { return i == 7 && j == 7 && k == 7; });
  const auto tree = VoxelTree::build(grid, {}, {Branching::Children64, LeafModel::Voxel, false});
  ASSERT_TRUE(tree);
  const PointShell needle =
      PointShell::fromPoints({{-0.1, 0, 0}, {0.1, 0, 0}}, {{1, 0, 0}, {1, 0, 0}}).value();
  const Eigen::Vector3d out = Eigen::Vector3d::Ones().normalized();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = (1 + 4e-7) *
               Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), out).toRotationMatrix();
  X.translation() =
      grid.geometry.centre_V(7.5, 7.5, 7.5) - 1e-8 * out - X.linear() * needle.points_T()[0];
  for (const QueryMethod method : kMethods) {
    QueryOptions options;
    options.method = method;
    EXPECT_EQ(findAll(*tree, needle, options, X).size(), 1U);
  }
}

TEST(ContactFinderLimits, AShortOutputGetsTheLowestIndicesAndSaysSo) {
  Scene scene(3);
  const auto all = findAll(scene.tree, scene.shell, {}, scene.X);
  ASSERT_GT(all.size(), 100U);
  ContactFinder finder(scene.tree, scene.shell);
  std::vector<Contact> out(60);
  const QueryResult result = finder.find(scene.X, out);
  EXPECT_EQ(result.status, QueryStatus::OutputFull);
  ASSERT_EQ(result.contactCount, 60U);
  for (std::size_t i = 0; i < 60; ++i) EXPECT_EQ(out[i].shellIndex, all[i].shellIndex);
  EXPECT_EQ(finder.find(scene.X, {}).status, QueryStatus::OutputFull);
  // Nothing is left over from a query that was cut.
  std::vector<Contact> room(scene.shell.size());
  EXPECT_EQ(finder.find(scene.X, room).contactCount, all.size());
}

TEST(ContactFinderLimits, ABudgetKeepsTheDeepestOfEachRegionForEveryMethod) {
  Scene scene(4);
  const auto all = findAll(scene.tree, scene.shell, {}, scene.X);
  double deepest = 0;
  for (const Contact& c : all) deepest = std::max(deepest, c.depth);
  for (const std::uint32_t budget : {0U, 1U, 7U, 40U, 150U}) {
    std::vector<std::uint32_t> first;
    for (const QueryMethod method : kMethods) {
      QueryOptions options;
      options.method = method;
      options.contactBudget = budget;
      ContactFinder finder(scene.tree, scene.shell, options);
      std::vector<Contact> out(scene.shell.size());
      const QueryResult result = finder.find(scene.X, out);
      EXPECT_EQ(result.status, QueryStatus::BudgetSpent);
      EXPECT_LE(result.contactCount, budget);
      EXPECT_EQ(result.contactCount == 0, budget == 0);
      std::vector<std::uint32_t> indices;
      double kept = 0;
      for (std::size_t i = 0; i < result.contactCount; ++i) {
        indices.push_back(out[i].shellIndex);
        kept = std::max(kept, out[i].depth);
        EXPECT_NE(out[i].flags & kContactApproximate, 0);
        if (i > 0) {
          EXPECT_LT(out[i - 1].shellIndex, out[i].shellIndex);
        }
        const auto same = std::find_if(all.begin(), all.end(), [&](const Contact& c) {
          return c.shellIndex == out[i].shellIndex && c.depth == out[i].depth;
        });
        EXPECT_NE(same, all.end());
      }
      // Only a cut that comes before the points themselves may miss the deepest.
      if (budget >= scene.shell.data().hierarchy.level[0].size()) {
        EXPECT_EQ(kept, deepest);
      }
      if (first.empty()) first = indices;
      EXPECT_EQ(indices, first);
    }
  }
  QueryOptions enough;
  enough.contactBudget = static_cast<std::uint32_t>(all.size());
  EXPECT_EQ(findAll(scene.tree, scene.shell, enough, scene.X).size(), all.size());
}

TEST(ContactFinderLimits, ABudgetLimitsTheWorkToo) {
  Scene scene(5);
  const PointShell shell = randomShell(scene.rng, 20000, 0.3 * scene.middle);
  const auto query = [&](QueryMethod method, std::uint32_t budget, const Eigen::Isometry3d& X) {
    QueryOptions options;
    options.method = method;
    options.contactBudget = budget;
    return ContactFinder(scene.tree, shell, options).findPacked(X);
  };
  Eigen::Isometry3d grazing = scene.X;
  grazing.translation().x() += 11e-3;
  for (const QueryMethod method : kMethods) {
    const QueryResult exact = query(method, 0xFFFFFFFF, scene.X);
    ASSERT_GT(exact.contactCount, 18000U) << "nearly all points are inside";
    // One point of sixteen, or of 256, is looked at; against each of them the paper's method tests
    // a path of the world's tree.
    const std::uint32_t share = method == QueryMethod::Paper ? 4 : 1;
    for (const auto& [budget, saving] : {std::pair{600U, 12U}, {50U, 60U}}) {
      const QueryResult cut = query(method, budget, scene.X);
      EXPECT_EQ(cut.status, QueryStatus::BudgetSpent);
      EXPECT_LT(cut.tests, exact.tests / saving * share);
      EXPECT_LE(cut.contactCount, budget);
      EXPECT_GT(cut.contactCount, budget / 16);
    }
    // A budget that is not reached costs the tests of a coarser shell, and changes nothing.
    const QueryResult few = query(method, 0xFFFFFFFF, grazing);
    ASSERT_GT(few.contactCount, 20U);
    ASSERT_LT(few.contactCount, 1250U) << "no coarser shell would be asked";
    const QueryResult below = query(method, static_cast<std::uint32_t>(few.contactCount), grazing);
    EXPECT_EQ(below.status, QueryStatus::Complete);
    EXPECT_EQ(below.contactCount, few.contactCount);
    EXPECT_GT(below.tests, few.tests);
    EXPECT_LT(below.tests, few.tests + few.tests / 2);
  }
}

TEST(ContactFinderLimits, AStopLevelGivesOneFlaggedContactANode) {
  for (const LeafModel leaf : {LeafModel::Voxel, LeafModel::Distance}) {
    for (const Branching branching :
         {Branching::Children8, Branching::Children64, Branching::Children512}) {
      Scene scene(6, leaf);
      scene.tree = VoxelTree::build(scene.grid, {}, {branching, leaf, false}).value();
      const auto exact = findAll(scene.tree, scene.shell, {}, scene.X);
      const VoxelTree::Data& data = scene.tree.data();
      for (int level = 1; level <= data.levels; ++level) {
        std::vector<std::uint32_t> first;
        for (const QueryMethod method : kMethods) {
          QueryOptions options;
          options.method = method;
          options.stopLevel = level;
          const auto cut = findAll(scene.tree, scene.shell, options, scene.X);
          std::set<std::array<int, 3>> nodes;
          std::vector<std::uint32_t> indices;
          for (const Contact& c : cut) {
            EXPECT_NE(c.flags & kContactApproximate, 0);
            EXPECT_GE(c.depth, 0.0);
            EXPECT_NEAR(Eigen::Vector3d(c.n[0], c.n[1], c.n[2]).norm(), 1.0, 1e-12);
            std::array<int, 3> node{};
            for (std::size_t a = 0; a < 3; ++a) {
              const auto axis = static_cast<Eigen::Index>(a);
              const double u = (c.p[a] - data.origin[axis]) / data.geometry.spacing[axis];
              node[a] = static_cast<int>(u) >> (data.bits * level);
            }
            EXPECT_TRUE(nodes.insert(node).second) << "two contacts in one node";
            indices.push_back(c.shellIndex);
          }
          EXPECT_FALSE(cut.empty());
          if (first.empty()) first = indices;
          EXPECT_EQ(indices, first);
          // Every exact contact lies in a node that answers.
          for (const Contact& c : exact) {
            std::array<int, 3> node{};
            for (std::size_t a = 0; a < 3; ++a) {
              const auto axis = static_cast<Eigen::Index>(a);
              const double u = (c.p[a] - data.origin[axis]) / data.geometry.spacing[axis];
              node[a] = static_cast<int>(u) >> (data.bits * level);
            }
            EXPECT_EQ(nodes.count(node), 1U);
          }
        }
      }
    }
  }
}

TEST(ContactFinderLimits, AStopLevelErrsInDepthByLessThanTheNode) {
  Scene scene(8);
  QueryOptions options;
  options.stopLevel = 1;
  const auto exact = findAll(scene.tree, scene.shell, {}, scene.X);
  const double node = 4 * scene.grid.geometry.spacing.norm();
  for (const Contact& c : findAll(scene.tree, scene.shell, options, scene.X)) {
    const auto same = std::find_if(exact.begin(), exact.end(),
                                   [&](const Contact& e) { return e.shellIndex == c.shellIndex; });
    EXPECT_NEAR(c.depth, same == exact.end() ? 0.0 : same->depth, node);
  }
}

TEST(ContactFinderLimits, CullingSavesTests) {
  Scene scene(9);
  const auto tests = [&](QueryOptions options) {
    ContactFinder finder(scene.tree, scene.shell, options);
    std::vector<Contact> out(scene.shell.size());
    Eigen::Isometry3d X = scene.X;
    X.translation() += Eigen::Vector3d(18e-3, 0, 0);
    return finder.find(X, out).tests;
  };
  QueryOptions brute;
  brute.method = QueryMethod::BruteForce;
  EXPECT_EQ(tests(brute), scene.shell.size());
  EXPECT_LT(tests({}), scene.shell.size() / 2);
  QueryOptions paper;
  paper.method = QueryMethod::Paper;
  paper.tightSpheres = false;
  paper.oneChildSkip = false;
  const auto plain = tests(paper);
  paper.sideOffset = true;
  const auto side = tests(paper);
  paper.tightSpheres = true;
  const auto tight = tests(paper);
  EXPECT_LT(side, plain);
  EXPECT_LE(tight, side);
}

}  // namespace
}  // namespace palpate
