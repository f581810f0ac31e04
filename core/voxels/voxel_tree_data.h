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

#include "core/voxels/sphere_table.h"
#include "core/voxels/unit_normal.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

inline constexpr std::uint32_t kNoNode = 0xFFFFFFFF;

/// Deeper than this many smallest spacings, the depth of the distance model saturates (design).
inline constexpr double kSaturationVoxels = 16.0;

/// The level whose nodes carry the bricks of distance leaves: eight cells a side where the
/// branching has such a level, four for 64 children.
[[nodiscard]] constexpr int brickLevelOf(int bits, int levels) noexcept {
  const int level = bits == 1 ? 3 : 1;
  return level < levels ? level : levels;
}

/// The nodes of one level, breadth-first: children of one node are neighbours in the level below.
struct TreeLevel {
  std::vector<std::uint8_t> masks;        ///< children/8 bytes a node.
  std::vector<std::uint32_t> firstChild;  ///< Index in the level below; at level 1 of the leaf's
                                          ///< payload (voxel leaves) or absent (distance leaves).
};

struct VoxelTree::Data {
  GridGeometry geometry;
  TreeOptions options;
  TreeStats stats;

  int bits = 2;    ///< Per axis and level: 1, 2, 3 for 8, 64, 512 children.
  int levels = 1;  ///< Level of the root.
  std::array<std::int32_t, 3> extent{0, 0, 0};       ///< Items along x, y, z.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< V, metres.
  std::vector<TreeLevel> level;                      ///< [1] .. [levels]; [0] stays empty.
  SphereTable spheres;

  // Voxel leaves: one entry a present voxel, in the order of the tree.
  std::vector<std::uint8_t> leafLabel;
  std::vector<UnitNormal> leafNormal;  ///< Outward: along the gradient of the signed distance.
  std::vector<float> leafDepth;        ///< D, metres.

  // Distance leaves: a brick of signed distances on every node of level `brickLevel`, with an
  // apron of one, x fastest: (edge+1)^3 values. All bricks are full ones, so thick interiors
  // follow the volume.
  int brickLevel = 0;
  int brickEdge = 0;                     ///< Cells along a side.
  std::vector<float> brick;              ///< Metres, > 0 outside.
  std::uint8_t uniformLabel = 0;         ///< Not 0: the only label; brickLabel is empty.
  std::vector<std::uint8_t> brickLabel;  ///< Laid out like `brick`; 0 outside.

  [[nodiscard]] std::size_t brickSize() const noexcept {
    const auto side = static_cast<std::size_t>(brickEdge) + 1;
    return side * side * side;
  }
};

}  // namespace palpate
