#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/devices/hand.h"

namespace palpate {
namespace {
constexpr double kFollowHz = 8.0;
}

PlainPose stylusAtRest(double height) noexcept {
  // About x by -60°: +z of the stylus becomes (0, cos 30°, sin 30°) in D.
  const Eigen::Vector3d about(-std::numbers::pi / 3.0, 0.0, 0.0);
  return plain(Eigen::Vector3d(0.0, height, 0.0), expMap(about));
}

FollowingHand::FollowingHand(const HandTarget& start) noexcept : wanted_(start), current_(start) {}

HandTarget FollowingHand::target(double t, const DeviceSample&, const Wrench&) noexcept {
  if (newest_.refresh() && isRigid(newest_.value().pose_D)) wanted_ = newest_.value();
  const double dt = started_ ? std::clamp(t - last_, 0.0, 0.1) : 0.0;
  started_ = true;
  last_ = t;
  const double a = 1.0 - std::exp(-2.0 * std::numbers::pi * kFollowHz * dt);
  const Eigen::Vector3d p =
      position(current_.pose_D) + a * (position(wanted_.pose_D) - position(current_.pose_D));
  const Eigen::Quaterniond q = orientation(current_.pose_D);
  const Eigen::Vector3d turn = logMap(orientation(wanted_.pose_D) * q.conjugate());
  current_.pose_D = plain(p, (expMap(a * turn) * q).normalized());
  current_.buttons = wanted_.buttons;
  current_.present = wanted_.present;
  return current_;
}

}  // namespace palpate
