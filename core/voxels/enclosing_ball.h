#pragma once
/// The smallest ball that holds a few points, exact up to rounding.
///
/// Pivoting (Gärtner, "Fast and robust smallest enclosing balls", 1999): the ball of a support of
/// at most four points grows by the farthest point outside it, until there is none. In the fixed
/// order of the input: same points, same bits. Takes no memory. Meant for tens to hundreds of
/// points (corners of cells), not for clouds.

#include <Eigen/Core>
#include <span>

namespace palpate {

struct Ball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;
};

/// The radius is the largest distance from the centre to a point, so every point is enclosed even
/// where the centre was rounded. A ball of radius 0 at the origin for no points.
[[nodiscard]] Ball smallestEnclosingBall(std::span<const Eigen::Vector3d> points) noexcept;

}  // namespace palpate
