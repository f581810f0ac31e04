#include "core/voxels/voxel_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "core/voxels/distance_field.h"
#include "core/voxels/leaf_codes.h"
#include "core/voxels/surface_descriptor.h"
#include "core/voxels/voxel_tree_data.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::assortedGrids;
using testing_volumes::emptyGrid;
using testing_volumes::makeGrid;
using testing_volumes::solidOf;

using Address = std::array<std::int32_t, 3>;

constexpr std::uint32_t kSeed = 2008;

struct Leaf {
  Address item;
  std::uint16_t code = 0;  // of voxel leaves
  std::uint8_t label = 0;
};

// Walks links and masks from the root, as any reader must, and lists the items it reaches.
template <int Bits>
void walk(const VoxelTree::Data& d, int level, std::size_t node, const Address& address,
          std::vector<Leaf>& items) {
  using Mask = NodeMask<Bits>;
  const TreeLevel& at = d.level[static_cast<std::size_t>(level)];
  const Mask mask = Mask::load(at.masks.data(), node);
  ASSERT_FALSE(mask.empty()) << "a node without a child";
  std::size_t next = level == 1 ? 0 : at.firstChild[node];
  forEachChild(mask, [&](int c) {
    const Address child{address[0] * Mask::kEdge + (c & Mask::kLow),
                        address[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                        address[2] * Mask::kEdge + (c >> (2 * Bits))};
    if (level > 1) return walk<Bits>(d, level - 1, next++, child, items);
    Leaf leaf{child};
    if (d.options.leaf == LeafModel::Voxel) {
      leaf.code = leafCode(d.leafBytes, at.firstChild[node], mask.rank(c));
      leaf.label = d.depth.uniformLabel != 0
                       ? d.depth.uniformLabel
                       : leafLabel(d.leafBytes, at.firstChild[node], mask.count(), mask.rank(c));
    }
    items.push_back(leaf);
  });
}

std::vector<Leaf> itemsOf(const VoxelTree& tree) {
  const VoxelTree::Data& d = tree.data();
  std::vector<Leaf> items;
  if (d.bits == 1) walk<1>(d, d.levels, 0, {0, 0, 0}, items);
  if (d.bits == 2) walk<2>(d, d.levels, 0, {0, 0, 0}, items);
  if (d.bits == 3) walk<3>(d, d.levels, 0, {0, 0, 0}, items);
  return items;
}

constexpr Branching kBranchings[] = {Branching::Children8, Branching::Children64,
                                     Branching::Children512};

TEST(VoxelTree, HoldsExactlyTheSolidVoxelsWithTheirLabelAndDepth) {
  for (const auto& [name, grid] : assortedGrids(kSeed)) {
    const auto field = signedDistanceField(grid.geometry, solidOf(grid));
    ASSERT_TRUE(field);
    for (const Branching branching : kBranchings) {
      SCOPED_TRACE(name + ", " + std::to_string(static_cast<int>(branching)) + " children, seed " +
                   std::to_string(kSeed));
      const auto tree = VoxelTree::build(grid, {}, {branching, LeafModel::Voxel, false});
      ASSERT_TRUE(tree);
      std::set<Address> seen;
      const double s = grid.geometry.spacing.minCoeff();
      for (const auto& [item, code, label] : itemsOf(*tree)) {
        ASSERT_TRUE(grid.geometry.contains(item[0], item[1], item[2]));
        const std::size_t at = grid.geometry.index(item[0], item[1], item[2]);
        EXPECT_NE(grid.labels[at], 0);
        EXPECT_EQ(label, grid.labels[at]);
        const double depth = -static_cast<double>(tree->data().depth.palette.value(code)) * s;
        if (code != tree->data().depth.palette.deepestCode()) {
          EXPECT_NEAR(depth, static_cast<double>(-(*field)[at]), 1e-5 * s);
        } else {
          EXPECT_GE(static_cast<double>(-(*field)[at]), kSaturationVoxels * s);
        }
        EXPECT_TRUE(seen.insert(item).second);
      }
      std::size_t solid = 0;
      for (const auto label : grid.labels) solid += label != 0 ? 1 : 0;
      EXPECT_EQ(seen.size(), solid);
      EXPECT_EQ(tree->stats().solidVoxels, solid);
    }
  }
}

TEST(VoxelTree, DistanceLeavesAreTheCellsWithACornerInside) {
  for (const auto& [name, grid] : assortedGrids(kSeed)) {
    for (const Branching branching : kBranchings) {
      SCOPED_TRACE(name + ", " + std::to_string(static_cast<int>(branching)));
      const auto tree = VoxelTree::build(grid, {}, {branching, LeafModel::Distance, false});
      ASSERT_TRUE(tree);
      std::set<Address> seen;
      for (const auto& item : itemsOf(*tree)) seen.insert(item.item);
      for (int k = 0; k + 1 < grid.geometry.dims[2]; ++k) {
        for (int j = 0; j + 1 < grid.geometry.dims[1]; ++j) {
          for (int i = 0; i + 1 < grid.geometry.dims[0]; ++i) {
            bool any = false;
            for (int c = 0; c < 8; ++c) {
              any = any || grid.at(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2)) != 0;
            }
            ASSERT_EQ(seen.count({i, j, k}) != 0, any) << i << " " << j << " " << k;
          }
        }
      }
    }
  }
}

