#pragma once
/// The boxes of voxels that a group of points may be nearest to: found once for the group, then
/// compared point by point without the tree. Of the clearance; internal.
///
/// Frame V (voxel axes of the tree's grid); metres, squared where it says so. Real-time safe; a
/// CandidateBoxes belongs to one thread at a time.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/collision/box_distance.h"
#include "core/collision/occupied_boxes.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// As far as there is room. Where there are more, the points are looked up in the tree one by one.
struct CandidateBoxes {
  static constexpr std::size_t kRoom = 256;
  std::array<std::array<double, kRoom>, 3> lower, upper;  ///< Faces, V.
  std::size_t count = 0;
  bool full = false;   ///< Some did not fit: not to be relied on.
  double front = 0.0;  ///< The least u·x of them; infinite when there are none.
};

/// Lists the boxes that are closer to c than `below` (squared) and not wholly beyond a plane:
/// u·x > offset. With u = 0 and offset >= 0 there is no plane. What `out` held is forgotten.
/// @tparam Bits  the tree's: 1, 2, 3 for 8, 64, 512 children.
/// @param boxes  occupiedBoxesOf(tree)
/// @return       nodes visited
template <int Bits>
std::uint32_t listCandidates(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& c,
                             double below, const Vec3& u, double offset,
                             CandidateBoxes& out) noexcept;

/// The squared distance to the nearest of them; infinite when there are none.
[[nodiscard]] inline double nearestSquared(const CandidateBoxes& list, const Vec3& p) noexcept {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < list.count; ++i) {
    const double x = axisSquared(p.v[0], list.lower[0][i], list.upper[0][i]);
    const double y = axisSquared(p.v[1], list.lower[1][i], list.upper[1][i]);
    const double z = axisSquared(p.v[2], list.lower[2][i], list.upper[2][i]);
    nearest = std::min(nearest, (x + y) + z);
  }
  return nearest;
}

}  // namespace palpate
