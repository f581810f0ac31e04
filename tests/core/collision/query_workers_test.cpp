/// The threads of a query: every part once, and the same contacts at any number of threads.

#include "core/collision/query_workers.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstring>
#include <memory>
#include <random>
#include <thread>

#include "core/collision/contact_finder.h"
#include "core/collision/fast_query.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

struct Counts {
  std::array<int, 255> done{};  // each place has one writer a round
  int rounds = 0;               // written by the caller between rounds
};

TEST(QueryWorkers, EveryPartIsDoneOnceInEveryRound) {
  for (const int threads : {1, 2, 4}) {
    QueryWorkers workers(threads);
    EXPECT_EQ(workers.threads(), static_cast<std::size_t>(threads));
    Counts counts;
    for (int round = 0; round < 3000; ++round) {
      counts.rounds = round;
      const std::size_t parts = 1 + static_cast<std::size_t>(round) % 255;
      counts.done.fill(0);
      workers.run(
          [](void* context, std::size_t part, std::size_t /*thread*/) noexcept {
            auto& all = *static_cast<Counts*>(context);
            all.done[part] += 1 + all.rounds;
          },
          &counts, parts);
      for (std::size_t part = 0; part < counts.done.size(); ++part) {
        ASSERT_EQ(counts.done[part], part < parts ? 1 + round : 0) << "part " << part;
      }
      // Some rounds find the threads asleep.
      if (round % 500 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

TEST(QueryWorkers, StartAndStopWithoutWork) {
  for (int i = 0; i < 50; ++i) QueryWorkers workers(3);
}

// Enough points that the leaves are shared, in a shape that leaves parts of unequal contacts.
struct Scene {
  Scene() : rng(61), grid(testing_volumes::assortedGrids(61)[9].grid) {
    tree = std::make_unique<VoxelTree>(VoxelTree::build(grid, {}, {}).value());
  }
  std::mt19937 rng;
  LabelGrid grid;
  Eigen::Vector3d middle = oracle::middleOf(grid.geometry);
  PointShell shell = oracle::randomShell(rng, kLeavesToWake * 16 + 4000, 0.6 * middle);
  std::unique_ptr<VoxelTree> tree;
};

void expectSameBits(const std::vector<float>& a, const std::vector<float>& b, std::size_t count) {
  EXPECT_EQ(std::memcmp(a.data(), b.data(), count * sizeof(float)), 0);
}

TEST(QueryThreads, GiveTheSameBitsInTheSameOrder) {
  Scene scene;
  std::size_t shared = 0;
  for (const QueryMethod method : {QueryMethod::Hierarchy, QueryMethod::BruteForce}) {
    QueryOptions options;
    options.method = method;
    ContactFinder alone(*scene.tree, scene.shell, options);
    for (const int threads : {2, 3, 8}) {
      options.threads = threads;
      ContactFinder moved(*scene.tree, scene.shell, options);
      ContactFinder many(std::move(moved));
      for (int pose = 0; pose < 12; ++pose) {
        const Eigen::Isometry3d X = oracle::randomPose(
            scene.rng, scene.middle, pose % 4 == 0 ? 1.0 : 0.3 * scene.middle.maxCoeff());
        const QueryResult expected = alone.findPacked(X);
        const QueryResult found = many.findPacked(X);
        EXPECT_EQ(found.tests, expected.tests);
        ASSERT_EQ(found.contactCount, expected.contactCount);
        shared += found.tests >= kLeavesToWake * 16 ? 1 : 0;
        const PackedContacts& a = many.packed();
        const PackedContacts& b = alone.packed();
        for (std::size_t i = 0; i < found.contactCount; ++i) ASSERT_EQ(a.index[i], b.index[i]);
        expectSameBits(a.depth, b.depth, found.contactCount);
        expectSameBits(a.nx, b.nx, found.contactCount);
        expectSameBits(a.ny, b.ny, found.contactCount);
        expectSameBits(a.nz, b.nz, found.contactCount);
      }
    }
  }
  EXPECT_GE(shared, 40U) << "too few poses had leaves to share";
}

TEST(QueryThreads, ChangeNothingWhereTheyHaveNothingToDo) {
  Scene scene;
  for (const QueryMethod method : {QueryMethod::Hierarchy, QueryMethod::Paper}) {
    QueryOptions options;
    options.method = method;
    options.stopLevel = 1;
    const Eigen::Isometry3d X = oracle::randomPose(scene.rng, scene.middle, 1e-3);
    const auto expected = oracle::findAll(*scene.tree, scene.shell, options, X);
    options.threads = 4;
    const auto found = oracle::findAll(*scene.tree, scene.shell, options, X);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_EQ(std::memcmp(&found[i].depth, &expected[i].depth, sizeof(double)), 0);
    }
  }
}

}  // namespace
}  // namespace palpate
