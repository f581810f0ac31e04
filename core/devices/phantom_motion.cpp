#include "core/devices/phantom_motion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/units.h"

namespace palpate {
namespace {

constexpr double kPeriod = 1e-3;           // s, the servo's tick
constexpr double kFarthest = 2.0;          // m; the largest Phantom reaches 0.84 m
constexpr double kRotationSlack = 0.05;    // of any element of R^T R - 1; the arms are within 1e-3
constexpr double kVelocityCutoff = 100.0;  // Hz, haptics_facts.md §3

/// Nearest rotation in the Frobenius norm, by Newton's iteration for the polar factor. From within
/// kRotationSlack three passes reach the last bit (the error squares each time).
Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& m) noexcept {
  Eigen::Matrix3d r = m;
  for (int pass = 0; pass < 4; ++pass) r = 0.5 * (r + r.inverse().transpose()).eval();
  return r;
}

const double kBlend = 1.0 - std::exp(-2.0 * std::numbers::pi * kVelocityCutoff * kPeriod);

void blend(double (&filtered)[3], const Eigen::Vector3d& raw) noexcept {
  for (int i = 0; i < 3; ++i) filtered[i] += kBlend * (raw[i] - filtered[i]);
}

}  // namespace

std::optional<PlainPose> poseFromTransform(const double (&transform)[16]) noexcept {
  for (const double number : transform)
    if (!std::isfinite(number)) return std::nullopt;
  const Eigen::Matrix4d m = Eigen::Map<const Eigen::Matrix4d>(transform);  // column-major, as Eigen
  const Eigen::Vector3d p = m.topRightCorner<3, 1>() * kMetresPerMillimetre;
  const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  const Eigen::Matrix3d excess = r.transpose() * r - Eigen::Matrix3d::Identity();
  if (excess.cwiseAbs().maxCoeff() > kRotationSlack || r.determinant() <= 0.0) return std::nullopt;
  if (p.cwiseAbs().maxCoeff() > kFarthest) return std::nullopt;
  const Eigen::Quaterniond q(nearestRotation(r));
  return plain(p, q.normalized());
}

void MotionEstimate::reset() noexcept {
  started_ = false;
  ticksSincePose_ = 0;
  std::fill(std::begin(v_), std::end(v_), 0.0);
  std::fill(std::begin(w_), std::end(w_), 0.0);
}

void MotionEstimate::update(const std::optional<PlainPose>& pose) noexcept {
  if (!pose) {
    ++ticksSincePose_;
    blend(v_, Eigen::Vector3d::Zero());
    blend(w_, Eigen::Vector3d::Zero());
    return;
  }
  if (started_) {
    const double elapsed = kPeriod * (1.0 + ticksSincePose_);
    blend(v_, (position(*pose) - position(pose_)) / elapsed);
    blend(w_, logMap(orientation(*pose) * orientation(pose_).conjugate()) / elapsed);
  }
  pose_ = *pose;
  started_ = true;
  ticksSincePose_ = 0;
}

}  // namespace palpate
