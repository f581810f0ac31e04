#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>
#include <cstring>
#include <map>
#include <string>

#include "core/collision/contact_finder.h"
#include "core/collision/fast_query.h"
#include "core/collision/shell_hierarchy.h"
#include "core/voxels/voxel_tree_data.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/exhaustive_distance.h"

namespace palpate {
namespace {

using oracle::findAll;
using oracle::middleOf;
using oracle::randomPose;
using oracle::randomShell;
using testing_volumes::assortedGrids;
using testing_volumes::ballGrid;
using testing_volumes::boneLike;
using testing_volumes::makeGrid;
using testing_volumes::NamedGrid;

constexpr std::uint32_t kSeed = 6021;

// Narrow bricks, wide ones (deeper than eight voxels) and shared ones, cubic and not, far from
// thin, with several labels, and one with a single kind.
std::vector<NamedGrid> scenes() {
  std::vector<NamedGrid> all;
  const Eigen::Vector3d cubic = Eigen::Vector3d::Constant(0.5e-3);
  const Eigen::Vector3d flat(0.4e-3, 0.4e-3, 0.9e-3);
  all.push_back({"bone", boneLike(61, cubic, kSeed)});
  all.push_back({"anisotropic bone", boneLike(52, flat, kSeed + 1)});
  all.push_back({"ball of 24 voxels", ballGrid(58, cubic, 24.2 * 0.5e-3)});
  all.push_back({"deep anisotropic ball", ballGrid(56, flat, 24.4 * 0.4e-3)});
  std::mt19937 rng(kSeed);
  all.push_back({"cheese", makeGrid({70, 45, 44}, cubic, [&rng](int, int, int) {
                   return rng() % 20000 == 0 ? 0 : 1 + static_cast<int>(rng() % 3);
                 })});
  all.push_back({"dust", makeGrid({40, 41, 42}, flat,
                                  [&rng](int, int, int) { return rng() % 50 == 0 ? 2 : 0; })});
  all.push_back({"full", makeGrid({20, 21, 22}, flat, [](int, int, int) { return 7; })});
  all.push_back({"half", assortedGrids(kSeed)[1].grid});
  return all;
}

struct Scene {
  explicit Scene(const NamedGrid& named, std::size_t points = 6000)
      : rng(kSeed),
        grid(named.grid),
        middle(middleOf(grid.geometry)),
        tree(VoxelTree::build(grid, {}, {}).value()),
        shell(randomShell(rng, points, 0.9 * middle)) {
    for (int p = 0; p < 6; ++p) poses.push_back(randomPose(rng, middle, 0.3 * middle.maxCoeff()));
  }
  std::mt19937 rng;
  const LabelGrid& grid;
  Eigen::Vector3d middle;
  VoxelTree tree;
  PointShell shell;
  std::vector<Eigen::Isometry3d> poses;
};

void expectSameBits(const std::vector<Contact>& a, const std::vector<Contact>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].shellIndex, b[i].shellIndex);
    ASSERT_EQ(std::memcmp(a[i].p, b[i].p, sizeof a[i].p), 0) << i;
    ASSERT_EQ(std::memcmp(a[i].n, b[i].n, sizeof a[i].n), 0) << i;
    ASSERT_EQ(std::bit_cast<std::uint64_t>(a[i].depth), std::bit_cast<std::uint64_t>(b[i].depth));
    ASSERT_EQ(a[i].label, b[i].label);
    ASSERT_EQ(a[i].flags, b[i].flags);
  }
}

