#pragma once
/// The one place where force is made safe (design: "Force and safety, in one visible place").
///
/// Order per tick: state machine (faults, arming, watchdog) -> fade and ramp -> magnitude clamp
/// (peak; continuous after 1 s) -> slew clamp. Rises and turns are limited; the magnitude may fall
/// at once. A fault, force off and letting go of the enable cut to zero within the tick. Clamps
/// scale the vector, so they keep its direction. Counts ticks, never wall time.
///
///     Disarmed --enabled--> Blocked --out of contact--> Ramping --> Armed
///        ^ let go, force off                              |   ^       |
///        +------------------------------------------------+   +-- Fading <- no news
///     any --fault--> Fault --clearFault(), cause gone--> Disarmed

#include <cstdint>

#include "core/haptics/device.h"
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
  std::uint32_t freeTicks = 20;         ///< Without contact before it may arm
  std::uint32_t peakTicks = 1000;       ///< Above the continuous limit at most this long
};

/// Within the device's own limits, with a tenth in hand (haptics_facts.md §3), for ticks of
/// `period` seconds: times above are for 1 ms and are scaled.
[[nodiscard]] SafetyLimits recommendedLimits(const DeviceInfo& device,
                                             double period = 1e-3) noexcept;

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
  /// What may leave the program this tick. A wanted wrench that is not finite is a fault.
  [[nodiscard]] Wrench apply(const Wrench& wanted, const Inputs& inputs) noexcept;
  /// Sends only a fraction (0..1) of what apply() allowed: for the passivity controller.
  [[nodiscard]] Wrench reduce(double fraction) noexcept;

  [[nodiscard]] SafetyState state() const noexcept { return state_; }
  [[nodiscard]] SafetyFault fault() const noexcept { return fault_; }

 private:
  [[nodiscard]] bool live() const noexcept;
  [[nodiscard]] SafetyFault faultOf(const Wrench& wanted, const Inputs& inputs) const noexcept;
  void advanceState(const Wrench& wanted, const Inputs& inputs) noexcept;
  void clampMagnitude(Wrench& w) noexcept;
  void clampSlew(Wrench& w) const noexcept;

  SafetyLimits limits_;
  SafetyState state_ = SafetyState::Disarmed;
  SafetyFault fault_ = SafetyFault::None;
  double scale_ = 0.0;         ///< Of ramp and fade, 0..1.
  bool awaitRelease_ = false;  ///< After force off: the enable must be let go first.
  std::uint32_t free_ = 0;     ///< Ticks without contact, up to freeTicks.
  std::uint32_t over_ = 0;     ///< Ticks that the demand was above continuous, less those below.
  Wrench last_;
};

}  // namespace palpate
