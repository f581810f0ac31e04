#include "core/devices/arm_model.h"

#include <cmath>

namespace palpate {
namespace {

constexpr double kSubStep = 20e-6;  // s; haptics_facts.md §5

std::vector<ArmParameters> makeArmModels() {
  ArmParameters touch;
  touch.info.name = "Simulated Touch";
  touch.info.model = "touch";
  touch.info.simulated = true;
  touch.info.peakForce = 3.3;
  touch.info.continuousForce = 0.88;
  touch.info.couplingStiffness = 400.0;
  touch.info.couplingDamping = 2.0;
  touch.info.couplingStiffnessR = 0.16;
  touch.info.couplingDampingR = 8e-4;
  touch.info.workspaceMin = {-0.080, -0.060, -0.035};
  touch.info.workspaceMax = {0.080, 0.060, 0.035};

  ArmParameters touchX;
  touchX.info = touch.info;
  touchX.info.name = "Simulated Touch X";
  touchX.info.model = "touch-x";
  touchX.info.peakForce = 7.9;
  touchX.info.continuousForce = 1.75;
  touchX.info.couplingStiffness = 600.0;
  touchX.info.couplingStiffnessR = 0.24;
  touchX.info.workspaceMin = {-0.080, -0.060, -0.060};
  touchX.info.workspaceMax = {0.080, 0.060, 0.060};
  touchX.mass = 0.035;
  touchX.damping = 0.02;
  touchX.friction = 0.06;
  touchX.encoderStep = 2.3e-5;

  ArmParameters premium;
  premium.info = touch.info;
  premium.info.name = "Simulated Premium 6DOF";
  premium.info.model = "premium-6dof";
  premium.info.feelsTorque = true;
  premium.info.peakForce = 8.5;
  premium.info.continuousForce = 1.4;
  premium.info.peakTorque = 0.188;
  premium.info.couplingStiffness = 600.0;
  premium.info.couplingStiffnessR = 0.3;
  premium.info.couplingDampingR = 0.004;
  premium.info.workspaceMin = {-0.1905, -0.1335, -0.0955};
  premium.info.workspaceMax = {0.1905, 0.1335, 0.0955};
  premium.mass = 0.136;
  premium.damping = 0.05;
  premium.friction = 0.04;
  premium.encoderStep = 3.0e-5;
  return {touch, touchX, premium};
}

Eigen::Vector3d vector(const double (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
}

}  // namespace

const std::vector<ArmParameters>& armModels() {
  static const std::vector<ArmParameters> models = makeArmModels();
  return models;
}

const std::vector<GripParameters>& handGrips() {
  static const std::vector<GripParameters> grips = {
      {"up-down", 0.269, 552.0, 3.61, 105.0, 6.4},
      {"left-right", 0.218, 380.0, 1.84, 79.0, 4.6},
      {"fore-aft", 0.204, 770.0, 0.78, 272.0, 18.1},
      {"soft", 0.14, 228.0, 0.87, 63.0, 3.7},
      {"stiff", 0.43, 1043.0, 0.01, 533.0, 13.1},
      {"light", 0.016, 679.0, 0.01, 214.0, 13.1},
      // The handle's mass on 40 N/m and 23 N·s/m; bound to the arm as stiffly as the stiff grip.
      {"joystick", 0.014, 1043.0, 1.84, 40.0, 23.0},
      {"none"},
  };
  return grips;
}

void ArmModel::reset(const Eigen::Vector3d& x, const Eigen::Quaterniond& q) noexcept {
  x_ = xh_ = ref_ = x;
  q_ = q;
  v_.setZero();
  vh_.setZero();
  w_.setZero();
}

void ArmModel::advance(double period, const Wrench& motors, const Eigen::Vector3d& wanted,
                       const Eigen::Quaterniond& wantedOrientation, bool held) noexcept {
  const bool inHand = held && grip_.mass > 0.0;
  const int steps = static_cast<int>(std::ceil(period / kSubStep - 1e-9));
  const double dt = period / steps;
  const Eigen::Vector3d force = vector(motors.force);
  for (int i = 1; i <= steps; ++i) {
    const double f = static_cast<double>(i) / steps;
    move(dt, force, ref_ + f * (wanted - ref_), inHand);
  }
  ref_ = wanted;
  turn(period, arm_.info.feelsTorque ? vector(motors.torque) : Eigen::Vector3d::Zero(),
       wantedOrientation, inHand);
}

void ArmModel::move(double dt, const Eigen::Vector3d& force, const Eigen::Vector3d& ref,
                    bool held) noexcept {
  Eigen::Vector3d grip = Eigen::Vector3d::Zero();
  if (held) {
    grip = grip_.k1 * (x_ - xh_) + grip_.b1 * (v_ - vh_);
    vh_ += dt / grip_.mass * (grip - grip_.k2 * (xh_ - ref) - grip_.b2 * vh_);
  }
  v_ += dt / arm_.mass * (force - grip - arm_.damping * v_);
  const double stop = dt / arm_.mass * arm_.friction;
  const double speed = v_.norm();
  if (speed <= stop) {
    v_.setZero();
  } else {
    v_ *= 1.0 - stop / speed;
  }
  x_ += dt * v_;
  if (held) {
    xh_ += dt * vh_;
  } else {
    xh_ = x_;
    vh_.setZero();
  }
}

/// One step a period is enough: 25 rad/s against 1 ms.
void ArmModel::turn(double period, const Eigen::Vector3d& torque, const Eigen::Quaterniond& wanted,
                    bool held) noexcept {
  const double rate = arm_.rotationalRate;
  Eigen::Vector3d acceleration = torque / arm_.rotationalInertia - 2.0 * rate * w_;
  if (held) acceleration += rate * rate * logMap(wanted * q_.conjugate());
  w_ += period * acceleration;
  q_ = (expMap(period * w_) * q_).normalized();
}

}  // namespace palpate
