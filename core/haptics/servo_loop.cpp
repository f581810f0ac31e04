#include "core/haptics/servo_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// Most damping the passivity controller may add, N·s/m. Above it, damping on a 45 g arm through a
/// 100 Hz velocity filter and a tick of latency itself becomes unstable (about M / 4 ms = 11).
constexpr double kMaxControllerDamping = 3.0;
constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();

/// Ticks without contact over which what is left of the coupling's force goes to zero. Long enough
/// that a contact that flickers does not chatter, short enough not to be felt as stickiness.
constexpr std::uint32_t kReleaseTicks = 20;

void rotate(const Eigen::Quaterniond& q, double (&v)[3]) noexcept {
  const Eigen::Vector3d r = q * Eigen::Vector3d(v[0], v[1], v[2]);
  for (int i = 0; i < 3; ++i) v[i] = r[i];
}

bool within(const double (&v)[3], double most) noexcept {
  return std::abs(v[0]) <= most && std::abs(v[1]) <= most && std::abs(v[2]) <= most;
}

/// In D. Beyond any arm's reach or motor's speed, and not a number: corrupted, not fast. What is
/// merely too fast is the velocity stop's.
bool plausible(const DeviceSample& s) noexcept {
  constexpr double kReach = 10.0;     // m
  constexpr double kSpeed = 1000.0;   // m/s
  constexpr double kSpeedR = 1000.0;  // rad/s
  return isRigid(s.pose) && within(s.pose.p, kReach) && within(s.v, kSpeed) && within(s.w, kSpeedR);
}

}  // namespace

ServoLoop::ServoLoop(HapticDevice& device, const ServoSettings& settings) noexcept
    : device_(device),
      settings_(settings),
      q_WD_(Eigen::Quaterniond(settings.X_WD.linear()).normalized()),
      safety_(settings.limits),
      lastGood_(plain(settings.X_WD)),
      ticksSinceNews_(kNever) {}

void ServoLoop::setEnabled(bool enabled) noexcept {
  enabled_.store(enabled, std::memory_order_relaxed);
}
void ServoLoop::forceOff() noexcept {
  forceOff_.store(true, std::memory_order_relaxed);
}
void ServoLoop::clearFault() noexcept {
  clearFault_.store(true, std::memory_order_relaxed);
}

/// In W. Numbers that are no pose are replaced by the last good one, at rest, and marked.
DeviceSample ServoLoop::readDevice() noexcept {
  DeviceSample s = device_.read(tick_);
  s.index = tick_;
  s.t = static_cast<double>(tick_) * settings_.period;
  const bool absent = (s.status & (kDeviceLost | kDeviceNotReady)) != 0;
  if (absent || !plausible(s)) {
    if (!absent) s.status |= kDeviceInvalidSample;
    s.pose = lastGood_;
    for (int i = 0; i < 3; ++i) s.v[i] = s.w[i] = 0.0;
    return s;
  }
  s.pose = plain(settings_.X_WD * position(s.pose), (q_WD_ * orientation(s.pose)).normalized());
  rotate(q_WD_, s.v);
  rotate(q_WD_, s.w);
  lastGood_ = s.pose;
  return s;
}

/// Servo ticks that a simulation step takes: as declared, or longer where the machine is slow, up
/// to kSlowestPace. Beyond, the watchdog fades the force.
std::uint32_t ServoLoop::stepTicks() const noexcept {
  constexpr std::uint32_t kSlowestPace = 10;  // 100 steps a second
  const std::uint32_t pace = std::min(tool_.value().paceTicks, kSlowestPace);
  return std::max({1u, settings_.declaredStepTicks, pace});
}

/// The tool where it is by now: its last state moved on by its velocity, as far as the watchdog
/// trusts it.
Wrench ServoLoop::coupledWrench(const DeviceSample& device) const noexcept {
  const ToolState& tool = tool_.value();
  if (tool.step == 0) return {};
  const double trusted =
      static_cast<double>(std::max(settings_.limits.staleTicks, 3 * stepTicks()));
  const double late = tick_ >= tool.dueTick ? static_cast<double>(tick_ - tool.dueTick)
                                            : -static_cast<double>(tool.dueTick - tick_);
  const double dt = settings_.period * std::clamp(late, -trusted, trusted);
  const Eigen::Vector3d p =
      position(tool.pose) + dt * Eigen::Vector3d(tool.v[0], tool.v[1], tool.v[2]);
  const Eigen::Quaterniond q =
      expMap(dt * Eigen::Vector3d(tool.w[0], tool.w[1], tool.w[2])) * orientation(tool.pose);
  return couplingWrench(softened(settings_.gains, tool.stiffnessShare), plain(p, q), tool.v, tool.w,
                        device);
}

/// 1 in contact, 0 in free space. Out of contact the tool's inertia and lag would be felt as a
/// drag, and what they give and take would spend the energy balance before a contact begins
/// (McNeely 1999: no output in free space).
double ServoLoop::contactScale() noexcept {
  const std::uint32_t release = std::max(kReleaseTicks, 3 * stepTicks());
  freeTicks_ = tool_.value().contacts > 0 ? 0 : std::min(freeTicks_ + 1, release);
  return 1.0 - static_cast<double>(freeTicks_) / release;
}

ServoSample ServoLoop::tick() noexcept {
  ServoSample out;
  out.device = readDevice();
  device_samples_.publish(out.device);
  passivity_.observe(out.device);

  if (tool_.refresh()) {
    ticksSinceNews_ = 0;
  } else if (ticksSinceNews_ != kNever) {
    ++ticksSinceNews_;
  }
  const ToolState& tool = tool_.value();

  SafetyGuard::Inputs in;
  in.enabled = enabled_.load(std::memory_order_relaxed) || (out.device.buttons & 1u) != 0;
  in.forceOff = forceOff_.exchange(false, std::memory_order_relaxed);
  in.clearFault = clearFault_.exchange(false, std::memory_order_relaxed);
  in.inContact = tool.contacts > 0;
  in.ticksSinceNews = ticksSinceNews_;
  in.declaredStepTicks = stepTicks();
  in.deviceStatus = out.device.status;
  in.speed = Eigen::Vector3d(out.device.v[0], out.device.v[1], out.device.v[2]).norm();
  if (in.clearFault && safety_.state() == SafetyState::Fault) passivity_.rebase();
  in.energyFault = passivity_.failed();

  Wrench coupled = coupledWrench(out.device);
  const double scale = contactScale();
  for (int i = 0; i < 3; ++i) {
    coupled.force[i] *= scale;
    coupled.torque[i] *= scale;
  }
  const Wrench wanted = scale > 0.0 ? passivity_.dissipate(coupled, out.device, settings_.period,
                                                           kMaxControllerDamping)
                                    : coupled;
  const Wrench allowed = safety_.apply(wanted, in);
  out.wrench = safety_.reduce(passivity_.passiveFraction(allowed, out.device, settings_.period));
  passivity_.commit(out.wrench);

  Wrench wrench_D = out.wrench;
  rotate(q_WD_.conjugate(), wrench_D.force);
  rotate(q_WD_.conjugate(), wrench_D.torque);
  device_.write(wrench_D);

  out.toolStep = tool.step;
  out.contacts = tool.contacts;
  out.depth = tool.depth;
  out.state = safety_.state();
  out.fault = safety_.fault();
  out.handEnergy = passivity_.energy();
  ++tick_;
  return out;
}

}  // namespace palpate
