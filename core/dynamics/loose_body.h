#pragma once
/// A body that nothing holds: a fragment of bone, a stone, a swab.
///
/// One step: accelerate(h), contacts (ContactResolver), take(), advance(h). Gravity and a drag in
/// proportion to the velocity, both integrated without adding energy; what is around a fragment in
/// a patient (blood, soft tissue) is not modelled further. SI, world axes.

#include "core/dynamics/contact_response.h"
#include "core/dynamics/rigid_body.h"

namespace palpate {

struct LooseBodySettings {
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< m/s², W
  double drag = 0.0;                                  ///< 1/s: share of the velocity lost a second
  /// m: no point within `reach` of the body's origin moves farther than this in a step (a voxel,
  /// against tunnelling). <= 0: no cap.
  double maxTravel = 0.0;
  double reach = 0.0;
};

/// Real-time safe after construction. One thread at a time.
class LooseBody {
 public:
  LooseBody(const MassProperties& mass, const LooseBodySettings& settings) noexcept
      : body_(mass),
        settings_(settings),
        accelerated_(settings.drag != 0.0 || settings.gravity != Eigen::Vector3d::Zero()) {}

  /// At rest at X_WB; false and no change when the pose is not rigid.
  bool reset(const PlainPose& X_WB) noexcept;
  /// Velocity after h without contacts, capped.
  void accelerate(double h) noexcept;
  [[nodiscard]] ContactBody contactBody() const noexcept;
  /// Velocity after the contacts, capped; remembers the position correction for advance().
  void take(const BodyResponse& response, double h) noexcept;
  /// Pose after h.
  void advance(double h) noexcept;

  [[nodiscard]] PlainPose pose() const noexcept { return body_.pose(); }  ///< X_WB
  [[nodiscard]] Eigen::Isometry3d X_WB() const noexcept { return isometry(body_.pose()); }
  [[nodiscard]] const RigidBody& body() const noexcept { return body_; }
  /// No point within the settings' reach is faster, m/s.
  [[nodiscard]] double fastest() const noexcept {
    return body_.velocityAt(body_.origin()).norm() +
           body_.angularVelocity().norm() * settings_.reach;
  }
  [[nodiscard]] bool speedCapped() const noexcept { return capped_; }

 private:
  void cap(double h) noexcept;

  RigidBody body_;
  LooseBodySettings settings_;
  bool accelerated_;  ///< Gravity or drag is on.
  Vector6d shift_ = Vector6d::Zero();
  bool capped_ = false;
};

}  // namespace palpate
