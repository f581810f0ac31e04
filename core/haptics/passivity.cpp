#include "core/haptics/passivity.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

double dot(const double (&a)[3], const double (&b)[3]) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

constexpr double kLargestUnforeseen = 2e-3;  // m: a tick at the velocity stop

}  // namespace

void PassivityObserver::observe(const DeviceSample& device) noexcept {
  constexpr double kKept = 0.998;  // a tick: forgotten within a second or two
  constexpr double kGrows = 2.0;   // an oscillation that grows misses by more the next time
  if (started_) {
    const Eigen::Vector3d turn =
        logMap(orientation(device.pose) * orientation(last_.pose).conjugate());
    const double dt = device.t - last_.t;
    double dx[3], missed[3];
    for (int i = 0; i < 3; ++i) {
      dx[i] = device.pose.p[i] - last_.pose.p[i];
      missed[i] = dx[i] - dt * last_.v[i];
    }
    const double da[3] = {turn.x(), turn.y(), turn.z()};
    gained_ = -dot(sent_.force, dx) - dot(sent_.torque, da);
    energy_ += gained_;
    unforeseen_ = std::max(kUnforeseenMove, kKept * unforeseen_);
    // A jump is a fault of another kind (velocity stop), and not to be remembered.
    const double most = std::min(kGrows * std::sqrt(dot(missed, missed)), kLargestUnforeseen);
    unforeseen_ = std::max(unforeseen_, most);
  }
  last_ = device;
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
                      unforeseen_ * std::sqrt(dot(allowed.force, allowed.force));
  const double budget = std::max(allowance, energy_ - base_ + kPassivityReserve);
  return work <= budget ? 1.0 : budget / work;
}

}  // namespace palpate