TEST(VoxelTree, SurfaceOnlyHoldsTheSurfaceVoxels) {
  const auto grids = assortedGrids(kSeed);
  for (const auto& [name, grid] : grids) {
    SCOPED_TRACE(name);
    const auto tree = VoxelTree::build(grid, {}, {Branching::Children64, LeafModel::Voxel, true});
    ASSERT_TRUE(tree);
    std::set<Address> seen;
    for (const auto& item : itemsOf(*tree)) seen.insert(item.item);
    const auto expected = surfaceVoxels(grid.geometry, solidOf(grid));
    EXPECT_EQ(seen, std::set<Address>(expected.begin(), expected.end()));
    EXPECT_EQ(tree->stats().surfaceVoxels, expected.size());
  }
}

TEST(VoxelTree, SelectsTheNamedLabelsOnly) {
  const auto grid = makeGrid({6, 6, 6}, Eigen::Vector3d::Ones(), [](int i, int, int) { return i; });
  const std::uint8_t wanted[] = {2, 5};
  const auto tree =
      VoxelTree::build(grid, wanted, {Branching::Children64, LeafModel::Voxel, false});
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->stats().solidVoxels, 72U);
  for (const Leaf& leaf : itemsOf(*tree)) EXPECT_TRUE(leaf.label == 2 || leaf.label == 5);
}

TEST(VoxelTree, StatisticsCountWhatIsThere) {
  const auto grid = makeGrid({70, 5, 9}, Eigen::Vector3d::Ones(),
                             [](int i, int j, int k) { return i == 0 && j == 0 && k == 0; });
  const int levels[] = {7, 4, 3};  // 2^7, 4^4 (4^3 = 64 is too small) and 8^3 hold 70
  for (std::size_t b = 0; b < 3; ++b) {
    const auto tree = VoxelTree::build(grid, {}, {kBranchings[b], LeafModel::Voxel, false});
    ASSERT_TRUE(tree);
    EXPECT_EQ(tree->stats().levels, levels[b]);
    EXPECT_EQ(tree->stats().nodesPerLevel,
              std::vector<std::size_t>(static_cast<std::size_t>(levels[b]), 1));
    const std::size_t mask = static_cast<std::size_t>(kBranchings[b]) / 8;
    const auto depth = static_cast<std::size_t>(levels[b]);
    EXPECT_EQ(tree->stats().topologyBytes, depth * mask + (depth - 1) * 4);
    EXPECT_EQ(tree->stats().payloadBytes, 4U + 1U);  // a link to six bits
    EXPECT_GT(tree->stats().buildMs, 0.0);
  }
}

