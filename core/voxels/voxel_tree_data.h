#pragma once
/// The arrays of a VoxelTree, for core/collision and the cache file.
///
/// The tree's leaves (level 0) are *items* of one lattice, boxes of one spacing each:
///  - voxel leaves: item (i,j,k) is the voxel itself, the box around its centre;
///  - distance leaves: item (i,j,k) is the cell between the centres (i,j,k) and (i+1,j+1,k+1),
///    present where a corner is inside, for only there can the interpolated value be negative.
/// Items, their nodes and their spheres follow from addresses alone; `origin` is the lower corner
/// of item (0,0,0) in V. The extent is padded to a power of the node's edge.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/large_array.h"
#include "core/voxels/depth_bricks.h"
#include "core/voxels/sphere_table.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

inline constexpr std::uint32_t kNoNode = 0xFFFFFFFF;

/// The nodes of one level: children of one node are neighbours in the level below. Breadth-first as
/// built; a TreeEditor leaves places that nothing links to, with empty masks.
struct TreeLevel {
  LargeArray<std::uint8_t> masks;        ///< children/8 bytes a node.
  LargeArray<std::uint32_t> firstChild;  ///< Index in the level below; at level 1 the leaves' bytes
                                         ///< (voxel leaves) or absent (distance leaves).
};

struct VoxelTree::Data {
  GridGeometry geometry;
  TreeOptions options;
  TreeStats stats;
  std::uint64_t edits = 0;  ///< Times that it was changed, for readers that remember. Not cached.

  int bits = 2;    ///< Per axis and level: 1, 2, 3 for 8, 64, 512 children.
  int levels = 1;  ///< Level of the root.
  std::array<std::int32_t, 3> extent{0, 0, 0};       ///< Items along x, y, z.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< V, metres.
  std::vector<TreeLevel> level;                      ///< [1] .. [levels]; [0] stays empty.
  SphereTable spheres;

  /// Distance leaves: depths and clearances. Voxel leaves use its palette and uniformLabel only.
  DepthBricks depth;
  /// Voxel leaves: codes and labels (leaf_codes.h).
  LargeArray<std::uint8_t> leafBytes;
};

/// Sets stats.topologyBytes and stats.payloadBytes from the arrays.
void countBytes(VoxelTree::Data& data) noexcept;

}  // namespace palpate
