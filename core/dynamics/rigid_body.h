#pragma once
/// A rigid body: state about its centre of mass, and one step of it.
///
/// Semi-implicit Euler; orientation by the exponential map. The state holds the world angular
/// momentum L, not the angular velocity, so a torque-free body keeps L to the bit whatever its
/// inertia. The pose advances by the implicit midpoint of Euler's equation in the body's principal
/// axes, which keeps the energy too (haptics_facts.md §3, "Gyro term", asks for 1e-5). SI, world
/// axes.

#include <Eigen/Geometry>

#include "core/dynamics/mass_properties.h"
#include "core/geometry/pose.h"

namespace palpate {

/// Twists and wrenches as (linear, angular), about the centre of mass, world axes.
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Real-time safe: no allocation, lock, exception or log. One thread at a time.
class RigidBody {
 public:
  /// Masses and inertias no integrator could use are floored, and said so by floored(): mass at
  /// 1e-6 kg; principal inertias at 1e-4 of the largest (a needle of 1:1e4) and 1e-14 kg·m².
  explicit RigidBody(const MassProperties& mass) noexcept;

  /// At rest at X_WT. A pose that is not rigid is refused: false, and nothing changes.
  bool reset(const PlainPose& X_WT) noexcept;

  [[nodiscard]] PlainPose pose() const noexcept;  ///< X_WT
  [[nodiscard]] const Eigen::Quaterniond& orientation() const noexcept { return q_WT_; }
  [[nodiscard]] const Eigen::Vector3d& centre() const noexcept { return p_WC_; }
  [[nodiscard]] Eigen::Vector3d origin() const noexcept;  ///< Of T in W.
  [[nodiscard]] double mass() const noexcept { return mass_; }
  [[nodiscard]] bool floored() const noexcept { return floored_; }

  [[nodiscard]] const Eigen::Vector3d& velocity() const noexcept { return v_; }  ///< Of the centre.
  [[nodiscard]] const Eigen::Vector3d& angularMomentum() const noexcept { return L_; }
  [[nodiscard]] Eigen::Vector3d angularVelocity() const noexcept;
  [[nodiscard]] Eigen::Vector3d velocityAt(const Eigen::Vector3d& p_W) const noexcept;
  [[nodiscard]] double kineticEnergy() const noexcept;

  [[nodiscard]] Matrix6d inertia() const noexcept;   ///< diag(m·1, I_W): twist to momentum.
  [[nodiscard]] Matrix6d mobility() const noexcept;  ///< Its inverse: impulse to twist.

  void setTwist(const Eigen::Vector3d& v_C, const Eigen::Vector3d& w) noexcept;
  void applyImpulse(const Eigen::Vector3d& impulse, const Eigen::Vector3d& p_W) noexcept;

  /// Scales the twist down as a whole where a point within `reach` of T's origin could move farther
  /// than `most` metres in h; says whether it did. most <= 0: no limit.
  bool limitTravel(double most, double reach, double h) noexcept;

  /// Pose by velocity; momentum untouched. At most 8 Newton passes for the midpoint.
  void integratePose(double h) noexcept;
  /// Moves the pose alone (position correction). The momentum turns with the body, so the kinetic
  /// energy is exactly what it was.
  void displace(const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) noexcept;

 private:
  [[nodiscard]] Eigen::Vector3d rateAt(const Eigen::Quaterniond& q) const noexcept;
  [[nodiscard]] Eigen::Vector3d midpointMomentum(const Eigen::Vector3d& l, double h) const noexcept;

  double mass_;
  Eigen::Vector3d p_TC_;
  Eigen::Quaterniond q_TP_;  ///< Principal axes of the inertia in T.
  Eigen::Vector3d I_P_;      ///< Principal inertias.
  bool floored_ = false;
  Eigen::Vector3d p_WC_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WT_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d L_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