TEST(VoxelTree, TheSameGridGivesTheSameBits) {
  const auto grid = assortedGrids(kSeed)[1].grid;
  const auto a = VoxelTree::build(grid, {}, {});
  const auto b = VoxelTree::build(grid, {}, {});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->data().depth.coarse, b->data().depth.coarse);
  EXPECT_EQ(a->data().depth.words, b->data().depth.words);
  EXPECT_EQ(a->data().depth.slots, b->data().depth.slots);
  EXPECT_EQ(a->data().level[1].masks, b->data().level[1].masks);
}

TEST(VoxelTree, AnEmptySelectionIsRefused) {
  const auto nothing = emptyGrid({4, 4, 4}, Eigen::Vector3d::Ones());
  const auto none = VoxelTree::build(nothing, {}, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::InputRefused);
  EXPECT_EQ(none.error().message, "No voxel of the label volume is selected, so there is no tree.");
  EXPECT_EQ(none.error().field, "labels");
  const auto ones = makeGrid({4, 4, 4}, Eigen::Vector3d::Ones(), [](int, int, int) { return 1; });
  const std::uint8_t other[] = {3, 0};
  EXPECT_FALSE(VoxelTree::build(ones, other, {}));
}

TEST(VoxelTree, FewerThanTwoVoxelsAlongAnAxisAreRefused) {
  constexpr const char* kAxis[] = {"x", "y", "z"};
  for (std::size_t a = 0; a < 3; ++a) {
    Address dims{4, 4, 4};
    dims[a] = 1;
    const auto grid = makeGrid(dims, Eigen::Vector3d::Ones(), [](int, int, int) { return 1; });
    const auto tree = VoxelTree::build(grid, {}, {});
    ASSERT_FALSE(tree);
    EXPECT_EQ(tree.error().kind, ErrorKind::InputRefused);
    EXPECT_EQ(tree.error().message,
              std::string("The label volume has fewer than two voxels along ") + kAxis[a] + ".");
    EXPECT_EQ(tree.error().found, "1");
    EXPECT_EQ(tree.error().expected, "at least 2");
  }
}

TEST(VoxelTree, AGridThatContradictsItselfIsRefused) {
  auto grid = makeGrid({4, 4, 4}, Eigen::Vector3d::Ones(), [](int, int, int) { return 1; });
  grid.labels.pop_back();
  auto tree = VoxelTree::build(grid, {}, {});
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().message, "The label volume does not hold as many labels as voxels.");
  EXPECT_EQ(tree.error().found, "63");
  grid.labels.push_back(1);
  grid.geometry.spacing.y() = 0;
  tree = VoxelTree::build(grid, {}, {});
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().message, "The voxel spacing along y is not a positive length.");
  grid.geometry.spacing.y() = 1001;
  tree = VoxelTree::build(grid, {}, {});
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().message, "The voxels are too long for their width.");
  EXPECT_EQ(tree.error().expected, "at most 1 to 1000");
}

TEST(VoxelTree, ReportsProgressInOrderAndStopsWhenCancelled) {
  const auto grid = assortedGrids(kSeed)[9].grid;
  double last = -1;
  int calls = 0;
  Progress progress;
  progress.report = [&](double fraction, const std::string& what) {
    EXPECT_GE(fraction, last);
    EXPECT_FALSE(what.empty());
    last = fraction;
    ++calls;
  };
  EXPECT_TRUE(VoxelTree::build(grid, {}, {}, progress));
  EXPECT_EQ(last, 1.0);
  EXPECT_GT(calls, 3);

  CancelToken token;
  Progress stopping;
  stopping.cancel = &token;
  stopping.report = [&](double fraction, const std::string&) {
    if (fraction > 0.6) token.cancel();
  };
  const auto tree = VoxelTree::build(grid, {}, {}, stopping);
  ASSERT_FALSE(tree);
  EXPECT_EQ(tree.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace palpate
