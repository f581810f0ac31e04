#pragma once
/// What a haptic device is to the servo, whoever made it.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/haptics/messages.h"

namespace palpate {

/// Limits and facts of a device. Frame D: +x right, +y up, +z towards the user, metres.
struct DeviceInfo {
  std::string name;   ///< "Simulated Touch X".
  std::string model;  ///< "touch", "touch-x", "premium-6dof", ...
  bool simulated = false;
  bool feelsTorque = false;          ///< Else torque is drawn, not felt.
  double peakForce = 3.3;            ///< N
  double continuousForce = 0.88;     ///< N
  double peakTorque = 0.0;           ///< N·m
  double couplingStiffness = 400.0;  ///< Recommended K_T, N/m (haptics_facts.md §3).
  double couplingDamping = 2.0;      ///< Recommended B_T, N·s/m.
  double couplingStiffnessR = 0.16;  ///< N·m/rad
  double couplingDampingR = 8e-4;    ///< N·m·s/rad
  std::array<double, 3> workspaceMin{-0.08, -0.06, -0.035};  ///< m, in D
  std::array<double, 3> workspaceMax{0.08, 0.06, 0.035};
};

/// What an open device says of itself, for people: the device panel and `palpate devices`.
struct DeviceCondition {
  enum class State : std::uint8_t {
    Ready,
    Calibrating,  ///< No force yet; `sentence` says what the person does.
    Problem,      ///< The device or its driver complains; force is off.
    Gone,         ///< It does not answer; it may come back.
  } state = State::Ready;
  std::string sentence = "The device works.";  ///< What is, and what to do about it.
  bool asksToConfirm = false;  ///< The person shall say that the arm is where `sentence` wants it.
  bool canReconnect = false;   ///< reconnect() may help.
  bool hasInkwell = false, docked = false;
  std::uint32_t buttons = 0;
  std::vector<double> motorTemperature;  ///< 0 cold to 1 too hot; empty: not told.
  std::string firmware, driver, serial;  ///< Empty: not told. The serial is shown, never logged.
};

/// read() and write() run on the servo thread, once a tick each, and are real-time safe; the rest
/// is called before start and after stop.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  [[nodiscard]] virtual const DeviceInfo& info() const noexcept = 0;
  /// Takes the device; an Error says what was tried and what to do.
  [[nodiscard]] virtual Result<void> open() = 0;
  virtual void close() noexcept = 0;
  /// The reading for servo tick `tick`, in D.
  [[nodiscard]] virtual DeviceSample read(std::uint64_t tick) noexcept = 0;
  /// The wrench on the hand for this tick, in D.
  virtual void write(const Wrench& wrench_D) noexcept = 0;

  /// True: the vendor's scheduler owns the clock; startServo() makes it call tick(owner) once a
  /// period on its own thread, with read() and write() inside that call.
  [[nodiscard]] virtual bool ownsClock() const noexcept { return false; }
  [[nodiscard]] virtual Result<void> startServo(void (*tick)(void* owner) noexcept, void* owner) {
    (void)tick;
    (void)owner;
    return fail(usageError("This device has no clock of its own."));
  }
  /// When it returns, tick is not called again and a zero wrench was sent.
  virtual void stopServo() noexcept {}

  /// Any thread but the servo's, while open.
  [[nodiscard]] virtual DeviceCondition condition() { return {}; }
  /// Any thread: the arm is where condition() asked for it to be.
  virtual void confirm() noexcept {}
  /// Not on the servo thread: takes a device that went away again, the servo running on without
  /// force. On an Error it may be tried again.
  [[nodiscard]] virtual Result<void> reconnect() {
    return fail(usageError("This device cannot be reconnected."));
  }
};

}  // namespace palpate
