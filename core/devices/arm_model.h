#pragma once
/// The mechanics of a simulated Phantom in a hand (haptics_facts.md §2, §5).
///
/// Translation, alike on each axis: a mass with viscous and Coulomb friction, and the hand as a
/// second mass behind a spring-damper, held to where it wants to be by another:
///
///     M·x'' + b·x' + f_c·sgn(x') = F - k1·(x - x_h) - b1·(x' - x_h')
///     m_h·x_h'' = k1·(x - x_h) + b1·(x' - x_h') - k2·(x_h - x_ref) - b2·x_h'
///
/// Coulomb friction is solved implicitly, for the whole velocity vector: a step in which it could
/// stop the arm does (stick without Karnopp's dead band). Gravity is taken as balanced.
///
/// Rotation: the stylus follows the hand's orientation as a critically damped second-order system,
/// accelerated by the motors' torque where the device has them. No published five-parameter set
/// exists for rotation; 4 Hz is the wrist's bandwidth by our choice.

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "core/haptics/device.h"

namespace palpate {

/// What a model is made of. Values marked R in haptics_facts.md are recalled, not measured.
struct ArmParameters {
  DeviceInfo info;
  double mass = 0.045;              ///< kg at the tip
  double damping = 0.05;            ///< N·s/m; unpublished
  double friction = 0.26;           ///< N, Coulomb
  double encoderStep = 5.5e-5;      ///< m at the tip
  double encoderStepR = 3e-4;       ///< rad
  double rotationalInertia = 2e-4;  ///< kg·m², stylus with the fingers
  double rotationalRate = 25.0;     ///< rad/s: 4 Hz
};

/// Fu and Çavuşoğlu's sets (and Kuchenbecker's grasp of a joystick, which has one spring and
/// damper, between the handle and the ground that moves with the wish). mass 0: nobody holds the
/// arm.
struct GripParameters {
  std::string name;
  double mass = 0.0, k1 = 0.0, b1 = 0.0, k2 = 0.0, b2 = 0.0;
};

[[nodiscard]] const std::vector<ArmParameters>& armModels();
[[nodiscard]] const std::vector<GripParameters>& handGrips();

/// Real-time safe after construction.
class ArmModel {
 public:
  ArmModel(const ArmParameters& arm, const GripParameters& grip) noexcept
      : arm_(arm), grip_(grip) {}

  /// At rest at a pose, the hand at the same place.
  void reset(const Eigen::Vector3d& x, const Eigen::Quaterniond& q) noexcept;
  /// Advances by `period` in sub-steps of at most 20 µs under a held wrench, the wanted pose moving
  /// evenly from the last one to this.
  void advance(double period, const Wrench& motors, const Eigen::Vector3d& wanted,
               const Eigen::Quaterniond& wantedOrientation, bool held) noexcept;

  [[nodiscard]] const Eigen::Vector3d& x() const noexcept { return x_; }
  [[nodiscard]] const Eigen::Vector3d& v() const noexcept { return v_; }
  [[nodiscard]] const Eigen::Quaterniond& q() const noexcept { return q_; }

 private:
  void move(double dt, const Eigen::Vector3d& force, const Eigen::Vector3d& ref,
            bool held) noexcept;
  void turn(double period, const Eigen::Vector3d& torque, const Eigen::Quaterniond& wanted,
            bool held) noexcept;

  ArmParameters arm_;
  GripParameters grip_;
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero(), v_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d xh_ = Eigen::Vector3d::Zero(), vh_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d ref_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d w_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
