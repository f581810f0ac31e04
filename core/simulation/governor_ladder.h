#pragma once
/// What the governor may step down to: the settings along the measured front that a running
/// simulation can change to, finest first.
///
/// A level is the scene's own setting with another perceptual bound, contact budget, level where
/// descent stops, or number of impulses. A simulation at level k makes the bits of a scene that was
/// prepared with that level's setting. Trees, shells and exact options stay as they are: they
/// cannot change without memory or time that a step does not have.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace palpate {

/// Plain but for its name. What was predicted comes from a sweep over the scene (core/trade).
struct GovernorLevel {
  std::string name;
  double perceptualBound = 0.0;  ///< m; these three as in QueryOptions
  std::uint32_t contactBudget = 0xFFFFFFFF;
  int stopLevel = 0;
  std::uint32_t solverIterations = 200;
  double stepP99_us = 0.0;  ///< On the sweep's trajectory.
  /// Against the sweep's reference, p95 over its trajectory: the coupling's force on the device,
  /// and the deepest contact.
  double forceErrorP95_N = 0.0, depthErrorP95_mm = 0.0;
};

/// A contact finder of each level is kept for each pair that may touch.
inline constexpr std::size_t kMostLevels = 8;

/// A setting and what a sweep found of it.
struct MeasuredSetting {
  std::string name;
  SimulationSetting setting;
  double stepP99_us = 0.0, forceErrorP95_N = 0.0, depthErrorP95_mm = 0.0;
};

/// The scene's setting at that level.
[[nodiscard]] SimulationSetting settingAt(SimulationSetting own, const GovernorLevel& level);

/// The ladder for a scene of setting `own`: that setting first, then those of `measured` that
/// differ from it in nothing but what may change at run time and lie on the front, each faster and
/// no more accurate than the one before. Levels that would save less than a tenth are left out, and
/// those nearest to their neighbours where there are more than kMostLevels. Fewer than two levels
/// are no ladder: empty, also where `own` was not measured. Numbers that are not finite, times of
/// zero and less, are left out.
[[nodiscard]] std::vector<GovernorLevel> ladderOf(const SimulationSetting& own,
                                                  std::span<const MeasuredSetting> measured);

}  // namespace palpate