// Depth, label and saturation by the definition; the normal as the gradient of the definition's
// value, by its own differences.
TEST(DistanceLeaves, ContactsOfLargeScenesAreThoseOfTheDefinition) {
  std::size_t saturated = 0;
  std::size_t gradients = 0;
  for (const NamedGrid& named : scenes()) {
    SCOPED_TRACE(named.name + ", seed " + std::to_string(kSeed));
    Scene scene(named);
    const GridGeometry& g = scene.grid.geometry;
    const double s = g.spacing.minCoeff();
    std::vector<double> distance;  // metres
    const DepthPalette palette(g.spacing);
    for (const float square : testing_volumes::signedSquares(scene.grid, palette.weight())) {
      distance.push_back(std::clamp(testing_volumes::depthOf(square), -1e3, 1e3) * s);
    }
    for (const Eigen::Isometry3d& X : scene.poses) {
      const auto found = findAll(scene.tree, scene.shell, {}, X);
      std::size_t at = 0;
      for (std::uint32_t i = 0; i < scene.shell.size(); ++i) {
        const Eigen::Vector3d p = X * scene.shell.points_T()[i];
        const auto truth = oracle::contactAt(scene.grid, distance, LeafModel::Distance, p);
        const bool hit = at < found.size() && found[at].shellIndex == i;
        // Depths are stored to 1/3600 of a spacing, points placed to 1/16000.
        const bool nearFace = [&] {
          for (int a = 0; a < 3; ++a) {
            const double u = p[a] / g.spacing[a];
            if (std::abs(u) < 1e-4 || std::abs(u - g.dims[static_cast<std::size_t>(a)] + 1) < 1e-4)
              return true;
          }
          return false;
        }();
        if (std::abs(truth.value) < 1e-3 * s || nearFace) {
          at += hit ? 1 : 0;
          continue;
        }
        ASSERT_EQ(hit, truth.inside) << "point " << i << " at " << p.transpose();
        if (!hit) continue;
        const Contact& c = found[at++];
        const Eigen::Vector3d n(c.n[0], c.n[1], c.n[2]);
        ASSERT_NEAR(n.norm(), 1.0, 1e-9);
        ASSERT_NEAR(c.depth, std::min(-truth.value, 16 * s), 1e-3 * s);
        if (std::abs(-truth.value - 16 * s) > 1e-3 * s) {
          ASSERT_EQ((c.flags & kContactSaturated) != 0, -truth.value > 16 * s);
        }
        saturated += (c.flags & kContactSaturated) != 0 ? 1U : 0U;
        ASSERT_NE(c.label, 0);
        if (c.depth > 15.9 * s) continue;
        // Central differences within the cell, where the value is linear along each axis.
        Eigen::Vector3d gradient;
        bool within = true;
        for (int a = 0; a < 3; ++a) {
          const double h = 1e-3 * g.spacing[a];
          const double in = p[a] / g.spacing[a] - std::floor(p[a] / g.spacing[a]);
          within = within && in > 2e-3 && in < 1 - 2e-3;
          const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(a);
          gradient[a] =
              (oracle::contactAt(scene.grid, distance, LeafModel::Distance, p + step).value -
               oracle::contactAt(scene.grid, distance, LeafModel::Distance, p - step).value) /
              (2 * h);
        }
        // Where it nearly vanishes it has no direction to compare.
        if (!within || gradient.norm() < 0.2) continue;
        ++gradients;
        ASSERT_LT((n - gradient.normalized()).norm(), 0.01) << "point " << i;
      }
      EXPECT_EQ(at, found.size());
    }
  }
  EXPECT_GT(saturated, 1000U);
  EXPECT_GT(gradients, 10000U);
}

TEST(DistanceLeaves, EveryMethodGivesTheSameBitsInLargeScenes) {
  for (const NamedGrid& named : scenes()) {
    SCOPED_TRACE(named.name + ", seed " + std::to_string(kSeed));
    Scene scene(named, 20000);
    std::size_t contacts = 0;
    for (Eigen::Isometry3d X : scene.poses) {
      // Deep within, and where the shell hardly touches: there culling has the most to lose.
      for (const double away : {0.0, 1.3, 1.9}) {
        X.translation() += away * scene.middle.maxCoeff() * Eigen::Vector3d(0.6, -0.5, 0.62);
        const auto expected = findAll(scene.tree, scene.shell, {QueryMethod::BruteForce}, X);
        contacts += expected.size();
        expectSameBits(findAll(scene.tree, scene.shell, {QueryMethod::Hierarchy}, X), expected);
        if (away == 0.0) {
          expectSameBits(findAll(scene.tree, scene.shell, {QueryMethod::Paper}, X), expected);
        }
        if (HasFatalFailure()) return;
        X.translation() -= away * scene.middle.maxCoeff() * Eigen::Vector3d(0.6, -0.5, 0.62);
      }
    }
    EXPECT_GT(contacts, 100U);
  }
}

