#pragma once
/// Force as an arrow, torque as an arc with a head: triangles in P, millimetres.

#include <Eigen/Core>

#include "ui/smooth_normals.h"

namespace palpate::ui {

/// Millimetres of arrow for a newton, and the longest.
inline constexpr double kArrow_mmPerN = 36.0;
inline constexpr double kLongestArrow_mm = 90.0;

/// From `tail_mm` along `direction` (unit), `length_mm` long; shaft radius `radius_mm`.
[[nodiscard]] DrawableMesh arrowShape(const Eigen::Vector3d& tail_mm,
                                      const Eigen::Vector3d& direction, double length_mm,
                                      double radius_mm);
/// About `axis` (unit) at `centre_mm`, right-handed, `angle` rad (at most 5.5) long.
[[nodiscard]] DrawableMesh arcShape(const Eigen::Vector3d& centre_mm, const Eigen::Vector3d& axis,
                                    double arcRadius_mm, double angle, double radius_mm);

}  // namespace palpate::ui
