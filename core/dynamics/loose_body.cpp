#include "core/dynamics/loose_body.h"

namespace palpate {

bool LooseBody::reset(const PlainPose& X_WB) noexcept {
  if (!body_.reset(X_WB)) return false;
  shift_.setZero();
  capped_ = false;
  return true;
}

void LooseBody::accelerate(double h) noexcept {
  if (!(h > 0.0)) return;
  if (accelerated_) {  // else not a bit of the twist changes
    const double kept = 1.0 / (1.0 + h * settings_.drag);
    body_.setTwist(kept * (body_.velocity() + h * settings_.gravity),
                   kept * body_.angularVelocity());
  }
  capped_ = false;
  cap(h);
}

ContactBody LooseBody::contactBody() const noexcept {
  ContactBody moving;
  moving.p_WC = body_.centre();
  moving.twist << body_.velocity(), body_.angularVelocity();
  moving.mobility = body_.mobility();
  return moving;
}

void LooseBody::take(const BodyResponse& response, double h) noexcept {
  body_.setTwist(response.twist.head<3>(), response.twist.tail<3>());
  cap(h);
  shift_ = response.shift;
}

void LooseBody::advance(double h) noexcept {
  body_.integratePose(h);
  body_.displace(shift_.head<3>(), shift_.tail<3>());
  shift_.setZero();
}

void LooseBody::cap(double h) noexcept {
  if (body_.limitTravel(settings_.maxTravel, settings_.reach, h)) capped_ = true;
}

}  // namespace palpate
