#pragma once
/// Sweeps elliptical cross-sections along a path into a closed mesh.
///
/// Each section lies in the plane across the path at its place (at a bend, the plane that halves
/// the angle). Its axes are carried along the path without spinning (Bishop's frame: the smallest
/// rotation from one tangent to the next), then turned by the section's own twist. A section whose
/// half-axes are both zero is a point and may only begin or end the path; other ends are closed
/// flat.

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace palpate {

/// One cross-section; metres and radians, frame T.
struct CrossSection {
  Eigen::Vector3d p_T = Eigen::Vector3d::Zero();            ///< Its centre.
  Eigen::Vector2d halfAxes = Eigen::Vector2d::Constant(0);  ///< Along its own x and y.
  double twist = 0.0;  ///< About the path, from the carried axes.
};

/// A closed mesh whose triangles face outwards, `around` vertices to a ring. Refuses (naming the
/// section in `field`) fewer than two sections, two in one place, a path that folds back, a
/// half-axis that is not positive, and a sweep that encloses no positive volume.
[[nodiscard]] Result<TriangleMesh> sweepSections(const std::vector<CrossSection>& sections,
                                                 std::uint32_t around);

}  // namespace palpate
