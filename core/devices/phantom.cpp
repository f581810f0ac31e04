#include "core/devices/phantom.h"

#include <cstdlib>
#include <thread>
#include <utility>

#include "core/devices/phantom_facts.h"
#include "core/devices/vendor_scheduler.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr double kPeriod = 1.0 / static_cast<double>(VendorScheduler::kRate);
// FireWire devices can only do a whole fraction of 8 kHz, so 1 % is generous.
constexpr int kRateSlack = 10;  // Hz
// Longer than any scheduler's hiccup, shorter than a person's patience.
constexpr auto kNoTicks = 200ms;

}  // namespace

Phantom::Phantom(PhantomOptions options) : options_(std::move(options)) {
  info_ = deviceInfo({});
}

Phantom::~Phantom() {
  close();
}

Result<void> Phantom::open() {
  if (scheduler_ != nullptr) return {};
  const hd::LibrarySearch search = hd::findLibrary(options_.libraries);
  if (search.library == nullptr) return fail(hd::libraryError(search));
  scheduler_ = &VendorScheduler::of(*search.library);
  Result<void> taken = scheduler_->whileStopped([this] { return take(options_.names); });
  // Also where the scheduler did not start: nothing may stay half open.
  if (!taken) close();
  return taken;
}

/// Inside whileStopped().
Result<void> Phantom::take(const std::vector<std::string>& names) {
  const auto device = takeDevice(*scheduler_, names);
  if (!device) return fail(device.error());
  AskedDevice asked = askDevice(*scheduler_, *device);
  facts_ = std::move(asked.facts);
  setup_ = asked.setup;
  info_ = deviceInfo(facts_);
  if (Result<void> ready = prepare(); !ready) return ready;
  servo_.begin(setup_);
  return scheduler_->add(servo_);
}

/// A taken device made able to give force, or an Error.
Result<void> Phantom::prepare() {
  constexpr int rate = static_cast<int>(VendorScheduler::kRate);
  if (facts_.updateRate > 0 && std::abs(facts_.updateRate - rate) > kRateSlack)
    return fail(machineError("The device does not run at the servo's rate.")
                    .inField("device")
                    .butFound(std::to_string(facts_.updateRate) + " Hz")
                    .wants(std::to_string(rate) + " Hz")
                    .advise("Set the device's rate to 1000 Hz in the vendor's set-up tool."));
  scheduler_->takeErrors();
  scheduler_->library().api.enable(hd::kForceOutput);
  const auto errors = scheduler_->takeErrors();
  if (const hd::ErrorInfo* cause = causeOf(errors))
    return fail(machineError("The device's force could not be switched on.")
                    .inField("device")
                    .butFound(errorText(*cause))
                    .advise(hd::meaningOf(cause->code).sentence));
  return {};
}

/// Inside whileStopped().
void Phantom::giveBack() noexcept {
  if (setup_.handle == hd::kInvalidHandle) return;
  const hd::Api& api = scheduler_->library().api;
  api.makeCurrentDevice(setup_.handle);
  api.disable(hd::kForceOutput);
  api.disableDevice(setup_.handle);
  setup_.handle = hd::kInvalidHandle;
}

void Phantom::close() noexcept {
  if (scheduler_ == nullptr) return;
  stopServo();
  (void)scheduler_->whileStopped([this]() -> Result<void> {
    scheduler_->remove(servo_);
    giveBack();
    scheduler_->takeErrors();
    servo_.begin({});  // a late read() finds no device
    return {};
  });
  scheduler_ = nullptr;
}

Result<void> Phantom::startServo(void (*tick)(void* owner) noexcept, void* owner) {
  if (scheduler_ == nullptr)
    return fail(usageError("The device is not open.").advise("Open it first."));
  servo_.setOwner(tick, owner);
  return {};
}

void Phantom::stopServo() noexcept {
  servo_.clearOwner();
  if (scheduler_ == nullptr) return;
  // Without an owner each tick sends zero; a scheduler that stands still cannot.
  const auto end = std::chrono::steady_clock::now() + kNoTicks;
  while (servo_.quietTicks() < kQuietTicks && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(500us);
}

DeviceSample Phantom::read(std::uint64_t tick) noexcept {
  DeviceSample sample = servo_.sample();
  sample.index = tick;
  sample.t = static_cast<double>(tick) * kPeriod;
  return sample;
}

void Phantom::write(const Wrench& wrench_D) noexcept {
  servo_.setWrench(wrench_D);
}

PhantomStatus Phantom::status() {
  const std::lock_guard lock(statusMutex_);
  PhantomStatus status = servo_.status();
  if (scheduler_ == nullptr) return {};
  const auto now = std::chrono::steady_clock::now();
  if (status.ticks != lastTicks_ || lastTickSeen_.time_since_epoch().count() == 0) {
    lastTicks_ = status.ticks;
    lastTickSeen_ = now;
  } else if (now - lastTickSeen_ > kNoTicks) {
    status.state = hd::DriverState::Fault;
    status.error = hd::kTimerError;
  }
  return status;
}

DeviceCondition Phantom::condition() {
  const PhantomStatus now = status();
  DeviceCondition out;
  switch (now.state) {
    case hd::DriverState::Ready:
      out.state = now.poseInvalid ? DeviceCondition::State::Problem : DeviceCondition::State::Ready;
      break;
    case hd::DriverState::Calibrating:
      out.state = DeviceCondition::State::Calibrating;
      out.asksToConfirm = now.calibrationStyle == hd::kStyleEncoderReset;
      break;
    case hd::DriverState::Refused:
    case hd::DriverState::Warm:
    case hd::DriverState::Fault:
      out.state = DeviceCondition::State::Problem;
      break;
    case hd::DriverState::Lost:
    case hd::DriverState::Closed:
      out.state = DeviceCondition::State::Gone;
      break;
  }
  out.sentence = describe(now);
  const std::lock_guard lock(statusMutex_);  // reconnect() may be writing these
  // What heals by itself needs no hand; warm motors need time.
  out.canReconnect = now.state == hd::DriverState::Lost || now.state == hd::DriverState::Fault;
  out.hasInkwell = setup_.inkwell;
  out.docked = now.docked;
  out.buttons = now.buttons;
  out.motorTemperature.assign(now.motorTemperature, now.motorTemperature + now.motors);
  out.firmware = facts_.firmware;
  out.driver = facts_.driverVersion;
  out.serial = facts_.serial;
  return out;
}

Result<void> Phantom::reconnect() {
  if (scheduler_ == nullptr) return open();
  return scheduler_->whileStopped([this]() -> Result<void> {
    giveBack();
    scheduler_->takeErrors();
    servo_.begin({});
    const auto device = takeDevice(*scheduler_, {facts_.configuredName});
    if (!device) return fail(device.error());
    AskedDevice asked = askDevice(*scheduler_, *device);
    setup_.handle = device->handle;
    if (asked.facts.model != facts_.model || asked.facts.outputDof != facts_.outputDof) {
      giveBack();
      return fail(machineError("Another device answered under this name.")
                      .inField("device")
                      .butFound(asked.facts.model)
                      .wants(facts_.model)
                      .advise("Plug the first device in again, or close the scene and open the "
                              "other device."));
    }
    {
      const std::lock_guard lock(statusMutex_);
      facts_ = std::move(asked.facts);
      setup_ = asked.setup;
    }
    if (Result<void> ready = prepare(); !ready) {
      giveBack();
      return ready;
    }
    servo_.begin(setup_);
    return {};
  });
}

std::string Phantom::libraryPath() const {
  return scheduler_ != nullptr ? scheduler_->library().path : "";
}

}  // namespace palpate
