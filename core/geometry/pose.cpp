#include "core/geometry/pose.h"

#include <cmath>

namespace palpate {

PlainPose plain(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) noexcept {
  return {{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}};
}

PlainPose plain(const Eigen::Isometry3d& X) noexcept {
  return plain(X.translation(), Eigen::Quaterniond(X.linear()));
}

Eigen::Vector3d position(const PlainPose& pose) noexcept {
  return {pose.p[0], pose.p[1], pose.p[2]};
}

Eigen::Quaterniond orientation(const PlainPose& pose) noexcept {
  return {pose.q[0], pose.q[1], pose.q[2], pose.q[3]};
}

Eigen::Isometry3d isometry(const PlainPose& pose) noexcept {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = orientation(pose).toRotationMatrix();
  X.translation() = position(pose);
  return X;
}

Eigen::Quaterniond expMap(const Eigen::Vector3d& rotationVector) noexcept {
  const double angle = rotationVector.norm();
  // Below 1e-4 rad the series is exact to the last bit of a double.
  const double half = 0.5 * angle;
  const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48.0 : std::sin(half) / angle;
  Eigen::Quaterniond q(std::cos(half), scale * rotationVector.x(), scale * rotationVector.y(),
                       scale * rotationVector.z());
  q.normalize();
  return q;
}

Eigen::Vector3d logMap(const Eigen::Quaterniond& q) noexcept {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;  // the shorter of the two arcs
  const Eigen::Vector3d v = sign * q.vec();
  const double w = sign * q.w();
  const double n = v.norm();
  if (n < 1e-8) return 2.0 * v;
  return (2.0 * std::atan2(n, w) / n) * v;
}

bool isRigid(const PlainPose& pose) noexcept {
  double norm2 = 0.0;
  for (const double v : pose.q) norm2 += v * v;
  for (const double v : pose.p) {
    if (!std::isfinite(v)) return false;
  }
  return std::isfinite(norm2) && std::abs(norm2 - 1.0) <= 2e-6;
}

}  // namespace palpate
