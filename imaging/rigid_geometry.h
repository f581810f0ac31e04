#pragma once
/// From the affine of a volume file to a GridGeometry, or a refusal.

#include <Eigen/Core>
#include <array>
#include <filesystem>

#include "core/base/error.h"
#include "core/geometry/grid_geometry.h"

namespace palpate {

/// Affine of a volume file as found: columns are the axes (with spacing), millimetres, LPS.
struct FoundAffine {
  Eigen::Matrix3d axes_mm;
  Eigen::Vector3d origin_mm;
};

/// From an affine to a GridGeometry with a right-handed frame, or a refusal of shear, zero or
/// unreadable axes. Axes that are orthogonal but for rounding (up to 1e-4 rad) are made a rotation
/// (the nearest in the least-squares sense).
/// @param flipSlices  set when the frame was left-handed: the third axis now runs the other way
///                    and the caller must reverse the slices.
[[nodiscard]] Result<GridGeometry> rigidGeometry(const std::array<std::int32_t, 3>& dims,
                                                 const FoundAffine& affine,
                                                 const std::filesystem::path& file,
                                                 const char* field, bool& flipSlices);

}  // namespace palpate
