#include "core/dynamics/tool_body.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

Eigen::Matrix3d crossMatrix(const Eigen::Vector3d& r) noexcept {
  Eigen::Matrix3d m;
  m << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return m;
}

bool finite(const double (&v)[3]) noexcept {
  return std::isfinite(v[0] + v[1] + v[2]);
}

}  // namespace

ToolBody::ToolBody(const MassProperties& mass, const ToolSettings& settings) noexcept
    : body_(mass), settings_(settings) {
  setCoupling(settings.coupling);
  mobility_ = body_.mobility();
}

void ToolBody::setCoupling(const ToolCoupling& c) noexcept {
  settings_.coupling = c;
  const double z2 = 2.0 * settings_.dampingRatio;
  // About the origin of T, the largest inertia there can be: the slowest, least damped mode.
  const double arm2 = (body_.origin() - body_.centre()).squaredNorm();
  const double inertiaO = body_.inertia().bottomRightCorner<3, 3>().trace() + body_.mass() * arm2;
  dampingTool_ = std::max(c.damping, z2 * std::sqrt(c.stiffness * body_.mass()));
  dampingToolR_ = std::max(c.dampingR, z2 * std::sqrt(c.stiffnessR * inertiaO));
}

bool ToolBody::reset(const PlainPose& X_WT) noexcept {
  if (!body_.reset(X_WT)) return false;
  mobility_ = body_.mobility();
  shift_.setZero();
  contactWrench_.setZero();
  capped_ = false;
  return true;
}

bool ToolBody::applyCoupling(const ToolTarget& target, double h) noexcept {
  if (!(h > 0.0)) return false;
  const bool good = isRigid(target.pose) && finite(target.v) && finite(target.w);
  const ToolCoupling& c = settings_.coupling;
  const double K = good ? c.stiffness : 0.0;
  const double KR = good ? c.stiffnessR : 0.0;

  // Twist of C to twist of the origin O: v_O = v_C + w × (O - C).
  Matrix6d J = Matrix6d::Identity();
  J.topRightCorner<3, 3>() = -crossMatrix(body_.origin() - body_.centre());
  Vector6d drag;
  drag << Eigen::Vector3d::Constant(dampingTool_ + h * K),
      Eigen::Vector3d::Constant(dampingToolR_ + h * KR);
  const Matrix6d system = body_.inertia() + h * (J.transpose() * drag.asDiagonal() * J);
  mobility_ = system.llt().solve(Matrix6d::Identity());

  Vector6d momentum;
  momentum << body_.mass() * body_.velocity(), body_.angularMomentum();
  if (good) {
    const Eigen::Vector3d v(target.v[0], target.v[1], target.v[2]);
    const Eigen::Vector3d w(target.w[0], target.w[1], target.w[2]);
    const Eigen::Vector3d error = position(target.pose) + h * v - body_.origin();
    const Eigen::Vector3d turn =
        logMap(orientation(target.pose) * body_.orientation().conjugate()) + h * w;
    Vector6d pull;
    pull << K * error + dampingTool_ * v, KR * turn + dampingToolR_ * w;
    momentum += h * (J.transpose() * pull);
  }
  const Vector6d twist = mobility_ * momentum;
  body_.setTwist(twist.head<3>(), twist.tail<3>());
  capped_ = false;
  cap(h);
  return good;
}

ContactBody ToolBody::contactBody() const noexcept {
  ContactBody moving;
  moving.p_WC = body_.centre();
  moving.twist << body_.velocity(), body_.angularVelocity();
  moving.mobility = mobility_;
  return moving;
}

void ToolBody::take(const BodyResponse& response, bool touched, double h) noexcept {
  contactWrench_.setZero();
  shift_.setZero();
  if (!touched) return;
  body_.setTwist(response.twist.head<3>(), response.twist.tail<3>());
  cap(h);
  shift_ = response.shift;
  if (h > 0.0) {
    const Eigen::Vector3d force = response.impulse.head<3>() / h;
    contactWrench_.head<3>() = force;
    contactWrench_.tail<3>() =
        response.impulse.tail<3>() / h + (body_.centre() - body_.origin()).cross(force);
  }
}

ContactResponse ToolBody::resolve(ContactResolver& resolver, std::span<const Contact> contacts_W,
                                  const SurfaceTable& materials, const ResponseSettings& settings,
                                  double h) noexcept {
  ContactResponse response =
      resolver.resolveContacts(contactBody(), contacts_W, materials, settings, h);
  take(response, !contacts_W.empty(), h);
  return response;
}

void ToolBody::advance(double h) noexcept {
  body_.integratePose(h);
  body_.displace(shift_.head<3>(), shift_.tail<3>());
  shift_.setZero();
}

Eigen::Isometry3d ToolBody::X_WT() const noexcept {
  return isometry(body_.pose());
}

Eigen::Vector3d ToolBody::originVelocity() const noexcept {
  return body_.velocityAt(body_.origin());
}

void ToolBody::cap(double h) noexcept {
  if (body_.limitTravel(settings_.maxTravel, settings_.reach, h)) capped_ = true;
}

}  // namespace palpate
