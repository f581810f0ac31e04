#pragma once
/// Decides at which level of the ladder the next step is made, from how long steps took.
///
/// Down within a few steps, several levels at once where the measured times say so; up one level at
/// a time, after a wait in which steps would have fitted at the finer level too. What a level would
/// take is predicted as its time on the ladder, scaled by how the present level's measured time
/// compares with its own: four times too many contacts are four times the time at every level.
/// Where a level has to be left again soon after it was tried, its next trial has to be waited for
/// twice as long, so that a load on the border, or one that comes and goes, does not make it hunt.
/// A trial that lasts takes the waits for that level and coarser ones back to the least.
///
/// Pure: no clock, no threads; equal times give equal answers. Real-time safe. What it decides is
/// applied as a Command, so that a session replays whatever the clock was.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/simulation/governor_ladder.h"

namespace palpate {

struct GovernorSettings {
  /// Of the step's period; what is left is for the servo, and for what the machine does besides.
  double headroom = 0.5;
  double leastWait = 0.5;  ///< s of fitting steps before a level up.
  double mostWait = 32.0;  ///< s
  double trial = 5.0;      ///< s, or the wait where it is longer: how long a trial lasts.
};

class Governor {
 public:
  /// @param levels  of withLevels(): finest first, their times positive and falling; 1 to
  /// kMostLevels of them. @param stepPeriod  s, as declared.
  Governor(std::span<const GovernorLevel> levels, double stepPeriod,
           const GovernorSettings& settings = {}) noexcept;

  /// After each step at the present level: what it took, and how long it lasted, s. Returns the
  /// level for the next step. A time that is not a number, or negative, says nothing.
  [[nodiscard]] std::size_t after(double step_us, double stepLength) noexcept;
  /// Somebody else chose the level.
  void moveTo(std::size_t level) noexcept;

  [[nodiscard]] std::size_t level() const noexcept { return level_; }
  [[nodiscard]] double budget_us() const noexcept { return budget_us_; }
  /// s of fitting steps before that level is tried.
  [[nodiscard]] double waitFor(std::size_t level) const noexcept { return wait_[level]; }

 private:
  // Three of eight: a single late step, or two, is the machine's hiccup and no load of ours.
  static constexpr std::size_t kRecent = 8, kOver = 3;
  void note(double step_us, double stepLength) noexcept;
  [[nodiscard]] std::size_t levelThatFits() const noexcept;
  void down(std::size_t level) noexcept;
  void up() noexcept;
  void startAnew() noexcept;
  [[nodiscard]] double mayBeUnfit() const noexcept;

  std::array<double, kMostLevels> predicted_us_{};
  std::size_t levels_;
  double period_, budget_us_;
  GovernorSettings settings_;
  std::size_t level_ = 0;
  std::array<double, kRecent> recent_{};  ///< µs, the last steps at this level, a ring.
  std::size_t next_ = 0;
  double late_ = 0.0;                       ///< Steps over the budget, less those that may be.
  double calm_ = 0.0;                       ///< s that steps would have fitted at the finer level.
  double unfit_ = 0.0;                      ///< Steps that would not have, in that time.
  bool trying_ = false;                     ///< Lately up; down again would be a failed trial.
  double tried_ = 0.0;                      ///< s, of the trial.
  std::array<double, kMostLevels> wait_{};  ///< s, before each level is tried.
};

}  // namespace palpate
