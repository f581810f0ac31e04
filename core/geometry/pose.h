#pragma once
/// Poses as plain data for messages, and the exponential map for orientations.
///
/// Eigen's fixed vectors are not trivially copyable, so what crosses a thread or goes into a
/// recording is a PlainPose; loops convert at their edge.

#include <Eigen/Geometry>

namespace palpate {

/// A rigid pose: p = translation in metres, q = unit quaternion (w, x, y, z).
struct PlainPose {
  double p[3] = {0.0, 0.0, 0.0};
  double q[4] = {1.0, 0.0, 0.0, 0.0};
};

[[nodiscard]] PlainPose plain(const Eigen::Isometry3d& X) noexcept;
[[nodiscard]] PlainPose plain(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) noexcept;
[[nodiscard]] Eigen::Isometry3d isometry(const PlainPose& pose) noexcept;
[[nodiscard]] Eigen::Vector3d position(const PlainPose& pose) noexcept;
[[nodiscard]] Eigen::Quaterniond orientation(const PlainPose& pose) noexcept;

/// Rotation vector (axis · angle, rad) to unit quaternion. Exact for small angles.
[[nodiscard]] Eigen::Quaterniond expMap(const Eigen::Vector3d& rotationVector) noexcept;
/// Unit quaternion to rotation vector along the shortest arc, |result| <= pi.
[[nodiscard]] Eigen::Vector3d logMap(const Eigen::Quaterniond& q) noexcept;
/// True if every number is finite and the quaternion is a unit one within 1e-6.
[[nodiscard]] bool isRigid(const PlainPose& pose) noexcept;

}  // namespace palpate