// Shells of a few close points, just above and below a surface: here a clearance that is too large
// by a hundredth of a voxel would hide a contact.
TEST(DistanceLeaves, NoGrazingContactIsLost) {
  std::size_t touching = 0;
  std::size_t missing = 0;
  for (const NamedGrid& named : scenes()) {
    SCOPED_TRACE(named.name + ", seed " + std::to_string(kSeed));
    Scene scene(named, 10);
    const double s = scene.grid.geometry.spacing.minCoeff();
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int trial = 0; trial < 25; ++trial) {
      // Small clusters far apart, so that each is a node of its own.
      std::vector<Eigen::Vector3d> points;
      for (int cluster = 0; cluster < 80; ++cluster) {
        const Eigen::Vector3d at =
            1.1 * Eigen::Vector3d(uniform(scene.rng), uniform(scene.rng), uniform(scene.rng))
                      .cwiseProduct(scene.middle);
        for (int n = 0; n < 16; ++n) {
          points.emplace_back(
              at + 0.02 * s *
                       Eigen::Vector3d(uniform(scene.rng), uniform(scene.rng), uniform(scene.rng)));
        }
      }
      const PointShell shell =
          PointShell::fromPoints(
              points, std::vector<Eigen::Vector3d>(points.size(), Eigen::Vector3d::UnitY()))
              .value();
      const Eigen::Isometry3d X = randomPose(scene.rng, scene.middle, 0.1 * s);
      const auto expected = findAll(scene.tree, shell, {QueryMethod::BruteForce}, X);
      touching += expected.size();
      missing += shell.size() - expected.size();
      expectSameBits(findAll(scene.tree, shell, {QueryMethod::Hierarchy}, X), expected);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(touching, 10000U);
  EXPECT_GT(missing, 10000U);
}

TEST(DistanceLeaves, FarOriginsLoseNoContact) {
  for (const NamedGrid& named : scenes()) {
    SCOPED_TRACE(named.name + ", seed " + std::to_string(kSeed));
    Scene scene(named, 3000);
    for (const double far : {1.0, 1e3, 1e6}) {
      const Eigen::Vector3d away = far * Eigen::Vector3d(0.8, -0.5, 0.3);
      std::vector<Eigen::Vector3d> points(scene.shell.points_T().begin(),
                                          scene.shell.points_T().end());
      for (auto& p : points) p += away;
      const PointShell shell = PointShell::fromPoints(points, {scene.shell.normals_T().begin(),
                                                               scene.shell.normals_T().end()})
                                   .value();
      for (Eigen::Isometry3d X : scene.poses) {
        const auto home = findAll(scene.tree, scene.shell, {QueryMethod::BruteForce}, X);
        X.translation() -= X.linear() * away;
        const auto expected = findAll(scene.tree, shell, {QueryMethod::BruteForce}, X);
        expectSameBits(findAll(scene.tree, shell, {QueryMethod::Hierarchy}, X), expected);
        if (HasFatalFailure()) return;
        // Doubles at a thousand kilometres are good to a nanometre; few points lie that close.
        EXPECT_NEAR(static_cast<double>(expected.size()), static_cast<double>(home.size()),
                    0.001 * static_cast<double>(home.size()) + 1.5)
            << far;
      }
    }
  }
}

std::map<std::uint32_t, std::size_t> placesOf(const PackedContacts& packed) {
  std::map<std::uint32_t, std::size_t> places;
  for (std::size_t i = 0; i < packed.count; ++i) places[packed.index[i]] = i;
  return places;
}

TEST(PackedContacts, AreThoseOfFindInTheOrderOfTheHierarchy) {
  const auto all = scenes();
  for (const std::size_t which : {1U, 2U, 4U, 5U, 7U}) {
    const NamedGrid& named = all[which];
    for (const LeafModel leaf : {LeafModel::Distance, LeafModel::Voxel}) {
      Scene scene(named);
      scene.tree = VoxelTree::build(scene.grid, {}, {Branching::Children64, leaf, false}).value();
      const double s = scene.grid.geometry.spacing.minCoeff();
      std::vector<std::size_t> rank(scene.shell.size());
      const auto& order = scene.shell.data().hierarchy.order;
      for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
      for (const QueryMethod method :
           {QueryMethod::Hierarchy, QueryMethod::Paper, QueryMethod::BruteForce}) {
        SCOPED_TRACE(named.name + ", seed " + std::to_string(kSeed) + ", leaf " +
                     std::to_string(static_cast<int>(leaf)) + ", method " +
                     std::to_string(static_cast<int>(method)));
        ContactFinder finder(scene.tree, scene.shell, {method});
        std::vector<Contact> out(scene.shell.size());
        for (const Eigen::Isometry3d& X : scene.poses) {
          const QueryResult found = finder.find(X, out);
          const QueryResult result = finder.findPacked(X);
          EXPECT_EQ(result.status, QueryStatus::Complete);
          const PackedContacts& packed = finder.packed();
          ASSERT_EQ(packed.count, found.contactCount);
          ASSERT_EQ(result.contactCount, found.contactCount);
          const auto places = placesOf(packed);
          ASSERT_EQ(places.size(), packed.count);
          for (std::size_t i = 0; i < found.contactCount; ++i) {
            const Contact& c = out[i];
            ASSERT_EQ(places.count(c.shellIndex), 1U);
            const std::size_t at = places.at(c.shellIndex);
            ASSERT_EQ(packed.depth[at], static_cast<float>(c.depth));
            ASSERT_NEAR(static_cast<double>(packed.nx[at]), c.n[0], 1e-6);
            ASSERT_NEAR(static_cast<double>(packed.ny[at]), c.n[1], 1e-6);
            ASSERT_NEAR(static_cast<double>(packed.nz[at]), c.n[2], 1e-6);
            // (A voxel's plane is not cut off there, whatever packed_contacts.h says of it.)
            if (leaf == LeafModel::Distance && (c.flags & kContactSaturated) != 0) {
              ASSERT_EQ(packed.depth[at], static_cast<float>(16 * s));
            }
          }
          if (method == QueryMethod::Paper) continue;  // its order: see below
          for (std::size_t i = 1; i < packed.count; ++i) {
            ASSERT_LT(rank[packed.index[i - 1]], rank[packed.index[i]]);
          }
        }
      }
    }
  }
}

TEST(PackedContacts, OfPaperHaveTheOrderOfTheHierarchyToo) {
  const auto all = scenes();
  Scene scene(all[0]);
  const auto& order = scene.shell.data().hierarchy.order;
  std::vector<std::size_t> rank(order.size());
  for (std::size_t r = 0; r < order.size(); ++r) rank[order[r]] = r;
  ContactFinder finder(scene.tree, scene.shell, {QueryMethod::Paper});
  ASSERT_GT(finder.findPacked(scene.poses[0]).contactCount, 2U);
  for (std::size_t i = 1; i < finder.packed().count; ++i) {
    ASSERT_LT(rank[finder.packed().index[i - 1]], rank[finder.packed().index[i]]);
  }
}

TEST(PackedContacts, ObeyBudgetStopLevelAndPoseAsFindDoes) {
  const auto all = scenes();
  for (const QueryOptions& options :
       {QueryOptions{QueryMethod::Hierarchy, true, true, false, 0, 50},
        QueryOptions{QueryMethod::Hierarchy, true, true, false, 2},
        QueryOptions{QueryMethod::Paper, true, true, false, 1},
        QueryOptions{QueryMethod::BruteForce, true, true, false, 0, 7}}) {
    Scene scene(all[0]);
    ContactFinder finder(scene.tree, scene.shell, options);
    std::vector<Contact> out(scene.shell.size());
    for (const Eigen::Isometry3d& X : scene.poses) {
      const QueryResult found = finder.find(X, out);
      const QueryResult result = finder.findPacked(X);
      EXPECT_EQ(result.status, found.status);
      ASSERT_EQ(result.contactCount, found.contactCount);
      ASSERT_EQ(finder.packed().count, found.contactCount);
      const auto places = placesOf(finder.packed());
      for (std::size_t i = 0; i < found.contactCount; ++i) {
        ASSERT_EQ(places.count(out[i].shellIndex), 1U);
        EXPECT_EQ(finder.packed().depth[places.at(out[i].shellIndex)],
                  static_cast<float>(out[i].depth));
      }
    }
    Eigen::Isometry3d bad = scene.poses[0];
    bad.matrix()(0, 0) += 0.1;
    EXPECT_EQ(finder.findPacked(bad).status, QueryStatus::BadPose);
    EXPECT_EQ(finder.packed().count, 0U);
  }
}

// Puts the choice of vector instructions back however a test ends.
struct EveryTarget {
  ~EveryTarget() { choose(0); }
  static void choose(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  std::vector<std::int64_t> all = hwy::SupportedAndGeneratedTargets();
};

TEST(VectorTargets, GiveTheSameContactsBitForBit) {
  const EveryTarget targets;
  ASSERT_GT(targets.all.size(), 1U);
  std::size_t contacts = 0;
  for (const NamedGrid& named : scenes()) {
    Scene scene(named);
    for (const QueryMethod method : {QueryMethod::Hierarchy, QueryMethod::BruteForce}) {
      std::vector<std::vector<Contact>> expected;
      std::vector<PackedContacts> packed;
      for (const std::int64_t target : targets.all) {
        SCOPED_TRACE(named.name + ", seed " + std::to_string(kSeed) + ", method " +
                     std::to_string(static_cast<int>(method)) + ", " + hwy::TargetName(target));
        EveryTarget::choose(target);
        ASSERT_STREQ(fastQueryTarget(), hwy::TargetName(target));
        ContactFinder finder(scene.tree, scene.shell, {method});
        for (std::size_t p = 0; p < scene.poses.size(); ++p) {
          const auto found = findAll(scene.tree, scene.shell, {method}, scene.poses[p]);
          ASSERT_EQ(finder.findPacked(scene.poses[p]).contactCount, found.size());
          if (expected.size() <= p) {
            expected.push_back(found);
            packed.push_back(finder.packed());
            contacts += found.size();
            continue;
          }
          expectSameBits(found, expected[p]);
          const PackedContacts& now = finder.packed();
          const auto same = [&](const auto& a, const auto& b) {
            return std::memcmp(a.data(), b.data(), now.count * sizeof a[0]) == 0;
          };
          EXPECT_TRUE(same(now.index, packed[p].index));
          EXPECT_TRUE(same(now.depth, packed[p].depth));
          EXPECT_TRUE(same(now.nx, packed[p].nx));
          EXPECT_TRUE(same(now.ny, packed[p].ny));
          EXPECT_TRUE(same(now.nz, packed[p].nz));
          if (HasFatalFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(contacts, 10000U);
}

TEST(VectorTargets, BuildTheSameTreeBitForBit) {
  const EveryTarget targets;
  const auto all = scenes();
  for (const std::size_t s : {1U, 2U, 5U, 7U}) {
    const NamedGrid& named = all[s];
    EveryTarget::choose(targets.all.front());
    const auto expected = VoxelTree::build(named.grid, {}, {});
    for (const std::int64_t target : targets.all) {
      SCOPED_TRACE(named.name + ", " + hwy::TargetName(target));
      EveryTarget::choose(target);
      const auto tree = VoxelTree::build(named.grid, {}, {});
      EXPECT_EQ(tree->data().depth.coarse, expected->data().depth.coarse);
      EXPECT_EQ(tree->data().depth.words, expected->data().depth.words);
      EXPECT_EQ(tree->data().depth.slots, expected->data().depth.slots);
    }
  }
}

}  // namespace
}  // namespace palpate
