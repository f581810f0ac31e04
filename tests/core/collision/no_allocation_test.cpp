/// find() takes no memory: the global operator new of this program counts.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "core/collision/clearance_finder.h"
#include "core/collision/contact_finder.h"
#include "core/collision/voxel_body_shell.h"
#include "core/voxels/tree_editor.h"
#include "tests/core/collision/oracle.h"
#include "tests/core/voxels/random_edits.h"
#include "tests/core/voxels/test_volumes.h"

// Inlined into the tests at -O1, these pairs look mismatched to GCC 12: the new of the library's
// header with our free.
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"

namespace {
std::atomic<long> allocations{0};

void* take(std::size_t size) {
  ++allocations;
  void* p = std::malloc(size == 0 ? 1 : size);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}
void* takeAligned(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto a = static_cast<std::size_t>(alignment);
  void* p = std::aligned_alloc(a, (size + a - 1) / a * a);
  if (p == nullptr) throw std::bad_alloc();
  return p;
}
}  // namespace

void* operator new(std::size_t size) {
  return take(size);
}
void* operator new[](std::size_t size) {
  return take(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return takeAligned(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return takeAligned(size, alignment);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}

namespace palpate {
namespace {

TEST(NoAllocation, AQueryTakesNoMemoryWhateverTheMethodAndOption) {
  std::mt19937 rng(13);
  const auto grid = testing_volumes::assortedGrids(13)[9].grid;
  const Eigen::Vector3d middle = oracle::middleOf(grid.geometry);
  // Points, and a voxel body with trees of its own.
  const PointShell points = oracle::randomShell(rng, 3000, 0.6 * middle);
  auto body = testing_volumes::assortedGrids(14)[9].grid;
  body.geometry.X_PV.translation() = -oracle::middleOf(body.geometry);
  const PointShell voxels = shellOfVoxelBody(body).value();
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < 50; ++i) poses.push_back(oracle::randomPose(rng, middle, 5e-3));
  std::vector<Contact> out(std::max(points.size(), voxels.size()));
  for (const LeafModel leaf : {LeafModel::Voxel, LeafModel::Distance}) {
    for (const Branching branching : {Branching::Children8, Branching::Children512}) {
      const auto tree = VoxelTree::build(grid, {}, {branching, leaf, false});
      ASSERT_TRUE(tree);
      for (const QueryMethod method :
           {QueryMethod::Hierarchy, QueryMethod::Paper, QueryMethod::BruteForce}) {
        for (const int stopLevel : {0, 2}) {
          for (const std::uint32_t budget : {0xFFFFFFFFU, 50U}) {
            QueryOptions options;
            options.method = method;
            options.stopLevel = stopLevel;
            options.contactBudget = budget;
            for (const PointShell& shell : {points, voxels}) {
              ContactFinder finder(*tree, shell, options);
              std::size_t contacts = 0;
              const long before = allocations.load();
              for (const auto& X : poses) contacts += finder.find(X, out).contactCount;
              EXPECT_EQ(allocations.load(), before);
              EXPECT_GT(contacts, 0U);
            }
          }
        }
      }
    }
  }
  // Threads that help, enough points that they do.
  const PointShell many = oracle::randomShell(rng, 60000, 0.6 * middle);
  const auto tree = VoxelTree::build(grid, {}, {});
  QueryOptions options;
  options.threads = 3;
  ContactFinder finder(*tree, many, options);
  const long start = allocations.load();
  for (const auto& X : poses) EXPECT_GT(finder.findPacked(X).contactCount, 100U);
  EXPECT_EQ(allocations.load(), start);

  const long before = allocations.load();
  const std::vector<int> probe(10);
  EXPECT_GT(allocations.load(), before) << "the count does not count";
}

TEST(NoAllocation, AClearanceTakesNoMemoryNearFarAndInside) {
  std::mt19937 rng(29);
  const auto grid = testing_volumes::assortedGrids(29)[9].grid;
  const Eigen::Vector3d middle = oracle::middleOf(grid.geometry);
  const PointShell shell = oracle::randomShell(rng, 3000, 0.6 * middle);
  std::vector<Eigen::Isometry3d> poses;
  for (const double spread : {5e-3, 5e-2, 5.0}) {
    for (int i = 0; i < 20; ++i) poses.push_back(oracle::randomPose(rng, middle, spread));
  }
  poses.push_back(Eigen::Isometry3d::Identity());
  poses.back().linear() *= 2;
  for (const Branching branching :
       {Branching::Children8, Branching::Children64, Branching::Children512}) {
    const auto tree = VoxelTree::build(grid, {}, {branching, LeafModel::Voxel, false});
    ASSERT_TRUE(tree);
    auto finder = ClearanceFinder::create(*tree, shell, {1.0});
    ASSERT_TRUE(finder);
    int seen[3] = {0, 0, 0};
    const long before = allocations.load();
    for (const auto& X : poses) ++seen[static_cast<int>(finder->find(X).status)];
    EXPECT_EQ(allocations.load(), before);
    for (const int times : seen) EXPECT_GT(times, 0);
  }
}

TEST(NoAllocation, EditsWithinTheReservedBoxTakeNoMemory) {
  constexpr std::uint32_t kSeed = 61;
  std::mt19937 rng(kSeed);
  for (const std::size_t which : {std::size_t{1}, std::size_t{9}}) {  // three labels; one
    const auto grid = testing_volumes::assortedGrids(kSeed)[which].grid;
    for (const LeafModel leaf : {LeafModel::Voxel, LeafModel::Distance}) {
      for (const Branching branching :
           {Branching::Children8, Branching::Children64, Branching::Children512}) {
        auto tree = VoxelTree::build(grid, {}, {branching, leaf, false});
        ASSERT_TRUE(tree);
        auto editor = TreeEditor::create(*tree);
        ASSERT_TRUE(editor);
        editor->separateLabels();
        editor->reserve({0, 0, 0}, grid.geometry.dims);
        std::size_t changed = 0;
        for (int round = 0; round < 60; ++round) {
          const auto edit = testing_volumes::randomEdit(rng, grid.geometry, 3);
          const long before = allocations.load();
          const EditResult result =
              edit.label == 0 ? editor->remove(edit.voxels) : editor->add(edit.voxels, edit.label);
          EXPECT_EQ(allocations.load(), before) << edit.name << ", seed " << kSeed;
          EXPECT_FALSE(result.tookMemory);  // large arrays map theirs
          changed += result.changed;
        }
        EXPECT_GT(changed, 0U);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
