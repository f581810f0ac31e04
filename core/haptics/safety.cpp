#include "core/haptics/safety.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

double length(const double (&v)[3]) noexcept {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void scaleBy(double (&v)[3], double s) noexcept {
  for (double& x : v) x *= s;
}

void limitLength(double (&v)[3], double most) noexcept {
  const double n = length(v);
  if (n > most) scaleBy(v, most / n);
}

/// The magnitude may fall freely; what remains of the change (rise and turn) is at most `most`.
void limitChange(double (&v)[3], const double (&last)[3], double most) noexcept {
  const double now = length(v), before = length(last);
  const double kept = before > now ? now / before : 1.0;
  double from[3], change[3];
  for (int i = 0; i < 3; ++i) {
    from[i] = kept * last[i];
    change[i] = v[i] - from[i];
  }
  const double n = length(change);
  if (n <= most) return;
  for (int i = 0; i < 3; ++i) v[i] = from[i] + change[i] * (most / n);
}

bool isFinite(const Wrench& w) noexcept {
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(w.force[i]) || !std::isfinite(w.torque[i])) return false;
  }
  return true;
}

std::uint32_t ticks(std::uint32_t milliseconds, double period) noexcept {
  return static_cast<std::uint32_t>(std::max(1.0, std::ceil(milliseconds * 1e-3 / period - 1e-9)));
}

}  // namespace

const char* describe(SafetyFault fault) noexcept {
  switch (fault) {
    case SafetyFault::None:
      return "No fault.";
    case SafetyFault::InvalidSample:
      return "The device sent a pose that makes no sense. Force is off; check its cable and "
             "calibration, then clear the fault.";
    case SafetyFault::DeviceLost:
      return "The device no longer answers. Force is off; check its power and cable, then clear "
             "the fault.";
    case SafetyFault::DeviceFault:
      return "The device's driver reports a fault. Force is off; see the device panel, then clear "
             "the fault.";
    case SafetyFault::InvalidWrench:
      return "The simulation computed a force that makes no sense. Force is off; reset the "
             "instrument, then clear the fault.";
    case SafetyFault::OverSpeed:
      return "The stylus moved too fast. Force is off; hold it still, then clear the fault.";
    case SafetyFault::Stalled:
      return "The simulation stood still for too long. Force is off; close other programs or "
             "choose a faster setting, then clear the fault.";
    case SafetyFault::EnergyGenerated:
      return "The force fed the hand energy (a vibration). Force is off; grip the stylus or lower "
             "the stiffness, then clear the fault.";
  }
  return "Unknown fault. Force is off.";
}

const char* describe(SafetyState state) noexcept {
  switch (state) {
    case SafetyState::Disarmed:
      return "Force is off. Hold the enable button to feel.";
    case SafetyState::Blocked:
      return "Move the instrument clear of the anatomy to switch the force on.";
    case SafetyState::Ramping:
      return "Force is coming on.";
    case SafetyState::Armed:
      return "Force is on.";
    case SafetyState::Fading:
      return "The simulation is late: the force fades until it catches up.";
    case SafetyState::Fault:
      return "Force is off because of a fault.";
  }
  return "Force is off.";
}

SafetyLimits recommendedLimits(const DeviceInfo& device, double period) noexcept {
  constexpr double kInHand = 0.9;        // below the vendor's own cut-out
  constexpr double kLargestForce = 6.0;  // N: no Phantom task needs more (haptics_facts.md §3)
  SafetyLimits out;
  out.peakForce = std::min(kInHand * device.peakForce, kLargestForce);
  out.continuousForce = std::min(kInHand * device.continuousForce, out.peakForce);
  out.peakTorque = device.feelsTorque ? kInHand * device.peakTorque : 0.0;
  out.forceSlew *= period * 1e3;
  out.torqueSlew *= period * 1e3;
  out.rampTicks = ticks(out.rampTicks, period);
  out.staleTicks = ticks(out.staleTicks, period);
  out.fadeTicks = ticks(out.fadeTicks, period);
  out.stallFaultTicks = ticks(out.stallFaultTicks, period);
  out.freeTicks = ticks(out.freeTicks, period);
  out.peakTicks = ticks(out.peakTicks, period);
  return out;
}

bool SafetyGuard::live() const noexcept {
  return state_ == SafetyState::Ramping || state_ == SafetyState::Armed ||
         state_ == SafetyState::Fading;
}

