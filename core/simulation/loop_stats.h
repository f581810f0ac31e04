#pragma once
/// What each of the two loops measures of itself, and the report made of both.

#include <cstdint>
#include <string>
#include <type_traits>

#include "core/haptics/servo_loop.h"
#include "core/simulation/histogram.h"
#include "core/simulation/runner.h"

namespace palpate {

/// What the servo loop tells others. Plain data.
struct ServoFigures {
  std::uint64_t ticks = 0, late = 0, missed = 0, drops = 0;
  Timing tickTime, lateness;  ///< Whole run.
  Timing lastSecond;          ///< Of tickTime.
  DurationBins tickBins, latenessBins;
  double forceMax = 0, torqueMax = 0, handEnergy = 0, handEnergyMin = 0;
};
static_assert(std::is_trivially_copyable_v<ServoFigures>);

/// What the simulation loop tells others. Plain data.
struct StepFigures {
  std::uint64_t steps = 0, drops = 0, stateHash = 0;
  Timing stepTime, lastSecond;
  DurationBins stepBins;
  std::uint32_t contactsMax = 0;
  double penetrationMax = 0;
};
static_assert(std::is_trivially_copyable_v<StepFigures>);

/// Servo thread only. Real-time safe.
class ServoStats {
 public:
  void tick(const ServoSample& sample, std::int64_t nanoseconds) noexcept;
  /// A wake-up that was due `nanoseconds` ago; later than 100 µs counts as late.
  void woke(std::int64_t nanoseconds) noexcept;
  void missed(std::uint64_t periods) noexcept { figures_.missed += periods; }
  void dropped() noexcept { ++figures_.drops; }
  /// True once every `window` ticks: lastSecond is new.
  [[nodiscard]] bool windowEnded(std::uint64_t window) noexcept;
  [[nodiscard]] ServoFigures figures() const noexcept;

 private:
  ServoFigures figures_;
  Histogram tick_, lateness_, second_;
};

/// Simulation thread only. Real-time safe.
class StepStats {
 public:
  void step(const StepRecord& record) noexcept;
  void dropped() noexcept { ++figures_.drops; }
  [[nodiscard]] bool windowEnded(std::uint64_t window) noexcept;
  [[nodiscard]] StepFigures figures() const noexcept;
  [[nodiscard]] const Timing& lastSecond() const noexcept { return figures_.lastSecond; }

 private:
  StepFigures figures_;
  Histogram step_, second_;
};

[[nodiscard]] RunReport reportOf(const RunOptions& options, const ServoFigures& servo,
                                 const StepFigures& step);

}  // namespace palpate
