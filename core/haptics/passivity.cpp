#include "core/haptics/passivity.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

double dot(const double (&a)[3], const double (&b)[3]) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

void PassivityObserver::observe(const DeviceSample& device) noexcept {
  if (started_) {
    const Eigen::Vector3d turn = logMap(orientation(device.pose) * orientation(last_).conjugate());
    const double dx[3] = {device.pose.p[0] - last_.p[0], device.pose.p[1] - last_.p[1],
                          device.pose.p[2] - last_.p[2]};
    const double da[3] = {turn.x(), turn.y(), turn.z()};
    gained_ = -dot(sent_.force, dx) - dot(sent_.torque, da);
    energy_ += gained_;
  }
  last_ = device.pose;
  started_ = true;
}

Wrench PassivityObserver::dissipate(const Wrench& wanted, const DeviceSample& device, double period,
                                    double maxDamping) noexcept {
  const double deficit = base_ - energy_;
  const double v2 = dot(device.v, device.v);
  constexpr double kSlow2 = 1e-6;  // (1 mm/s)²: below it the velocity is encoder noise
  if (!(deficit > 0.0) || !(v2 > kSlow2)) return wanted;
  const double damping = std::min(maxDamping, deficit / (period * v2));
  Wrench out = wanted;
  for (int i = 0; i < 3; ++i) out.force[i] -= damping * device.v[i];
  return out;
}

double PassivityObserver::passiveFraction(const Wrench& allowed, const DeviceSample& device,
                                          double period) const noexcept {
  // What may still go out once the reserve is spent: a share of what is left above the floor, so
  // that many ticks in a row do not wear it away; and while the hand pushes against the force, a
  // few times what the last tick earned.
  constexpr double kFloor = -18e-6, kShare = 0.025, kLeast = 1e-10, kMost = 2e-7;  // J, 1, J, J
  constexpr double kTrust = 4.0;
  const double allowance =
      std::max({kLeast, kShare * (energy_ - base_ - kFloor), std::min(kMost, kTrust * gained_)});
  const double work = period * (dot(allowed.force, device.v) + dot(allowed.torque, device.w)) +
                      kUnforeseenMove * std::sqrt(dot(allowed.force, allowed.force));
  const double budget = std::max(allowance, energy_ - base_ + kPassivityReserve);
  return work <= budget ? 1.0 : budget / work;
}

}  // namespace palpate
