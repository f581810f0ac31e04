#include "app/setting_report.h"

#include <array>
#include <cstdio>

#include "core/geometry/units.h"

namespace palpate {

using nlohmann::ordered_json;

ordered_json bytesJson(const TreeStats& stats) {
  return {{"topology", stats.topologyBytes},
          {"payload", stats.payloadBytes},
          {"total", stats.topologyBytes + stats.payloadBytes}};
}

ordered_json timingJson(const Timing& timing) {
  return {{"p50", timing.p50}, {"p99", timing.p99}, {"p999", timing.p999}, {"max", timing.max}};
}

const char* leafName(LeafModel leaf) noexcept {
  return leaf == LeafModel::Voxel ? "voxel" : "distance";
}

const char* methodName(QueryMethod method) noexcept {
  switch (method) {
    case QueryMethod::Hierarchy:
      return "hierarchy";
    case QueryMethod::Paper:
      return "paper";
    case QueryMethod::BruteForce:
      return "brute-force";
  }
  return "hierarchy";
}

ordered_json settingJson(const SimulationSetting& setting) {
  ordered_json json;
  json["branching"] = static_cast<int>(setting.tree.branching);
  json["leaf"] = leafName(setting.tree.leaf);
  json["surface_only"] = setting.tree.surfaceOnly;
  json["method"] = methodName(setting.query.method);
  json["tight_spheres"] = setting.query.tightSpheres;
  json["one_child_skip"] = setting.query.oneChildSkip;
  json["side_offset"] = setting.query.sideOffset;
  json["stop_level"] = setting.query.stopLevel;
  json["contact_budget"] = setting.query.contactBudget;
  json["perceptual_mm"] = millimetres(setting.query.perceptualBound);
  json["shell_spacing_mm"] = millimetres(setting.shellSpacing);
  json["step_period_ms"] = setting.stepPeriod * 1e3;
  json["contact_capacity"] = setting.contactCapacity;
  json["solver_iterations"] = setting.solverIterations;
  json["friction"] = setting.friction;
  return json;
}

std::string hashText(std::uint64_t hash) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

}  // namespace palpate
