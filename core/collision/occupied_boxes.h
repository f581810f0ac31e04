#pragma once
/// What the nodes of a voxel tree hold: for every node the box of its occupied voxels, and where
/// the faces of voxels are. For the clearance; internal.
///
/// A node on the surface is half empty; far away that half costs most of a search, because a large
/// ball about a point meets many such halves. So the boxes are computed once and looked up.
///
/// Only for trees with voxel leaves, whose items are voxels. The boxes count voxels; the faces are
/// metres in V, the voxel axes of the tree's grid. Building allocates; afterwards the tables are
/// only read, by any number of threads.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/voxels/node_mask.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// Along x, y, z. Of a node, its corner: the lowest voxel it could hold.
using VoxelIndex = std::array<std::int32_t, 3>;

/// The voxels of a node lie in [lo, hi) along each axis, and some at each end.
struct OccupiedBox {
  static constexpr std::int32_t kMostVoxels = 0xFFFF;  ///< Along an axis: what fits here.
  std::array<std::uint16_t, 3> lo{}, hi{};
};

struct OccupiedBoxes {
  /// Per axis the lower face of every voxel, V, up to the padded extent: neighbours share a face to
  /// the bit, and a node's box holds those of its voxels.
  std::array<std::vector<double>, 3> face;
  std::vector<std::vector<OccupiedBox>> occupied;  ///< [level][node]
};

/// The tree has voxel leaves and is at most OccupiedBox::kMostVoxels long along each axis. Takes
/// 12 bytes a node.
[[nodiscard]] OccupiedBoxes occupiedBoxesOf(const VoxelTree::Data& tree);

[[nodiscard]] inline OccupiedBox boxOfVoxel(const VoxelIndex& voxel) noexcept {
  OccupiedBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.lo[a] = static_cast<std::uint16_t>(voxel[a]);
    box.hi[a] = static_cast<std::uint16_t>(voxel[a] + 1);
  }
  return box;
}

/// @param corner  of the node whose child is asked for
/// @param shift   its children are 2^shift voxels along an edge
template <int Bits>
[[nodiscard]] inline VoxelIndex childCorner(const VoxelIndex& corner, int child,
                                            int shift) noexcept {
  constexpr int kLow = NodeMask<Bits>::kLow;
  return {corner[0] + ((child & kLow) << shift), corner[1] + (((child >> Bits) & kLow) << shift),
          corner[2] + ((child >> (2 * Bits)) << shift)};
}

/// Index of a present child in the level below `level`, which is that of `node`.
template <int Bits>
[[nodiscard]] inline std::uint32_t childNode(const TreeLevel& level, std::uint32_t node,
                                             const NodeMask<Bits>& mask, int child) noexcept {
  return level.firstChild[node] + static_cast<std::uint32_t>(mask.rank(child));
}

}  // namespace palpate
