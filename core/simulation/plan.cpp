#include "core/simulation/plan.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/base/short_number.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

std::string nameOf(const LabelTable& table, std::uint8_t value) {
  for (const auto& label : table) {
    if (label.value == value) return label.name;
  }
  return "label " + std::to_string(value);
}

void addLabels(const PreparedScene& prepared, const std::vector<std::uint8_t>& feltValues,
               std::vector<PlanRow>& plan) {
  std::array<std::size_t, 256> voxels{};
  for (const std::uint8_t label : prepared.labels->labels) ++voxels[label];
  for (const std::uint8_t value : feltValues) {
    plan.push_back({"label " + nameOf(prepared.table, value), true,
                    std::to_string(voxels[value]) + " voxels, rigid, friction " +
                        formatted("%.2f", prepared.materialOf[value].friction),
                    0});
  }
  for (const auto& label : prepared.table) {
    if (std::find(feltValues.begin(), feltValues.end(), label.value) != feltValues.end()) continue;
    const auto& bodies = prepared.bodies;
    const bool moves = std::any_of(bodies.begin(), bodies.end(), [&label](const PreparedBody& b) {
      return b.label == label.value;
    });
    if (moves) continue;  // it has rows of its own
    plan.push_back({"label " + label.name, false,
                    voxels[label.value] == 0 ? "it has no voxel" : "the scene does not name it",
                    0});
  }
}

std::string share(std::size_t some, std::size_t all, const char* what) {
  return std::to_string(some) + " of " + std::to_string(all) + " " + what;
}

const char* limitText(ReachLimit limit) {
  switch (limit) {
    case ReachLimit::None:
      return "";
    case ReachLimit::CutDescent:
      return "kept: where descent is cut, contacts depend on the whole tree";
    case ReachLimit::NoWorkspace:
      return "kept: the device's workspace is not known";
    case ReachLimit::LooseBodies:
      return "kept: loose bodies go where the device does not";
  }
  return "";
}

/// What the scene asks to leave out, and what of it is; what it does not ask for has no row.
void addReach(const PreparedScene& prepared, std::vector<PlanRow>& plan) {
  const ReachSaving& saving = prepared.saving;
  const ReachLimit limit = prepared.reachLimit;
  const auto leftOut = [](std::size_t voxels) {
    return std::to_string(voxels) + " labelled voxels left out";
  };
  if (prepared.scene.region) {
    plan.push_back({kRegionRow, saving.outsideRegion == 0, leftOut(saving.outsideRegion), 0});
  }
  if (prepared.scene.reach == Reach::All) return;
  std::string cavities = share(saving.cavitiesFilled, saving.cavities, "filled, ") +
                         share(saving.filledVoxels, saving.cavityVoxels, "voxels");
  if (limit == ReachLimit::CutDescent) cavities = limitText(limit);
  plan.push_back({kCavitiesRow, saving.cavitiesFilled == 0, cavities, 0});
  if (prepared.scene.reach != Reach::Device) return;
  plan.push_back({kWorkspaceRow, saving.outsideDevice == 0,
                  limit == ReachLimit::None ? leftOut(saving.outsideDevice) : limitText(limit), 0});
}

void addTree(const PreparedScene& prepared, std::vector<PlanRow>& plan) {
  const TreeStats& stats = prepared.tree->stats();
  const TreeOptions& options = prepared.scene.setting.tree;
  plan.push_back({"voxel tree", true,
                  std::to_string(static_cast<int>(options.branching)) + " children a node, " +
                      std::to_string(stats.levels) + " levels, " +
                      std::to_string(stats.surfaceVoxels) + " surface voxels",
                  stats.topologyBytes});
  plan.push_back({"depth and normals", true,
                  options.leaf == LeafModel::Distance ? "distance, trilinear between voxel centres"
                                                      : "voxel, one plane a voxel",
                  stats.payloadBytes});
}

/// What a contact query of `points` keeps, about (measured: 110 to 140 bytes a point).
constexpr std::size_t kQueryBytesAPoint = 128;

