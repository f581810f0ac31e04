#pragma once
/// What a Phantom does each tick on the vendor's thread: one frame of reading, the owner's tick,
/// the wrench, and the vendor's errors.
///
/// Force leaves only in state Ready, with a good pose, a finite wrench and an owner that wrote it
/// in this very tick; in any other tick zero is sent, since the last force would persist. Nothing
/// here allocates, locks, logs, throws or loops without bound; what the vendor's library does
/// inside its own calls is not known.

#include <atomic>
#include <cstdint>

#include "core/base/latest_value.h"
#include "core/devices/hd_error.h"
#include "core/devices/phantom_calibration.h"
#include "core/devices/phantom_motion.h"
#include "core/devices/vendor_scheduler.h"
#include "core/haptics/messages.h"

namespace palpate {

/// What a Phantom is doing, for people. Plain data.
struct PhantomStatus {
  hd::DriverState state = hd::DriverState::Closed;
  std::uint32_t error = 0;             ///< The code that led to the state; 0 where none did.
  int internalError = 0;               ///< The vendor's own number with it.
  std::uint32_t calibrationStyle = 0;  ///< One of hd::kStyle...; 0: none known.
  bool poseInvalid = false;            ///< The last reading was not a pose.
  bool docked = false;                 ///< Stylus in the inkwell; only where the device has one.
  std::uint32_t buttons = 0;
  int motors = 0;                                ///< How many temperatures there are: 0, 3 or 6.
  double motorTemperature[6] = {};               ///< 0 cold to 1 too hot
  std::uint64_t ticks = 0;                       ///< Since it was opened.
  std::uint64_t errors = 0, invalidSamples = 0;  ///< Counted since it was opened.
};

/// The sentence for a person: guidance while calibrating, else what happened and what to do.
[[nodiscard]] const char* describe(const PhantomStatus& status) noexcept;

class PhantomServo final : public VendorDevice {
 public:
  PhantomServo() noexcept { sample_.status = kDeviceLost; }

  using Tick = void (*)(void* owner) noexcept;

  struct Setup {
    hd::Handle handle = hd::kInvalidHandle;
    bool torque = false;   ///< The device has motors for it.
    bool inkwell = false;  ///< It has a switch there.
    bool warmth = false;   ///< It tells its motors' temperature.
    std::uint32_t style = 0;
  };
  /// While the scheduler stands still: a device was (re)initialised, or lost (kInvalidHandle).
  void begin(const Setup& setup) noexcept;

  /// Not on the vendor's thread. While an owner is set, each tick calls it once.
  void setOwner(Tick tick, void* owner) noexcept;
  /// When it returns the owner is not called again.
  void clearOwner() noexcept;
  void confirmCalibration() noexcept { confirmed_.store(true); }
  /// One thread at a time.
  [[nodiscard]] const PhantomStatus& status() noexcept;

  /// Inside the owner's tick.
  [[nodiscard]] const DeviceSample& sample() const noexcept { return sample_; }
  void setWrench(const Wrench& wrench_D) noexcept { wrench_ = wrench_D; }

  // VendorDevice
  void onTick(VendorScheduler& scheduler) noexcept override;
  void noteError(const hd::ErrorInfo& error) noexcept override;
  [[nodiscard]] hd::Handle handle() const noexcept override { return setup_.handle; }
  void hush(bool quiet) noexcept override;
  [[nodiscard]] std::uint32_t quietTicks() const noexcept override { return quiet_.load(); }

 private:
  void takeErrors(VendorScheduler& scheduler) noexcept;
  void poll(VendorScheduler& scheduler) noexcept;
  void calibrate(VendorScheduler& scheduler) noexcept;
  void readState(const hd::Api& api) noexcept;
  void askOwner() noexcept;
  void send(const hd::Api& api) noexcept;
  void settle(bool clean) noexcept;
  [[nodiscard]] bool faulty() const noexcept;
  [[nodiscard]] std::uint32_t statusBits() const noexcept;

  Setup setup_;
  Calibration calibration_;
  MotionEstimate motion_;
  DeviceSample sample_;
  Wrench wrench_;
  PhantomStatus status_;  // vendor's thread; published each tick
  LatestValue<PhantomStatus> published_;
  bool calibrating_ = false;        // errors now are the calibration's
  bool stateSetNow_ = false;        // by one of the errors being taken
  std::uint64_t errorsBefore_ = 0;  // status_.errors when the tick began
  std::uint32_t cleanTicks_ = 0, healTicks_ = 0;
  bool sticky_ = false;  // some error of this fault does not heal by itself

  std::atomic<Tick> tick_{nullptr};
  std::atomic<void*> owner_{nullptr};
  std::atomic<bool> inOwner_{false}, hushed_{false}, confirmed_{false};
  std::atomic<std::uint32_t> quiet_{0};
};

}  // namespace palpate
