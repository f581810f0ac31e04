#pragma once
/// The trade between speed and accuracy: a sweep over settings, the front, the choice.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// One setting and what it cost and erred, over the same trajectory as the reference
/// (brute force over every point, distance leaves, finest shell).
struct TradePoint {
  std::string name;  ///< "default", "branching=8", "shell=1.0mm", ...
  SimulationSetting setting;
  double depthErrorP95_mm = 0, normalErrorP95_deg = 0, forceErrorP95_N = 0;
  std::uint64_t contactsMissed = 0, contactsExtra = 0;
  double stepP50_us = 0, stepP99_us = 0, stepP999_us = 0;
  std::size_t bytes = 0;
  bool onFront = false;
};

/// Runs a recorded approach-and-slide trajectory over each setting. Deterministic but for times.
[[nodiscard]] Result<std::vector<TradePoint>> sweepTrade(const PreparedScene& base,
                                                         std::uint64_t seed,
                                                         const Progress& progress = {});

/// The setting of lowest p95 force error whose p99.9 fits headroom · deadline; refuses if none
/// fits.
[[nodiscard]] Result<TradePoint> chooseSetting(const std::vector<TradePoint>& points,
                                               double deadline_s, double headroom);

}  // namespace palpate
