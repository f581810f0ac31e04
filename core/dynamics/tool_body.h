#pragma once
/// The instrument on its virtual coupling: the whole dynamic part of a simulation step.
///
/// One step, h seconds (the caller does the collision query, the change of frame and other bodies):
///
///     tool.applyCoupling(target, h);                   // velocity: implicit spring-damper
///     n = finder.find(X_VW * tool.X_WT(), contacts);   // at the current pose; p, n to W
///     resolver.resolve({tool.contactBody(), ...}, sets, settings, h, responses);
///     tool.take(responses[0], n > 0, h);
///     tool.advance(h);                                 // pose, and the position correction
///
/// The coupling pulls the origin of T, not the centre of mass, towards the device: equal and
/// opposite to couplingWrench() of core/haptics. It is integrated implicitly (backward Euler in the
/// tool's velocity, with the coupling's 6x6 matrix), so there is no limit K·T² + 2·B·T < 4·m and
/// no floor on mass or inertia: a 1 g needle at 10 ms is stable, as is 10 kg. The device is
/// predicted to the end of the step by its velocity, so steady motion makes no force (no felt
/// drag).
///
/// Heavy tools would ring on the coupling. The tool, and only the tool, gets more damping relative
/// to the device, B_tool = max(B, 2·ζ·√(K·m)) with ζ = 0.7 (rotation likewise about the origin of
/// T). What the hand feels remains K and B. This keeps the port passive: with Z the impedance felt,
/// Re Z(jω) = m·ω²·[K·(B_tool − B) + B·m·ω²] / |K − m·ω² + jω·B_tool|² >= 0 for B_tool >= B.

#include <Eigen/Geometry>
#include <span>

#include "core/dynamics/contact_response.h"
#include "core/dynamics/rigid_body.h"

namespace palpate {

/// The gains of the coupling, as core/haptics has them.
struct ToolCoupling {
  double stiffness = 600.0;  ///< N/m
  double damping = 2.0;      ///< N·s/m
  double stiffnessR = 0.24;  ///< N·m/rad
  double dampingR = 8e-4;    ///< N·m·s/rad
};

/// Where the device is, in W.
struct ToolTarget {
  PlainPose pose;
  double v[3] = {0, 0, 0};  ///< m/s
  double w[3] = {0, 0, 0};  ///< rad/s
};

struct ToolSettings {
  ToolCoupling coupling;
  double dampingRatio = 0.7;  ///< ζ of the tool on the coupling, at least.
  /// m: no point within `reach` of the origin of T moves farther than this in a step (smallest
  /// voxel spacing, against tunnelling). The twist is scaled down as a whole. <= 0: no cap.
  double maxTravel = 0.0;
  double reach = 0.0;  ///< m: PointShell::reach().
};

/// Real-time safe after construction. One thread at a time.
class ToolBody {
 public:
  ToolBody(const MassProperties& mass, const ToolSettings& settings) noexcept;

  /// Other gains from the next applyCoupling() on.
  void setCoupling(const ToolCoupling& coupling) noexcept;

  /// At rest at X_WT; false and no change when the pose is not rigid.
  bool reset(const PlainPose& X_WT) noexcept;

  /// Velocity after h under the coupling alone, capped. A target that is not finite or not rigid
  /// is ignored (false): the tool coasts to rest under its damping.
  bool applyCoupling(const ToolTarget& target, double h) noexcept;

  [[nodiscard]] ContactBody contactBody() const noexcept;
  /// Velocity after the contacts, capped; remembers the position correction for advance().
  /// The response's impulse is about centre(); contactWrench() has it as a wrench. Not touched:
  /// the velocity stays, to the bit.
  void take(const BodyResponse& response, bool touched, double h) noexcept;
  /// Both, for a tool that is the only body.
  ContactResponse resolve(ContactResolver& resolver, std::span<const Contact> contacts_W,
                          const SurfaceTable& materials, const ResponseSettings& settings,
                          double h) noexcept;

  /// Pose after h.
  void advance(double h) noexcept;

  [[nodiscard]] PlainPose pose() const noexcept { return body_.pose(); }  ///< X_WT
  [[nodiscard]] Eigen::Isometry3d X_WT() const noexcept;
  [[nodiscard]] Eigen::Vector3d originVelocity() const noexcept;  ///< Of the origin of T, m/s.
  [[nodiscard]] Eigen::Vector3d angularVelocity() const noexcept { return body_.angularVelocity(); }
  [[nodiscard]] const RigidBody& body() const noexcept { return body_; }
  /// Force and torque about the origin of T, world axes, that the last contacts put on the tool.
  [[nodiscard]] const Vector6d& contactWrench() const noexcept { return contactWrench_; }
  /// What one step may travel was less than what the coupling asked for.
  [[nodiscard]] bool speedCapped() const noexcept { return capped_; }
  [[nodiscard]] const ToolSettings& settings() const noexcept { return settings_; }

 private:
  void cap(double h) noexcept;

  RigidBody body_;
  ToolSettings settings_;
  double dampingTool_ = 0.0, dampingToolR_ = 0.0;
  Matrix6d mobility_ = Matrix6d::Identity();  ///< Of tool and coupling, from applyCoupling().
  Vector6d shift_ = Vector6d::Zero();
  Vector6d contactWrench_ = Vector6d::Zero();
  bool capped_ = false;
};

}  // namespace palpate
