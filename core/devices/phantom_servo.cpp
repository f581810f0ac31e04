#include "core/devices/phantom_servo.h"

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "core/geometry/units.h"

namespace palpate {
namespace {

using hd::DriverState;

// 50 ms: quick for a person, rare for the vendor's library. Also longer than kQuietTicks, so that
// an update of the calibration, one poll after it was found wanting, finds the force gone.
constexpr std::uint64_t kPollTicks = 50;
static_assert(kPollTicks > kQuietTicks);

constexpr double kMillinewtonMetres = 1e3;  // N·m to HDAPI's mN·m

bool finite(const Wrench& wrench) noexcept {
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(wrench.force[i]) || !std::isfinite(wrench.torque[i])) return false;
  return true;
}

}  // namespace

const char* describe(const PhantomStatus& status) noexcept {
  switch (status.state) {
    case DriverState::Calibrating:
      return calibrationGuidance(status.calibrationStyle);
    case DriverState::Closed:
      return "The device is closed.";
    case DriverState::Ready:
      return status.poseInvalid ? "The device gives numbers that are not a pose: the force is off; "
                                  "check its cable, then clear the fault."
                                : hd::meaningOf(hd::kSuccess).sentence;
    default:
      return hd::meaningOf(status.error).sentence;
  }
}

void PhantomServo::begin(const Setup& setup) noexcept {
  const std::uint64_t ticks = status_.ticks;
  setup_ = setup;
  calibration_ = Calibration(setup.style);
  motion_.reset();
  status_ = {};
  status_.ticks = ticks;
  status_.calibrationStyle = setup.style;
  const bool there = setup.handle != hd::kInvalidHandle;
  status_.state = there ? DriverState::Calibrating : DriverState::Lost;
  status_.error = there ? hd::kSuccess : hd::kCommError;
  sticky_ = !there;
  cleanTicks_ = healTicks_ = 0;
  confirmed_.store(false);
  sample_.status = statusBits();
  published_.publish(status_);
}

void PhantomServo::setOwner(Tick tick, void* owner) noexcept {
  owner_.store(owner);
  tick_.store(tick);
}

void PhantomServo::clearOwner() noexcept {
  tick_.store(nullptr);
  // Sequentially consistent with askOwner(): from here either the callback sees no owner, or we
  // see that it is inside.
  while (inOwner_.load()) std::this_thread::sleep_for(std::chrono::microseconds(100));
}

const PhantomStatus& PhantomServo::status() noexcept {
  published_.refresh();
  return published_.value();
}

void PhantomServo::hush(bool quiet) noexcept {
  hushed_.store(quiet);  // first: a tick that misses it counts nothing it should not
  quiet_.store(0);
}

void PhantomServo::takeErrors(VendorScheduler& scheduler) noexcept {
  stateSetNow_ = false;
  scheduler.routeErrors(*this);
}

bool PhantomServo::faulty() const noexcept {
  return status_.state != DriverState::Ready && status_.state != DriverState::Calibrating;
}

std::uint32_t PhantomServo::statusBits() const noexcept {
  std::uint32_t bits = status_.poseInvalid ? kDeviceInvalidSample : kDeviceOk;
  switch (status_.state) {
    case DriverState::Ready:
      break;
    case DriverState::Calibrating:
      bits = kDeviceNotReady;
      break;
    case DriverState::Refused:
    case DriverState::Warm:
    case DriverState::Fault:
      bits |= kDeviceFault;
      break;
    case DriverState::Lost:
    case DriverState::Closed:
      bits |= kDeviceLost;
      break;
  }
  return bits;
}

void PhantomServo::onTick(VendorScheduler& scheduler) noexcept {
  const hd::Api& api = scheduler.library().api;
  const bool there = setup_.handle != hd::kInvalidHandle;
  errorsBefore_ = status_.errors;
  if (there) {
    api.makeCurrentDevice(setup_.handle);
    api.beginFrame(setup_.handle);
    if (status_.ticks % kPollTicks == 0) poll(scheduler);
    readState(api);
    takeErrors(scheduler);  // before the owner's tick: a fault cuts the force in this one
  }
  sample_.status = statusBits();
  askOwner();
  if (there) {
    send(api);
    api.endFrame(setup_.handle);
    takeErrors(scheduler);
    settle(status_.errors == errorsBefore_ && !status_.poseInvalid);
  } else {
    quiet_.fetch_add(1);
  }
  ++status_.ticks;
  published_.publish(status_);
}

/// Now and then, inside the frame: what changes slowly.
void PhantomServo::poll(VendorScheduler& scheduler) noexcept {
  const hd::Api& api = scheduler.library().api;
  if (setup_.inkwell) {
    // One byte by the vendor's type; room for a library that thinks otherwise.
    hd::Boolean docked[8] = {};
    api.getBooleanv(hd::kInkwellSwitch, docked);
    status_.docked = docked[0] == 0;  // reads inverted: 0 with the stylus in the inkwell
  }
  if (setup_.warmth) {
    double warmth[8];
    for (double& one : warmth) one = std::numeric_limits<double>::quiet_NaN();
    api.getDoublev(hd::kMotorTemperature, warmth);  // 3 or 6 numbers
    status_.motors = 0;
    while (status_.motors < 6 && std::isfinite(warmth[status_.motors])) {
      status_.motorTemperature[status_.motors] = warmth[status_.motors];
      ++status_.motors;
    }
  }
  takeErrors(scheduler);
  if (!faulty()) calibrate(scheduler);
}

