#pragma once
/// Where the device stands when a scene does not say: over a part of the anatomy that a hand can
/// reach from outside.

#include <Eigen/Geometry>
#include <array>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Which label values are felt.
using FeltLabels = std::array<bool, 256>;

struct Approach {
  /// Device to patient. D's origin is on the surface, +y points out of the anatomy along the
  /// surface's mean direction, +z as far towards the patient's front as that allows.
  Eigen::Isometry3d X_PD = Eigen::Isometry3d::Identity();
  /// Even and free: a hand can come down along -y of D and slide about. False: no direction gave
  /// such a place, and this is the best there is.
  bool clear = false;
};

/// Looks towards the felt voxels' centroid from the patient's upper left (a skull's vault, not the
/// headrest behind it), then from other sides, and takes the first even and free patch of surface
/// that the rays meet. Same grid, same answer. Refuses a grid without a felt voxel.
[[nodiscard]] Result<Approach> planApproach(const LabelGrid& grid, const FeltLabels& felt);

}  // namespace palpate
