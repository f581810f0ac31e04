#pragma once
/// A tilted or unevenly spaced stack of slices, resampled to a regular box.
///
/// All slices stay parallel, as a gantry tilt and missing slices leave them; each output voxel is
/// interpolated linearly between the two slices around it, and bilinearly within each. Where no
/// slice reaches, the smallest value of the volume is written (air). The box holds every slice.

#include <Eigen/Core>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/volume.h"

namespace palpate {

struct RegularStack {
  Volume volume;
  /// Largest distance between a slice and where a plain stack of the same first slice and the
  /// output's spacing would have shown it.
  double largestDisplacement_mm = 0.0;
};

/// @param stack         voxels in slice order; its geometry gives axes, in-plane spacing, dims.
/// @param positions_mm  centre of each slice's first voxel, LPS, ascending along the normal.
[[nodiscard]] Result<RegularStack> makeRegularStack(
    const Volume& stack, const std::vector<Eigen::Vector3d>& positions_mm,
    const Progress& progress = {});

}  // namespace palpate
