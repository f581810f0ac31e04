#include "core/voxels/pattern_spheres.h"

#include <gtest/gtest.h>

#include <set>

#include "core/voxels/voxel_tree.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::assortedGrids;
using testing_volumes::makeGrid;

// Every node of a tree: the looked-up sphere is the one that SphereTable computes from its mask.
template <int Bits>
void expectSameAsTable(const VoxelTree::Data& tree, SphereKind kind) {
  using Mask = NodeMask<Bits>;
  const PatternSpheres spheres(tree.bits, tree.geometry.spacing, kind, tree.level);
  std::set<std::array<std::uint64_t, Mask::kWords>> patterns;
  for (int level = 1; level <= tree.levels; ++level) {
    const auto& masks = tree.level[static_cast<std::size_t>(level)].masks;
    const double child = std::ldexp(1.0, Bits * (level - 1));  // edge of a child in leaf cells
    for (std::size_t n = 0; n * Mask::kBytes < masks.size(); ++n) {
      const Mask mask = Mask::load(masks.data(), n);
      patterns.insert(mask.word);
      const NodeSphere expected = tree.spheres.sphere(mask, level, kind);
      const PatternSphere& found = spheres.of(mask);
      ASSERT_DOUBLE_EQ(found.radius * child, expected.radius);
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        ASSERT_NEAR(found.offset[a] * child * tree.geometry.spacing[axis], expected.offset[axis],
                    1e-15 * expected.radius);
      }
    }
  }
  EXPECT_DOUBLE_EQ(spheres.full().radius, tree.spheres.fullRadius(1));
  EXPECT_EQ(spheres.full().offset, (std::array<double, 3>{0, 0, 0}));
  if (kind == SphereKind::Full) {
    EXPECT_EQ(spheres.size(), 1U);
  } else if (Bits > 1) {
    EXPECT_EQ(spheres.size(), patterns.size() + 1) << "one for each pattern that occurs";
  }
}

TEST(PatternSpheres, EveryNodeOfATreeFindsItsOwn) {
  constexpr std::uint32_t kSeed = 51;
  auto grids = assortedGrids(kSeed);
  // Thousands of different patterns, so that the hash grows and collides.
  std::mt19937 rng(kSeed);
  grids.push_back({"large", makeGrid({70, 64, 66}, Eigen::Vector3d(1e-3, 0.7e-3, 2e-3),
                                     [&rng](int, int, int) { return rng() % 9 == 0 ? 1 : 0; })});
  for (const auto& [name, grid] : grids) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    for (const SphereKind kind : {SphereKind::Full, SphereKind::SideOffset, SphereKind::Tight}) {
      const auto tree = [&](Branching branching) {
        return VoxelTree::build(grid, {}, {branching, LeafModel::Voxel, false}).value();
      };
      expectSameAsTable<1>(tree(Branching::Children8).data(), kind);
      expectSameAsTable<2>(tree(Branching::Children64).data(), kind);
      expectSameAsTable<3>(tree(Branching::Children512).data(), kind);
    }
  }
}

// No node is lost where a pattern is asked that the tree does not have.
TEST(PatternSpheres, AnUnknownPatternGetsTheWholeNodesSphere) {
  const auto grid = assortedGrids(52)[9].grid;
  const auto tree =
      VoxelTree::build(grid, {}, {Branching::Children64, LeafModel::Voxel, false}).value();
  const PatternSpheres spheres(2, grid.geometry.spacing, SphereKind::Tight, tree.data().level);
  NodeMask<2> checkerboard;
  checkerboard.word[0] = 0x5A5AA5A55A5AA5A5U;
  EXPECT_EQ(&spheres.of(checkerboard), &spheres.full());
}

}  // namespace
}  // namespace palpate
