#include "app/run_report.h"

#include "app/setting_report.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

/// Up to the last bin that holds anything; an upper bound of null: none.
ordered_json binsJson(const DurationBins& bins) {
  ordered_json list = ordered_json::array();
  std::size_t used = 0;
  for (std::size_t i = 0; i < bins.count.size(); ++i) {
    if (bins.count[i] > 0) used = i + 1;
  }
  for (std::size_t i = 0; i < used; ++i) {
    const bool last = i == DurationBins::kEnds.size();
    list.push_back({{"from_us", i == 0 ? 0.0 : DurationBins::kEnds[i - 1]},
                    {"to_us", last ? ordered_json(nullptr) : ordered_json(DurationBins::kEnds[i])},
                    {"count", bins.count[i]}});
  }
  return list;
}

/// Null where the scene has no levels.
ordered_json governorJson(const RunReport& report, const PreparedScene& scene) {
  if (!report.governor) return nullptr;
  const GovernorReport& found = *report.governor;
  ordered_json json;
  json["governed"] = found.governed;
  json["budget_us"] = found.governed ? ordered_json(found.budget_us) : ordered_json(nullptr);
  json["steps_over"] = found.stepsOver;
  json["level"] = found.level;
  json["levels"] = ordered_json::array();
  for (std::size_t i = 0; i < found.secondsAt.size(); ++i) {
    const GovernorLevel& level = scene.levels[i];
    json["levels"].push_back({{"name", level.name},
                              {"step_p99_us", level.stepP99_us},
                              {"force_error_p95_N", level.forceErrorP95_N},
                              {"depth_error_p95_mm", level.depthErrorP95_mm},
                              {"seconds", found.secondsAt[i]}});
  }
  json["change_count"] = found.changeCount;
  json["changes"] = ordered_json::array();
  for (const LevelChange& change : found.changes) {
    json["changes"].push_back({{"step", change.step},
                               {"tick", change.tick},
                               {"from", change.from},
                               {"to", change.to},
                               {"step_us", change.step_us}});
  }
  return json;
}

}  // namespace

ordered_json runReportJson(const RunReport& report, const PreparedScene& scene) {
  ordered_json json;
  json["clock"] = report.clock == Clock::Virtual ? "virtual" : "real";
  json["seed"] = report.seed;
  json["steps"] = report.steps;
  json["ticks"] = report.ticks;
  json["step_us"] = timingJson(report.stepTime);
  json["tick_us"] = timingJson(report.tickTime);
  json["lateness_us"] = timingJson(report.lateness);
  json["ticks_late"] = report.ticksLate;
  json["ticks_missed"] = report.ticksMissed;
  json["contacts_max"] = report.contactsMax;
  json["force_max_N"] = report.forceMax;
  json["torque_max_Nm"] = report.torqueMax;
  json["penetration_max_mm"] = millimetres(report.penetrationMax);
  json["hand_energy_J"] = report.handEnergy;
  json["hand_energy_min_J"] = report.handEnergyMin;
  json["recorder_drops"] = report.recorderDrops;
  json["step_histogram"] = binsJson(report.stepBins);
  json["tick_histogram"] = binsJson(report.tickBins);
  json["lateness_histogram"] = binsJson(report.latenessBins);
  json["real_time"] = report.realTimePriority;
  json["servo_cpu"] = report.servoCpu >= 0 ? ordered_json(report.servoCpu) : ordered_json(nullptr);
  json["state_hash"] = hashText(report.stateHash);
  json["governor"] = governorJson(report, scene);
  json["setting"] = settingJson(scene.scene.setting);
  json["setting"]["instrument"] = scene.scene.instrument;
  json["setting"]["device"] = scene.scene.device;
  return json;
}

}  // namespace palpate
