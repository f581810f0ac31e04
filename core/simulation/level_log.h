#pragma once
/// What a run did on the scene's levels: changes, and time at each.

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/simulation/runner.h"

namespace palpate {

/// What the simulation loop tells others, where the scene has levels. Plain data.
struct LevelFigures {
  double budget_us = 0.0;  ///< 0: not governed.
  std::uint64_t stepsOver = 0, changeCount = 0;
  std::uint32_t level = 0, levels = 0;
  std::array<double, kMostLevels> secondsAt{};
  std::array<LevelChange, kChangesKept> change{};  ///< A ring.
};
static_assert(std::is_trivially_copyable_v<LevelFigures>);

/// Simulation thread only. Real-time safe.
class LevelLog {
 public:
  LevelLog(std::size_t levels, double budget_us) noexcept;
  void changed(std::uint64_t step, std::uint64_t tick, std::size_t to) noexcept;
  /// @param step_us  as the governor is told.
  void step(const StepRecord& record, double step_us) noexcept;
  [[nodiscard]] const LevelFigures& figures() const noexcept { return figures_; }

 private:
  LevelFigures figures_;
  double last_us_ = 0.0;
};

[[nodiscard]] GovernorReport reportOf(const LevelFigures& figures);

}  // namespace palpate
