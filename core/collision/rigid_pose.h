#pragma once
/// Is a pose one that a query may take?

#include <Eigen/Geometry>

namespace palpate {

/// True if every number is finite and the linear part a rotation within 1e-6: a pose off by that
/// much moves a point a metre away from its rotation's axis by a micrometre. Real-time safe.
[[nodiscard]] bool isRigidPose(const Eigen::Isometry3d& X) noexcept;

}  // namespace palpate
