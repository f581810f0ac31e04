#pragma once
/// Is an edited tree what a build from the edited labels gives? Whatever a reader can reach is
/// compared: items, codes, labels, counts.

#include <gtest/gtest.h>

#include <map>

#include "core/voxels/leaf_codes.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate::testing_volumes {

using ItemAddress = std::array<std::int32_t, 3>;

struct VoxelLeaf {
  std::uint16_t code = 0;
  std::uint8_t label = 0;
  [[nodiscard]] bool operator==(const VoxelLeaf&) const = default;
};
using Leaves = std::map<ItemAddress, VoxelLeaf>;

template <int Bits>
void walkTree(const VoxelTree::Data& d, int level, std::size_t node, const ItemAddress& address,
              Leaves& leaves, std::vector<std::size_t>& nodes) {
  using Mask = NodeMask<Bits>;
  const TreeLevel& at = d.level[static_cast<std::size_t>(level)];
  ASSERT_LT(node, at.masks.size() / Mask::kBytes);
  const Mask mask = Mask::load(at.masks.data(), node);
  ASSERT_FALSE(mask.empty()) << "a node without a child";
  ++nodes[static_cast<std::size_t>(level - 1)];
  std::size_t next = level == 1 ? 0 : at.firstChild[node];
  forEachChild(mask, [&](int c) {
    const ItemAddress child{address[0] * Mask::kEdge + (c & Mask::kLow),
                            address[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                            address[2] * Mask::kEdge + (c >> (2 * Bits))};
    if (level > 1) return walkTree<Bits>(d, level - 1, next++, child, leaves, nodes);
    VoxelLeaf leaf;
    if (d.options.leaf == LeafModel::Voxel) {
      leaf.code = leafCode(d.leafBytes, at.firstChild[node], mask.rank(c));
      leaf.label = d.depth.uniformLabel != 0
                       ? d.depth.uniformLabel
                       : leafLabel(d.leafBytes, at.firstChild[node], mask.count(), mask.rank(c));
    }
    leaves[child] = leaf;
  });
}

inline void walkTree(const VoxelTree& tree, Leaves& leaves, std::vector<std::size_t>& nodes) {
  const VoxelTree::Data& d = tree.data();
  nodes.assign(static_cast<std::size_t>(d.levels), 0);
  if (d.bits == 1) walkTree<1>(d, d.levels, 0, {0, 0, 0}, leaves, nodes);
  if (d.bits == 2) walkTree<2>(d, d.levels, 0, {0, 0, 0}, leaves, nodes);
  if (d.bits == 3) walkTree<3>(d, d.levels, 0, {0, 0, 0}, leaves, nodes);
}

/// Every corner of every block of 4³ cells. Bricks that are saturated all over in a build share
/// ramps; an edited one need only be saturated too.
inline void expectSameBricks(const VoxelTree::Data& edited, const VoxelTree::Data& built) {
  const DepthPalette& palette = built.depth.palette;
  const auto deep = [&palette](const DepthBricks& d, std::uint32_t link) {
    for (int n = 0; n < 125; ++n) {
      const std::uint16_t code = d.codeAt(link, n % 5, n / 5 % 5, n / 25);
      if (palette.value(code) > 0.0f || code < palette.saturatedCode()) return false;
    }
    return true;
  };
  ItemAddress cell;
  for (cell[2] = 0; cell[2] < built.extent[2]; cell[2] += 4) {
    for (cell[1] = 0; cell[1] < built.extent[1]; cell[1] += 4) {
      for (cell[0] = 0; cell[0] < built.extent[0]; cell[0] += 4) {
        const std::uint32_t a = edited.depth.linkAt(cell);
        const std::uint32_t b = built.depth.linkAt(cell);
        ASSERT_EQ(a != 0, b != 0) << "brick at " << cell[0] << ' ' << cell[1] << ' ' << cell[2];
        if (b == 0) continue;
        const bool saturated = deep(built.depth, b);
        ASSERT_EQ(deep(edited.depth, a), saturated);
        for (int n = 0; n < 125; ++n) {
          const int x = n % 5;
          const int y = n / 5 % 5;
          const int z = n / 25;
          const std::uint16_t code = built.depth.codeAt(b, x, y, z);
          if (!saturated) {
            ASSERT_EQ(edited.depth.codeAt(a, x, y, z), code)
                << "corner " << cell[0] + x << ' ' << cell[1] + y << ' ' << cell[2] + z;
          }
          if (palette.value(code) > 0.0f) continue;
          ASSERT_EQ(edited.depth.labelOf(edited.depth.wordAt(cell), x, y, z),
                    built.depth.labelOf(built.depth.wordAt(cell), x, y, z))
              << "corner " << cell[0] + x << ' ' << cell[1] + y << ' ' << cell[2] + z;
        }
      }
    }
  }
}

inline void expectSameTree(const VoxelTree& edited, const VoxelTree& built) {
  Leaves a;
  Leaves b;
  std::vector<std::size_t> nodesA;
  std::vector<std::size_t> nodesB;
  walkTree(edited, a, nodesA);
  walkTree(built, b, nodesB);
  EXPECT_EQ(nodesA, nodesB);
  EXPECT_EQ(edited.stats().nodesPerLevel, built.stats().nodesPerLevel);
  EXPECT_EQ(edited.stats().levels, built.stats().levels);
  EXPECT_EQ(edited.stats().solidVoxels, built.stats().solidVoxels);
  EXPECT_EQ(edited.stats().surfaceVoxels, built.stats().surfaceVoxels);
  if (a != b) {
    ASSERT_EQ(a.size(), b.size());
    for (auto i = a.begin(), j = b.begin(); i != a.end(); ++i, ++j) {
      ASSERT_EQ(i->first, j->first);
      ASSERT_EQ(i->second.code, j->second.code)
          << "at " << i->first[0] << ' ' << i->first[1] << ' ' << i->first[2];
      ASSERT_EQ(i->second.label, j->second.label);
    }
  }
  if (built.data().options.leaf == LeafModel::Distance) {
    expectSameBricks(edited.data(), built.data());
  }
}

}  // namespace palpate::testing_volumes
