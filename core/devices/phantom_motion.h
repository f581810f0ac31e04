#pragma once
/// From HDAPI's transform to a pose and velocities in frame D: metres, radians, unit quaternion.
///
/// The vendor's rotation is slightly off a rotation; the nearest one is taken. Its velocities are
/// not used: the angular one is reported to be unreliable, the linear one has an unknown filter,
/// and the stable region was measured with the filter below.

#include <cstdint>
#include <optional>

#include "core/haptics/messages.h"

namespace palpate {

/// `transform`: 16 numbers, column after column, translation (mm) at 12 to 14. Nothing when a
/// number is not finite, the translation is beyond 2 m, or the rotation part is not one within
/// 0.05. Real-time safe.
[[nodiscard]] std::optional<PlainPose> poseFromTransform(const double (&transform)[16]) noexcept;

/// Velocities by differentiation, low-passed at 100 Hz, one tick after the other. Real-time safe.
class MotionEstimate {
 public:
  /// Forgets: the next pose has velocity zero. After a calibration, which makes the pose jump.
  void reset() noexcept;
  /// The next tick's pose; nullopt repeats the last good one and lets the velocities decay.
  void update(const std::optional<PlainPose>& pose) noexcept;

  [[nodiscard]] const PlainPose& pose() const noexcept { return pose_; }
  [[nodiscard]] const double (&v() const noexcept)[3] { return v_; }  ///< m/s
  [[nodiscard]] const double (&w() const noexcept)[3] { return w_; }  ///< rad/s, axes of D

 private:
  PlainPose pose_;
  double v_[3] = {0, 0, 0}, w_[3] = {0, 0, 0};
  bool started_ = false;
  std::uint32_t ticksSincePose_ = 0;
};

}  // namespace palpate
