#pragma once
/// The nodes of level 1 above edited voxels: what their masks become, and how many there may be.
/// Internal to TreeEditor.
///
/// A node is named by its address, in nodes of 2^Bits items a side; an item is a voxel (voxel
/// leaves) or a cell between eight voxels (distance leaves; voxel_tree_data.h). Only
/// reserveGroups() takes memory.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/voxels/node_groups.h"
#include "core/voxels/node_mask.h"
#include "core/voxels/voxel_box.h"

namespace palpate {

/// The mask of a node of voxels.
template <int Bits>
[[nodiscard]] NodeMask<Bits> voxelMask(const VoxelBits& solid, const Extent3& node) noexcept {
  using Mask = NodeMask<Bits>;
  Mask mask;
  const Extent3& dims = solid.extent;
  const std::int32_t x = node[0] * Mask::kEdge;
  for (int z = 0; z < Mask::kEdge && node[2] * Mask::kEdge + z < dims[2]; ++z) {
    for (int y = 0; y < Mask::kEdge && node[1] * Mask::kEdge + y < dims[1]; ++y) {
      const std::uint64_t* row = solid.row(node[1] * Mask::kEdge + y, node[2] * Mask::kEdge + z);
      const int at = Mask::child(0, y, z);
      mask.word[static_cast<std::size_t>(at) >> 6] |=
          std::uint64_t{bitsAt(row, dims[0], x, Mask::kEdge)} << (at & 63);
    }
  }
  return mask;
}

/// The mask of a node of cells, of which the tree has so many along x, y, z: a cell is there where
/// one of its corners is inside.
template <int Bits>
[[nodiscard]] NodeMask<Bits> cellMask(const VoxelBits& solid, const Extent3& extent,
                                      const Extent3& node) noexcept {
  using Mask = NodeMask<Bits>;
  Mask mask;
  const std::int32_t x = node[0] * Mask::kEdge;
  const int cells = std::min(Mask::kEdge, extent[0] - x);
  for (int z = 0; z < Mask::kEdge && node[2] * Mask::kEdge + z < extent[2]; ++z) {
    for (int y = 0; y < Mask::kEdge && node[1] * Mask::kEdge + y < extent[1]; ++y) {
      std::uint32_t any = 0;
      for (int c = 0; c < 4; ++c) {
        any |= bitsAt(
            solid.row(node[1] * Mask::kEdge + y + (c & 1), node[2] * Mask::kEdge + z + (c >> 1)),
            solid.extent[0], x, cells + 1);
      }
      const std::uint64_t bits = (any | any >> 1) & ((1U << cells) - 1U);
      const int at = Mask::child(0, y, z);
      mask.word[static_cast<std::size_t>(at) >> 6] |= bits << (at & 63);
    }
  }
  return mask;
}

/// How many boxes of 2^shift voxels a side a box, which is not empty, has a part in.
[[nodiscard]] inline std::size_t boxesIn(const VoxelBox& box, int shift) noexcept {
  std::size_t n = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    n *= static_cast<std::size_t>(((box.hi[a] - 1) >> shift) - (box.lo[a] >> shift) + 1);
  }
  return n;
}

/// Takes the memory for nodes of all levels above the items of a box.
template <int Bits>
void reserveGroups(NodeGroups<Bits>& groups, int levels, const VoxelBox& items) {
  for (int l = 1; l < levels; ++l) {
    groups.reserve(static_cast<std::size_t>(l), boxesIn(items, Bits * (l + 1)));
  }
}

}  // namespace palpate
