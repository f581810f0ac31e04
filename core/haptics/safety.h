#pragma once
/// The one place where force is made safe (design: "Force and safety, in one visible place").
///
/// Order per tick: state machine (faults, arming, watchdog) -> fade and ramp -> magnitude clamp
/// (peak; continuous after 1 s) -> slew clamp. A fault may cut at once. Counts ticks, never wall
/// time.

#include <cstdint>

#include "core/haptics/messages.h"

namespace palpate {

enum class SafetyState : std::uint8_t {
  Disarmed,  ///< Zero force: not enabled.
  Blocked,   ///< Zero force: enabled, but in contact; let go of the anatomy first.
  Ramping,   ///< Rising to full over the ramp.
  Armed,     ///< Full force.
  Fading,    ///< No news from the simulation: going to zero.
  Fault,     ///< Zero force until cleared.
};

enum class SafetyFault : std::uint8_t {
  None,
  InvalidSample,  ///< The device gave numbers that are not a pose.
  DeviceLost,
  DeviceFault,
  InvalidWrench,    ///< The simulation gave numbers that are not a force.
  OverSpeed,        ///< The stylus moved faster than the velocity stop.
  Stalled,          ///< The simulation was silent for too long.
  EnergyGenerated,  ///< The port gave the hand energy it had not taken, beyond the controller's
                    ///< reach.
};

/// A sentence for people: what happened and what to do.
[[nodiscard]] const char* describe(SafetyFault fault) noexcept;
[[nodiscard]] const char* describe(SafetyState state) noexcept;

struct SafetyLimits {
  double peakForce = 3.0;         ///< N
  double continuousForce = 0.8;   ///< N, after 1 s above it
  double peakTorque = 0.0;        ///< N·m; 0: none leaves the program
  double forceSlew = 1.0;         ///< N per tick of 1 ms (design: 1 N/ms), rising and turning
  double torqueSlew = 0.02;       ///< N·m per ms
  std::uint32_t rampTicks = 200;  ///< Zero to full on start
  std::uint32_t staleTicks = 5;   ///< Silence before the fade (max of this and 3 declared steps)
  std::uint32_t fadeTicks = 10;
  std::uint32_t stallFaultTicks = 500;  ///< Silence before it is a fault
  double velocityStop = 2.0;            ///< m/s of the stylus
};

/// State of the guard between ticks. Servo thread; real-time safe.
class SafetyGuard {
 public:
  explicit SafetyGuard(const SafetyLimits& limits) noexcept : limits_(limits) {}

  struct Inputs {
    bool enabled = false, forceOff = false, clearFault = false;
    bool inContact = false;
    std::uint32_t ticksSinceNews = 0, declaredStepTicks = 1;
    std::uint32_t deviceStatus = 0;
    double speed = 0.0;  ///< Of the stylus, m/s
    bool energyFault = false;
  };
  /// What may leave the program this tick.
  [[nodiscard]] Wrench apply(const Wrench& wanted, const Inputs& inputs) noexcept;

  [[nodiscard]] SafetyState state() const noexcept { return state_; }
  [[nodiscard]] SafetyFault fault() const noexcept { return fault_; }

 private:
  SafetyLimits limits_;
  SafetyState state_ = SafetyState::Disarmed;
  SafetyFault fault_ = SafetyFault::None;
  std::uint32_t ramp_ = 0, over_ = 0;
  Wrench last_;
};

}  // namespace palpate
