#include "core/simulation/governor_ladder.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// A level that saves less is not worth a change of what is felt.
constexpr double kLeastGain = 0.9;

GovernorLevel levelOf(const MeasuredSetting& m) {
  return {m.name,
          m.setting.query.perceptualBound,
          m.setting.query.contactBudget,
          m.setting.query.stopLevel,
          m.setting.solverIterations,
          m.stepP99_us,
          m.forceErrorP95_N,
          m.depthErrorP95_mm};
}

/// All that a running simulation cannot change is the same.
bool sameButForTheLevel(const SimulationSetting& a, const SimulationSetting& b) {
  return a.tree.branching == b.tree.branching && a.tree.leaf == b.tree.leaf &&
         a.tree.surfaceOnly == b.tree.surfaceOnly && a.query.method == b.query.method &&
         a.query.tightSpheres == b.query.tightSpheres &&
         a.query.oneChildSkip == b.query.oneChildSkip && a.query.sideOffset == b.query.sideOffset &&
         a.query.threads == b.query.threads && a.query.coherence == b.query.coherence &&
         a.shellSpacing == b.shellSpacing && a.stepPeriod == b.stepPeriod &&
         a.contactCapacity == b.contactCapacity && a.friction == b.friction &&
         a.couplingShare == b.couplingShare;
}

bool sameLevel(const SimulationSetting& a, const SimulationSetting& b) {
  return a.query.perceptualBound == b.query.perceptualBound &&
         a.query.contactBudget == b.query.contactBudget && a.query.stopLevel == b.query.stopLevel &&
         a.solverIterations == b.solverIterations;
}

bool usable(const MeasuredSetting& m) {
  return std::isfinite(m.stepP99_us) && m.stepP99_us > 0.0 && std::isfinite(m.forceErrorP95_N) &&
         std::isfinite(m.depthErrorP95_mm);
}

/// Takes out the level whose going leaves the smallest step in time, never the first or the last.
void thin(std::vector<GovernorLevel>& ladder) {
  while (ladder.size() > kMostLevels) {
    std::size_t least = 1;
    double leastStep = 0.0;
    for (std::size_t i = 1; i + 1 < ladder.size(); ++i) {
      const double step = ladder[i - 1].stepP99_us / ladder[i + 1].stepP99_us;
      if (i > 1 && step >= leastStep) continue;
      least = i;
      leastStep = step;
    }
    ladder.erase(ladder.begin() + static_cast<std::ptrdiff_t>(least));
  }
}

}  // namespace

SimulationSetting settingAt(SimulationSetting own, const GovernorLevel& level) {
  own.query.perceptualBound = level.perceptualBound;
  own.query.contactBudget = level.contactBudget;
  own.query.stopLevel = level.stopLevel;
  own.solverIterations = level.solverIterations;
  return own;
}

std::vector<GovernorLevel> ladderOf(const SimulationSetting& own,
                                    std::span<const MeasuredSetting> measured) {
  std::vector<GovernorLevel> ladder, others;
  for (const MeasuredSetting& m : measured) {
    if (!usable(m) || !sameButForTheLevel(own, m.setting)) continue;
    if (!sameLevel(own, m.setting)) {
      others.push_back(levelOf(m));
    } else if (ladder.empty()) {
      ladder.push_back(levelOf(m));
    }
  }
  if (ladder.empty()) return {};
  std::sort(others.begin(), others.end(), [](const GovernorLevel& a, const GovernorLevel& b) {
    return a.forceErrorP95_N != b.forceErrorP95_N ? a.forceErrorP95_N < b.forceErrorP95_N
                                                  : a.stepP99_us < b.stepP99_us;
  });
  for (GovernorLevel& level : others) {
    const GovernorLevel& before = ladder.back();
    if (level.stepP99_us > kLeastGain * before.stepP99_us) continue;
    // What a coarser level gained by chance is not promised.
    level.forceErrorP95_N = std::max(level.forceErrorP95_N, before.forceErrorP95_N);
    level.depthErrorP95_mm = std::max(level.depthErrorP95_mm, before.depthErrorP95_mm);
    ladder.push_back(level);
  }
  if (ladder.size() < 2) return {};
  thin(ladder);
  return ladder;
}

}  // namespace palpate
