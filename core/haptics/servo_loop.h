#pragma once
/// One servo tick: read the device, extrapolate the tool, couple, make safe, write.
///
/// tick() is called by our thread, by the virtual clock, or by a vendor's scheduler. It neither
/// allocates, locks, logs nor throws. Watchdogs count ticks, not wall time, so a session replays
/// bit for bit.

#include <Eigen/Geometry>
#include <atomic>
#include <cstdint>
#include <limits>

#include "core/base/latest_value.h"
#include "core/haptics/device.h"
#include "core/haptics/messages.h"
#include "core/haptics/passivity.h"
#include "core/haptics/safety.h"
#include "core/haptics/virtual_coupling.h"

namespace palpate {

struct ServoSettings {
  double period = 1e-3;                                    ///< s
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();  ///< Where the device stands.
  CouplingGains gains;
  SafetyLimits limits;
  std::uint32_t declaredStepTicks = 1;  ///< Servo ticks a simulation step takes.
};

/// Everything a tick did: for the recorder and --samples. World axes.
struct ServoSample {
  DeviceSample device;         ///< In W.
  Wrench wrench;               ///< What left the program, W.
  std::uint64_t toolStep = 0;  ///< The tool state that it used.
  std::uint32_t contacts = 0;
  double depth = 0.0;  ///< m
  SafetyState state = SafetyState::Disarmed;
  SafetyFault fault = SafetyFault::None;
  double handEnergy = 0.0;  ///< Taken from the hand since start, J (passivity observer).
};
static_assert(std::is_trivially_copyable_v<ServoSample>);

class ServoLoop {
 public:
  ServoLoop(HapticDevice& device, const ServoSettings& settings) noexcept;

  /// Servo thread. Returns what it did.
  ServoSample tick() noexcept;

  /// Simulation thread.
  void publishTool(const ToolState& state) noexcept { tool_.publish(state); }
  [[nodiscard]] LatestValue<DeviceSample>& deviceSamples() noexcept { return device_samples_; }

  /// Any thread, lock-free. Arming is honoured only out of contact (design: "Force and safety").
  /// `enabled` is the hold-to-enable input (pedal, key), or true for good where latched. The
  /// stylus' main button, held, enables as well.
  void setEnabled(bool enabled) noexcept;
  /// Force off now, whatever the state; enabling must be let go and given again. Safe from a
  /// signal handler.
  void forceOff() noexcept;
  /// Any thread: the way back from a fault, honoured when its cause is gone.
  void clearFault() noexcept;

 private:
  [[nodiscard]] DeviceSample readDevice() noexcept;
  [[nodiscard]] std::uint32_t stepTicks() const noexcept;
  [[nodiscard]] double contactScale() noexcept;
  [[nodiscard]] Wrench coupledWrench(const DeviceSample& device) const noexcept;

  HapticDevice& device_;
  ServoSettings settings_;
  Eigen::Quaterniond q_WD_;
  SafetyGuard safety_;
  PassivityObserver passivity_;
  LatestValue<ToolState> tool_;
  LatestValue<DeviceSample> device_samples_;
  PlainPose lastGood_;  ///< Of the device, in W.
  std::uint64_t tick_ = 0;
  std::uint32_t freeTicks_ = std::numeric_limits<std::uint32_t>::max() / 2;  ///< since a contact
  std::uint32_t ticksSinceNews_ = 0;
  std::atomic<bool> enabled_{false}, forceOff_{false}, clearFault_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace palpate
