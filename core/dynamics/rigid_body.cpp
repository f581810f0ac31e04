#include "core/dynamics/rigid_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kSmallestMass = 1e-6;      // kg
constexpr double kSmallestInertia = 1e-14;  // kg·m²: a 1e-6 kg grain of 0.1 mm
constexpr double kLargestInertiaRatio = 1e4;
constexpr int kMidpointPasses = 8;            // haptics_facts.md §3
constexpr double kMidpointTolerance = 1e-14;  // relative: converged to the last bit

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& r) noexcept {
  Eigen::Matrix3d m;
  m << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return m;
}

}  // namespace

RigidBody::RigidBody(const MassProperties& mass) noexcept
    : mass_(mass.mass), p_TC_(mass.p_TC), q_TP_(Eigen::Quaterniond::Identity()) {
  if (!(mass_ >= kSmallestMass) || !std::isfinite(mass_)) {
    mass_ = kSmallestMass;
    floored_ = true;
  }
  if (!p_TC_.allFinite()) {
    p_TC_.setZero();
    floored_ = true;
  }
  Eigen::Matrix3d I = 0.5 * (mass.I_C + mass.I_C.transpose());
  if (!I.allFinite()) {
    I.setZero();
    floored_ = true;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(I);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) = -axes.col(2);
  q_TP_ = Eigen::Quaterniond(axes).normalized();
  const double floor =
      std::max(kSmallestInertia, solver.eigenvalues().maxCoeff() / kLargestInertiaRatio);
  I_P_ = solver.eigenvalues().cwiseMax(floor);
  // The eigenvalues carry a relative error of a few ulp; only a real change is a floor.
  if ((I_P_ - solver.eigenvalues()).maxCoeff() > 1e-9 * floor) floored_ = true;
  p_WC_ = p_TC_;
}

bool RigidBody::reset(const PlainPose& X_WT) noexcept {
  if (!isRigid(X_WT)) return false;
  q_WT_ = palpate::orientation(X_WT).normalized();
  p_WC_ = position(X_WT) + q_WT_ * p_TC_;
  v_.setZero();
  L_.setZero();
  return true;
}

PlainPose RigidBody::pose() const noexcept {
  return plain(origin(), q_WT_);
}

Eigen::Vector3d RigidBody::origin() const noexcept {
  return p_WC_ - q_WT_ * p_TC_;
}

Eigen::Vector3d RigidBody::rateAt(const Eigen::Quaterniond& q) const noexcept {
  const Eigen::Matrix3d R_WP = (q * q_TP_).toRotationMatrix();
  return R_WP * (R_WP.transpose() * L_).cwiseQuotient(I_P_);
}

Eigen::Vector3d RigidBody::angularVelocity() const noexcept {
  return rateAt(q_WT_);
}

Eigen::Vector3d RigidBody::velocityAt(const Eigen::Vector3d& p_W) const noexcept {
  return v_ + angularVelocity().cross(p_W - p_WC_);
}

double RigidBody::kineticEnergy() const noexcept {
  return 0.5 * mass_ * v_.squaredNorm() + 0.5 * L_.dot(angularVelocity());
}

Matrix6d RigidBody::inertia() const noexcept {
  const Eigen::Matrix3d R_WP = (q_WT_ * q_TP_).toRotationMatrix();
  Matrix6d M = Matrix6d::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(mass_);
  M.bottomRightCorner<3, 3>() = R_WP * I_P_.asDiagonal() * R_WP.transpose();
  return M;
}

Matrix6d RigidBody::mobility() const noexcept {
  const Eigen::Matrix3d R_WP = (q_WT_ * q_TP_).toRotationMatrix();
  Matrix6d M = Matrix6d::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(1.0 / mass_);
  M.bottomRightCorner<3, 3>() = R_WP * I_P_.cwiseInverse().asDiagonal() * R_WP.transpose();
  return M;
}

void RigidBody::setTwist(const Eigen::Vector3d& v_C, const Eigen::Vector3d& w) noexcept {
  v_ = v_C;
  const Eigen::Matrix3d R_WP = (q_WT_ * q_TP_).toRotationMatrix();
  L_ = R_WP * (R_WP.transpose() * w).cwiseProduct(I_P_);
}

void RigidBody::applyImpulse(const Eigen::Vector3d& impulse, const Eigen::Vector3d& p_W) noexcept {
  v_ += impulse / mass_;
  L_ += (p_W - p_WC_).cross(impulse);
}

/// Euler's equation in principal axes, l' = l + h·(lm × I⁻¹·lm) with lm = (l + l')/2, by Newton's
/// method. The implicit midpoint keeps every quadratic invariant: |l| and the energy, to rounding.
/// (The same rule on the orientation instead keeps neither the energy nor, at 1:1e4, its senses.)
Eigen::Vector3d RigidBody::midpointMomentum(const Eigen::Vector3d& l, double h) const noexcept {
  const Eigen::Vector3d inverse = I_P_.cwiseInverse();
  Eigen::Vector3d next = l;
  for (int pass = 0; pass < kMidpointPasses; ++pass) {
    const Eigen::Vector3d middle = 0.5 * (l + next);
    const Eigen::Vector3d w = inverse.cwiseProduct(middle);
    const Eigen::Matrix3d slope =
        Eigen::Matrix3d::Identity() +
        0.5 * h * (crossMatrix(w) - crossMatrix(middle) * inverse.asDiagonal());
    const Eigen::Vector3d step = slope.inverse() * (l + h * middle.cross(w) - next);
    if (!step.allFinite()) break;
    next += step;
    if (step.norm() <= kMidpointTolerance * l.norm()) break;
  }
  return next;
}

bool RigidBody::limitTravel(double most, double reach, double h) noexcept {
  if (most <= 0.0) return false;
  const Eigen::Vector3d w = angularVelocity();
  const double travel = h * (velocityAt(origin()).norm() + w.norm() * reach);
  if (travel <= most) return false;
  const double scale = most / travel;
  setTwist(scale * v_, scale * w);
  return true;
}

void RigidBody::integratePose(double h) noexcept {
  p_WC_ += h * v_;
  if (L_.squaredNorm() == 0.0) return;
  const Eigen::Quaterniond q_WP = q_WT_ * q_TP_;
  const Eigen::Vector3d l = q_WP.conjugate() * L_;
  const Eigen::Vector3d next = midpointMomentum(l, h);
  const Eigen::Vector3d w = (0.5 * (l + next)).cwiseQuotient(I_P_);
  const Eigen::Quaterniond turned = q_WP * expMap(h * w);
  // The turn is exact to O(h³); the least rotation that brings the momentum home removes what of
  // that would show in L or the energy.
  const Eigen::Quaterniond home = Eigen::Quaterniond::FromTwoVectors(turned * next, L_);
  q_WT_ = (home * turned * q_TP_.conjugate()).normalized();
}

void RigidBody::displace(const Eigen::Vector3d& shift, const Eigen::Vector3d& turn) noexcept {
  p_WC_ += shift;
  const Eigen::Quaterniond dq = expMap(turn);
  q_WT_ = (dq * q_WT_).normalized();
  L_ = dq * L_;
}

}  // namespace palpate