SafetyFault SafetyGuard::faultOf(const Wrench& wanted, const Inputs& in) const noexcept {
  if ((in.deviceStatus & kDeviceLost) != 0) return SafetyFault::DeviceLost;
  if ((in.deviceStatus & kDeviceFault) != 0) return SafetyFault::DeviceFault;
  if ((in.deviceStatus & kDeviceInvalidSample) != 0 || !std::isfinite(in.speed)) {
    return SafetyFault::InvalidSample;
  }
  if (!isFinite(wanted)) return SafetyFault::InvalidWrench;
  if (!live()) return SafetyFault::None;
  if (in.speed > limits_.velocityStop) return SafetyFault::OverSpeed;
  if (in.ticksSinceNews > limits_.stallFaultTicks) return SafetyFault::Stalled;
  if (in.energyFault) return SafetyFault::EnergyGenerated;
  return SafetyFault::None;
}

void SafetyGuard::advanceState(const Wrench& wanted, const Inputs& in) noexcept {
  const bool stale =
      in.ticksSinceNews > std::max(limits_.staleTicks, 3 * std::max(1u, in.declaredStepTicks));
  free_ = in.inContact ? 0 : std::min(free_ + 1, limits_.freeTicks);
  if (in.forceOff) awaitRelease_ = true;
  if (!in.enabled) awaitRelease_ = false;
  const bool ready = (in.deviceStatus & kDeviceNotReady) == 0;
  const bool enabled = in.enabled && ready && !awaitRelease_ && !in.forceOff;

  const SafetyFault fault = faultOf(wanted, in);
  if (fault != SafetyFault::None) {
    state_ = SafetyState::Fault;
    fault_ = fault;
    return;
  }
  if (state_ == SafetyState::Fault) {
    if (!in.clearFault || stale) return;
    fault_ = SafetyFault::None;
    state_ = SafetyState::Disarmed;
  }
  if (!enabled) {
    state_ = SafetyState::Disarmed;
    return;
  }
  if (!live()) {
    state_ = SafetyState::Blocked;
    if (stale || free_ < limits_.freeTicks) return;
    state_ = SafetyState::Ramping;
    scale_ = 0.0;
  }
  if (stale) {
    state_ = SafetyState::Fading;
    scale_ = std::max(0.0, scale_ - 1.0 / limits_.fadeTicks);
    return;
  }
  scale_ = std::min(1.0, scale_ + 1.0 / limits_.rampTicks);
  state_ = scale_ < 1.0 ? SafetyState::Ramping : SafetyState::Armed;
}

/// The peak for a second, then the continuous limit. The last fifth of that second goes down
/// evenly, so that the change is not felt as a step. A demand below the limit earns the time back.
void SafetyGuard::clampMagnitude(Wrench& w) noexcept {
  const bool above = length(w.force) > limits_.continuousForce;
  if (above) {
    over_ = std::min(over_ + 1, limits_.peakTicks);
  } else if (over_ > 0) {
    --over_;
  }
  const double used = static_cast<double>(over_) / limits_.peakTicks;
  const double blend = std::clamp((used - 0.8) / 0.2, 0.0, 1.0);
  limitLength(w.force, limits_.peakForce + blend * (limits_.continuousForce - limits_.peakForce));
  limitLength(w.torque, limits_.peakTorque);
}

void SafetyGuard::clampSlew(Wrench& w) const noexcept {
  limitChange(w.force, last_.force, limits_.forceSlew);
  limitChange(w.torque, last_.torque, limits_.torqueSlew);
}

Wrench SafetyGuard::apply(const Wrench& wanted, const Inputs& inputs) noexcept {
  advanceState(wanted, inputs);
  Wrench out;
  if (live()) {
    out = wanted;
    scaleBy(out.force, scale_);
    scaleBy(out.torque, scale_);
    clampMagnitude(out);
    clampSlew(out);
  } else {
    scale_ = 0.0;
    if (over_ > 0) --over_;
  }
  last_ = out;
  return out;
}

Wrench SafetyGuard::reduce(double fraction) noexcept {
  const double f = fraction >= 0.0 && fraction <= 1.0 ? fraction : (fraction > 1.0 ? 1.0 : 0.0);
  scaleBy(last_.force, f);
  scaleBy(last_.torque, f);
  return last_;
}

}  // namespace palpate
