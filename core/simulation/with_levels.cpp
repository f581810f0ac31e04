#include <cmath>

#include "core/simulation/plan.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {
namespace {

Error refused(const std::string& field, const std::string& found, const std::string& wants) {
  return inputRefused("The levels for the governor are no ladder.")
      .inField(field)
      .butFound(found)
      .wants(wants)
      .advise("Measure them again: palpate tradeoff.");
}

bool isOwn(const SimulationSetting& own, const GovernorLevel& level) {
  return level.perceptualBound == own.query.perceptualBound &&
         level.contactBudget == own.query.contactBudget && level.stopLevel == own.query.stopLevel &&
         level.solverIterations == own.solverIterations;
}

bool isLevel(const GovernorLevel& level) {
  const auto number = [](double value) { return std::isfinite(value) && value >= 0.0; };
  return number(level.perceptualBound) && level.contactBudget > 0 && level.stopLevel >= 0 &&
         level.solverIterations > 0 && number(level.stepP99_us) && level.stepP99_us > 0.0 &&
         number(level.forceErrorP95_N) && number(level.depthErrorP95_mm);
}

Result<void> checkLadder(const SimulationSetting& own, const std::vector<GovernorLevel>& levels) {
  if (levels.size() > kMostLevels) {
    return fail(
        refused("levels", std::to_string(levels.size()), "at most " + std::to_string(kMostLevels)));
  }
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string field = "levels." + std::to_string(i);
    const GovernorLevel& level = levels[i];
    if (!isLevel(level)) return fail(refused(field, level.name, "finite numbers in their ranges"));
    if (i == 0) {
      if (!isOwn(own, level)) return fail(refused(field, level.name, "the scene's own setting"));
      continue;
    }
    const GovernorLevel& before = levels[i - 1];
    if (!(level.stepP99_us < before.stepP99_us)) {
      return fail(refused(field + ".step_p99_us", std::to_string(level.stepP99_us),
                          "less than " + std::to_string(before.stepP99_us)));
    }
    if (level.forceErrorP95_N < before.forceErrorP95_N) {
      return fail(refused(field + ".force_error_p95_N", std::to_string(level.forceErrorP95_N),
                          "at least " + std::to_string(before.forceErrorP95_N)));
    }
  }
  return {};
}

}  // namespace

Result<std::shared_ptr<const PreparedScene>> withLevels(const PreparedScene& prepared,
                                                        std::vector<GovernorLevel> levels) {
  if (auto checked = checkLadder(prepared.scene.setting, levels); !checked) {
    return fail(checked.error());
  }
  auto governed = std::make_shared<PreparedScene>(prepared);
  governed->levels = std::move(levels);
  for (PlanRow& row : governed->plan) {
    if (row.what == kGovernorRow) row = governorRow(*governed);
  }
  return std::shared_ptr<const PreparedScene>(std::move(governed));
}

}  // namespace palpate
