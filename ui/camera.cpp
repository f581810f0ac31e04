#include "ui/camera.h"

#include <algorithm>
#include <cmath>

namespace palpate::ui {

void Camera::frame(const Eigen::Vector3d& low_mm, const Eigen::Vector3d& high_mm, double aspect) {
  target_mm = 0.5 * (low_mm + high_mm);
  // A little above the middle: instruments come from there.
  target_mm.z() += 0.08 * (high_mm.z() - low_mm.z());
  const double radius = std::max(1.0, 0.5 * (high_mm - low_mm).norm());
  const double half = std::atan(std::tan(0.5 * fieldOfView) * std::min(1.0, aspect));
  // 0.88: a head is nearer to an ellipsoid than to its box, so its sphere can be cut a little.
  distance_mm = 0.88 * radius / std::sin(half);
  lookFrom({0.62, -1.0, 0.28});
}

void Camera::lookFrom(const Eigen::Vector3d& from_P) {
  const Eigen::Vector3d back = from_P.normalized();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  if (std::abs(back.dot(up)) > 0.999) up = -Eigen::Vector3d::UnitY();
  const Eigen::Vector3d right = up.cross(back).normalized();
  Eigen::Matrix3d R;
  R.col(0) = right;
  R.col(1) = back.cross(right);
  R.col(2) = back;
  q_PC = Eigen::Quaterniond(R);
}

void Camera::orbit(double dx, double dy) {
  // About the head-foot axis and the view's right: the head stays up.
  const Eigen::Matrix3d R = q_PC.toRotationMatrix();
  const double tilt = std::asin(std::clamp(R(2, 2), -1.0, 1.0));
  const double limited = std::clamp(tilt + dy, -1.54, 1.54) - tilt;
  const Eigen::AngleAxisd turn(-dx, Eigen::Vector3d::UnitZ());
  const Eigen::AngleAxisd nod(-limited, R.col(0));
  q_PC = (turn * nod * q_PC).normalized();
}

void Camera::pan(double dxPixels, double dyPixels, double viewHeight) {
  const double s = millimetresPerPixel(viewHeight);
  target_mm += q_PC * Eigen::Vector3d(-dxPixels * s, dyPixels * s, 0.0);
}

void Camera::zoom(double steps) {
  distance_mm = std::clamp(distance_mm * std::pow(0.9, steps), 5.0, 5000.0);
}

Eigen::Vector3d Camera::eye_mm() const {
  return target_mm + q_PC * Eigen::Vector3d(0.0, 0.0, distance_mm);
}

double Camera::millimetresPerPixel(double viewHeight) const {
  return 2.0 * distance_mm * std::tan(0.5 * fieldOfView) / std::max(1.0, viewHeight);
}

Eigen::Matrix4f Camera::view(const Eigen::Vector3d& origin_mm) const {
  Eigen::Isometry3d X_PC = Eigen::Isometry3d::Identity();
  X_PC.linear() = q_PC.toRotationMatrix();
  X_PC.translation() = eye_mm() - origin_mm;
  return X_PC.inverse().matrix().cast<float>();
}

Eigen::Matrix4f Camera::projection(double aspect) const {
  const double f = 1.0 / std::tan(0.5 * fieldOfView);
  const double n = nearPlane();
  const double z = farPlane();
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m(0, 0) = f / std::max(1e-3, aspect);
  m(1, 1) = f;
  m(2, 2) = (z + n) / (n - z);
  m(2, 3) = 2.0 * z * n / (n - z);
  m(3, 2) = -1.0;
  return m.cast<float>();
}

bool Camera::operator==(const Camera& other) const {
  return target_mm == other.target_mm && q_PC.coeffs() == other.q_PC.coeffs() &&
         distance_mm == other.distance_mm && fieldOfView == other.fieldOfView;
}

}  // namespace palpate::ui