void addBodies(const PreparedScene& prepared, std::vector<PlanRow>& plan) {
  if (prepared.bodies.empty()) {
    plan.push_back({"loose bodies", false, "the scene declares none", 0});
    return;
  }
  std::size_t larger = 0;  // queries with the bodies after it, each by the smaller shell
  for (const PreparedBody& body : prepared.bodies) {
    const TreeStats& stats = body.tree->stats();
    const std::size_t points = body.shell->size();
    const std::size_t queries = 1 + larger++;
    plan.push_back(
        {"loose body " + body.name, true,
         std::to_string(points) + " surface voxels, " +
             formatted("%.2f g", 1e3 * body.massProperties.mass),
         stats.topologyBytes + stats.payloadBytes + points * queries * kQueryBytesAPoint});
  }
  const Surroundings& around = prepared.scene.surroundings;
  plan.push_back(
      {"gravity on loose bodies", around.gravity.norm() > 0.0,
       around.gravity.norm() > 0.0 ? formatted("%.2f m/s2", around.gravity.norm()) : "switched off",
       0});
  plan.push_back(
      {"drag on loose bodies", around.drag > 0.0,
       around.drag > 0.0 ? formatted("%.1f of the velocity a second", around.drag) : "switched off",
       0});
}

}  // namespace

PlanRow governorRow(const PreparedScene& prepared) {
  const std::vector<GovernorLevel>& levels = prepared.levels;
  if (levels.empty()) return {kGovernorRow, false, "no levels were measured for this scene", 0};
  std::size_t points = prepared.shell->size();  // of all queries
  std::size_t larger = 0;
  points += prepared.bodies.size() * points;
  for (const PreparedBody& body : prepared.bodies) points += body.shell->size() * (1 + larger++);
  return {kGovernorRow, true,
          std::to_string(levels.size()) + " levels, to " +
              formatted("%.2f of a step's time", levels.back().stepP99_us / levels[0].stepP99_us) +
              formatted(" and %.2f N (p95) off", levels.back().forceErrorP95_N),
          (levels.size() - 1) * points * kQueryBytesAPoint};
}

std::vector<PlanRow> planOf(const PreparedScene& prepared,
                            const std::vector<std::uint8_t>& feltValues, double shellSpacing,
                            bool approachIsClear) {
  const SimulationSetting& setting = prepared.scene.setting;
  std::vector<PlanRow> plan;
  addLabels(prepared, feltValues, plan);
  addReach(prepared, plan);
  addTree(prepared, plan);
  plan.push_back({"instrument " + prepared.instrument.name, true,
                  std::to_string(prepared.shell->size()) + " shell points at " +
                      formatted("%.2f mm, ", millimetres(shellSpacing)) +
                      formatted("%.1f g", 1e3 * prepared.instrument.massProperties.mass),
                  prepared.shell->size() * 2 * sizeof(Eigen::Vector3d)});
  addBodies(prepared, plan);
  plan.push_back(
      {"contact query", true,
       "at most " + std::to_string(setting.contactCapacity) + " contacts a step",
       setting.contactCapacity * sizeof(Contact) + prepared.shell->size() * kQueryBytesAPoint});
  plan.push_back({"contact response", true,
                  "at most " + std::to_string(setting.solverIterations) + " impulses a step", 0});
  plan.push_back(governorRow(prepared));
  plan.push_back({"friction", setting.friction,
                  setting.friction ? "Coulomb, by pairs of materials" : "switched off", 0});
  plan.push_back({"coupling and motion", true,
                  formatted("%.0f %% of the stiffness recommended for the device",
                            100.0 * setting.couplingShare),
                  0});
  plan.push_back({"device placement", true,
                  prepared.scene.X_WD ? "as the scene says"
                  : approachIsClear   ? "chosen: an even, free patch of surface"
                                      : "chosen, but no even and free patch of surface was found",
                  0});
  plan.push_back({"deformation", false, "anatomy is rigid in this version", 0});
  plan.push_back({"cutting and drilling", false, "anatomy cannot be edited in this version", 0});
  plan.push_back({"torque on the hand", false,
                  "felt only on devices with torque motors; it is always computed", 0});
  return plan;
}

}  // namespace palpate