void PhantomServo::calibrate(VendorScheduler& scheduler) noexcept {
  const hd::Api& api = scheduler.library().api;
  calibrating_ = true;  // an attempt that fails is no fault: the person tries again
  Calibration::Poll now;
  now.docked = setup_.inkwell && status_.docked;
  now.confirmed = confirmed_.load();
  now.status = api.checkCalibration();
  Calibration::Action action = calibration_.decide(now);
  const bool quiet = status_.state == DriverState::Calibrating;  // since the last poll: no force
  if (action == Calibration::Action::Update && quiet) {
    confirmed_.store(false);
    api.updateCalibration(calibration_.style());
    now.status = api.checkCalibration();
    now.confirmed = false;
    action = calibration_.decide(now);
    motion_.reset();
  }
  takeErrors(scheduler);
  calibrating_ = false;
  const bool done = action == Calibration::Action::None;
  if (done && status_.state == DriverState::Calibrating) {
    status_.state = DriverState::Ready;
    status_.error = hd::kSuccess;
    motion_.reset();  // the pose jumped
  } else if (!done && status_.state == DriverState::Ready) {
    status_.state = DriverState::Calibrating;
  }
}

void PhantomServo::readState(const hd::Api& api) noexcept {
  // Not a number, so that a reading that failed without a word is not taken for a pose.
  double transform[16];
  for (double& number : transform) number = std::numeric_limits<double>::quiet_NaN();
  std::int32_t buttons[2] = {};
  api.getDoublev(hd::kTransform, transform);
  api.getIntegerv(hd::kButtons, buttons);
  const auto pose = poseFromTransform(transform);
  status_.poseInvalid = !pose;
  if (!pose) ++status_.invalidSamples;
  motion_.update(pose);
  status_.buttons = static_cast<std::uint32_t>(buttons[0]);
  sample_.pose = motion_.pose();
  for (int i = 0; i < 3; ++i) {
    sample_.v[i] = motion_.v()[i];
    sample_.w[i] = motion_.w()[i];
  }
  sample_.buttons = status_.buttons;
}

void PhantomServo::askOwner() noexcept {
  wrench_ = {};
  inOwner_.store(true);
  if (const Tick tick = tick_.load()) tick(owner_.load());
  inOwner_.store(false);
}

void PhantomServo::send(const hd::Api& api) noexcept {
  const bool allowed = status_.state == DriverState::Ready && !status_.poseInvalid &&
                       !hushed_.load() && finite(wrench_);
  double force[3] = {0, 0, 0}, torque[3] = {0, 0, 0};
  bool zero = true;
  for (int i = 0; allowed && i < 3; ++i) {
    force[i] = wrench_.force[i];
    if (setup_.torque) torque[i] = wrench_.torque[i] * kMillinewtonMetres;
    zero = zero && force[i] == 0.0 && torque[i] == 0.0;
  }
  api.setDoublev(hd::kForce, force);
  if (setup_.torque) api.setDoublev(hd::kTorque, torque);
  quiet_.store(zero ? quiet_.load() + 1 : 0);
}

void PhantomServo::noteError(const hd::ErrorInfo& error) noexcept {
  const hd::ErrorMeaning& meaning = hd::meaningOf(error.code);
  ++status_.errors;
  if (calibrating_ && meaning.state != DriverState::Lost) return;
  cleanTicks_ = 0;
  // Newest first, so of the errors taken now the cause comes last; later ones only follow from it.
  const bool cause = stateSetNow_ && meaning.state == status_.state;
  if (!faulty() || meaning.state > status_.state || cause) {
    stateSetNow_ = true;
    status_.state = meaning.state;
    status_.error = error.code;
    status_.internalError = error.internalCode;
  }
  sticky_ = sticky_ || meaning.healTicks == 0;
  if (meaning.healTicks > healTicks_) healTicks_ = meaning.healTicks;
}

/// The end of a tick: the way back from a fault whose cause has gone.
void PhantomServo::settle(bool clean) noexcept {
  if (!faulty() || sticky_) return;
  cleanTicks_ = clean ? cleanTicks_ + 1 : 0;
  if (cleanTicks_ < healTicks_) return;
  // A device that was away may have lost its calibration: the next poll sees.
  const bool away = status_.state == DriverState::Lost || status_.state == DriverState::Fault;
  status_.state = away ? DriverState::Calibrating : DriverState::Ready;
  if (!away) status_.error = hd::kSuccess;
  healTicks_ = 0;
  motion_.reset();
}

}  // namespace palpate
