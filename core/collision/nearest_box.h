#pragma once
/// The occupied voxel whose box is nearest to one point, by descent of the tree, nearer children
/// first. Of the clearance; internal.
///
/// Frame V (voxel axes of the tree's grid); metres, squared where it says so. Real-time safe: only
/// reads the tree and its boxes, and needs nothing but the stack of the thread that asks.

#include <cstdint>

#include "core/collision/box_distance.h"
#include "core/collision/occupied_boxes.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

struct NearestBox {
  bool found = false;  ///< If not, only nodesVisited means anything.
  VoxelIndex voxel{};
  double squared = 0.0;  ///< Distance to its box.
  std::uint32_t nodesVisited = 0;
};

/// How far a box may be from the nearest one and still do: its distance is at most `within`, or
/// less than `tolerance` more than the nearest one's. Of a wall before the tool much is about
/// equally near. Metres.
struct NearEnough {
  double within = 0.0;
  double tolerance = 0.0;
};

/// Boxes at `below` (squared) or farther do not count.
/// @tparam Bits   the tree's: 1, 2, 3 for 8, 64, 512 children.
/// @param boxes   occupiedBoxesOf(tree)
/// @param seed    a voxel known to be occupied, or nullptr: the search need only better it.
/// @param enough  by default only a nearest one will do; of equals any.
template <int Bits>
[[nodiscard]] NearestBox findNearestBox(const VoxelTree::Data& tree, const OccupiedBoxes& boxes,
                                        const Vec3& p, double below, const VoxelIndex* seed,
                                        const NearEnough& enough = {}) noexcept;

/// Of the boxes exactly this far (squared), the lowest in the grid's order, x fastest. None may be
/// nearer: this is for a distance that was found.
template <int Bits>
[[nodiscard]] NearestBox findLowestBoxAt(const VoxelTree::Data& tree, const OccupiedBoxes& boxes,
                                         const Vec3& p, double squared) noexcept;

}  // namespace palpate
