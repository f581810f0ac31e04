#include "core/simulation/level_log.h"

#include <algorithm>

namespace palpate {

LevelLog::LevelLog(std::size_t levels, double budget_us) noexcept {
  figures_.levels = static_cast<std::uint32_t>(std::min(levels, kMostLevels));
  figures_.budget_us = budget_us;
}

void LevelLog::changed(std::uint64_t step, std::uint64_t tick, std::size_t to) noexcept {
  const auto level = static_cast<std::uint32_t>(to);
  figures_.change[figures_.changeCount % kChangesKept] = {step, tick, figures_.level, level,
                                                          last_us_};
  ++figures_.changeCount;
  figures_.level = level;
}

void LevelLog::step(const StepRecord& record, double step_us) noexcept {
  last_us_ = step_us;
  if (figures_.budget_us > 0.0 && step_us > figures_.budget_us) ++figures_.stepsOver;
  figures_.secondsAt[figures_.level] += record.h;
}

GovernorReport reportOf(const LevelFigures& figures) {
  GovernorReport report;
  report.governed = figures.budget_us > 0.0;
  report.budget_us = figures.budget_us;
  report.stepsOver = figures.stepsOver;
  report.level = figures.level;
  report.changeCount = figures.changeCount;
  const std::uint64_t kept = std::min<std::uint64_t>(figures.changeCount, kChangesKept);
  for (std::uint64_t i = figures.changeCount - kept; i < figures.changeCount; ++i) {
    report.changes.push_back(figures.change[i % kChangesKept]);
  }
  report.secondsAt.assign(figures.secondsAt.begin(), figures.secondsAt.begin() + figures.levels);
  return report;
}

}  // namespace palpate
