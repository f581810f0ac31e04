#include <algorithm>
#include <span>

#include "core/base/progress_part.h"
#include "core/geometry/units.h"
#include "core/simulation/approach.h"
#include "core/simulation/fingerprint.h"
#include "core/simulation/plan.h"
#include "core/simulation/prepare_bodies.h"
#include "core/simulation/prepared_scene.h"
#include "core/simulation/reach.h"
#include "core/voxels/tree_cache.h"

namespace palpate {
namespace {

std::string labelNames(const LabelTable& table) {
  std::string names;
  for (const auto& label : table) names += (names.empty() ? "" : ", ") + label.name;
  return names.empty() ? "none" : names;
}

Result<void> checkGrid(const LabelGrid& grid) {
  if (grid.geometry.voxelCount() == 0 || grid.labels.size() != grid.geometry.voxelCount()) {
    return fail(inputRefused("The labels do not fill their grid.")
                    .inField("labels")
                    .butFound(std::to_string(grid.labels.size()) + " voxels")
                    .wants(std::to_string(grid.geometry.voxelCount()) + " voxels"));
  }
  return {};
}

/// The values of what stands still; all that are not background where the scene names none. Labels
/// of loose bodies are not among them.
Result<FeltLabels> anatomyLabels(const Scene& scene, const LabelTable& table) {
  FeltLabels felt{};
  const auto moves = bodyLabels(scene, table);
  if (!moves) return fail(moves.error());
  if (scene.labels.empty()) {
    for (std::size_t value = 1; value < felt.size(); ++value) felt[value] = !(*moves)[value];
    return felt;
  }
  for (const std::string& name : scene.labels) {
    const auto row = std::find_if(table.begin(), table.end(),
                                  [&name](const LabelInfo& label) { return label.name == name; });
    if (row == table.end()) {
      return fail(inputRefused("The scene names a label that the case does not have.")
                      .inField("labels")
                      .butFound(name)
                      .wants("one of: " + labelNames(table))
                      .advise("Segment that label, or name another in the scene."));
    }
    felt[row->value] = !(*moves)[row->value];
  }
  return felt;
}

/// What stands still and what moves.
FeltLabels withBodies(FeltLabels felt, const FeltLabels& moves) {
  for (std::size_t value = 0; value < felt.size(); ++value) felt[value] |= moves[value];
  return felt;
}

/// The felt values that occur. Refuses when none does.
Result<std::vector<std::uint8_t>> presentLabels(const Scene& scene, const LabelGrid& grid,
                                                const FeltLabels& felt) {
  std::array<bool, 256> present{};
  for (const std::uint8_t label : grid.labels) present[label] = true;
  std::vector<std::uint8_t> values;
  bool any = false;
  for (std::size_t value = 1; value < present.size(); ++value) {
    any = any || present[value];
    if (present[value] && felt[value]) values.push_back(static_cast<std::uint8_t>(value));
  }
  if (!any) {
    return fail(inputRefused("Nothing in the case is labelled.")
                    .advise("Segment it first: palpate segment CASE --preset ct-bone."));
  }
  if (values.empty()) {
    std::string names;
    for (const auto& name : scene.labels) names += (names.empty() ? "" : ", ") + name;
    return fail(inputRefused("None of the scene's labels has a voxel.")
                    .inField("labels")
                    .butFound(names)
                    .advise("Segment that label, or name another in the scene."));
  }
  return values;
}

Result<void> assignMaterials(PreparedScene& prepared, const FeltLabels& felt) {
  for (const LabelInfo& label : prepared.table) {
    if (!felt[label.value]) continue;
    const auto material =
        std::find_if(prepared.materials.begin(), prepared.materials.end(),
                     [&label](const Material& m) { return m.name == label.material; });
    if (material == prepared.materials.end()) {
      std::string names;
      for (const auto& m : prepared.materials) names += (names.empty() ? "" : ", ") + m.name;
      return fail(inputRefused("A label has a material that is not known.")
                      .inField("labels." + label.name + ".material")
                      .butFound(label.material)
                      .wants("one of: " + names)
                      .advise("Correct labels.toml, or add the material to materials.toml."));
    }
    prepared.materialOf[label.value] = *material;
  }
  return {};
}

/// Refuses a region that holds nothing of what there is.
Result<void> checkRegion(const LabelGrid& inside, const FeltLabels& felt,
                         const ReachSaving& saving) {
  const bool any = std::any_of(inside.labels.begin(), inside.labels.end(),
                               [&felt](std::uint8_t label) { return felt[label]; });
  if (any || saving.outsideRegion == 0) return {};
  return fail(inputRefused("No voxel of the scene's labels lies in its region.")
                  .inField("region")
                  .butFound(std::to_string(saving.outsideRegion) + " voxels outside")
                  .wants("a box in mm, patient axes, that holds some of them")
                  .advise("Correct the region, or remove it from the scene."));
}

}  // namespace

Result<std::shared_ptr<const PreparedScene>> prepareScene(
    const Scene& scene, std::shared_ptr<const LabelGrid> labels, const LabelTable& table,
    const std::vector<Material>& materials, const Instrument& instrument, const Progress& progress,
    const std::filesystem::path& treeCache) {
  if (auto checked = checkGrid(*labels); !checked) return fail(checked.error());
  const auto anatomy = anatomyLabels(scene, table);
  if (!anatomy) return fail(anatomy.error());
  const FeltLabels moves = *bodyLabels(scene, table);
  const FeltLabels felt = withBodies(*anatomy, moves);
  ReachSaving saving;
  const auto whole = labels;
  labels = withinRegion(labels, scene.region, felt, saving);
  if (auto checked = checkRegion(*labels, felt, saving); !checked) return fail(checked.error());
  const auto values = presentLabels(scene, *labels, *anatomy);
  if (!values) return fail(values.error());

  auto prepared = std::make_shared<PreparedScene>();
  prepared->scene = scene;
  prepared->instrument = instrument;
  prepared->labels = std::move(labels);
  if (saving.outsideRegion > 0) prepared->wholeLabels = whole;
  prepared->table = table;
  prepared->materials = materials;
  if (auto assigned = assignMaterials(*prepared, felt); !assigned) return fail(assigned.error());
  prepared->instrumentSurface = surfaceOf(*prepared, instrument.material);

  const double spacing =
      scene.setting.shellSpacing > 0.0 ? scene.setting.shellSpacing : instrument.shellSpacing;
  auto shell = PointShell::fromMesh(instrument.mesh_T, spacing);
  if (!shell) return fail(shell.error());
  prepared->shell = std::make_shared<const PointShell>(std::move(*shell));

  progress(0.05, "Placing the device");
  prepared->X_WV = prepared->labels->geometry.X_PV;  // W = P
  bool approachIsClear = true;
  if (scene.X_WD) {
    prepared->X_WD = *scene.X_WD;
  } else {
    const auto approach = planApproach(*prepared->labels, *anatomy);
    if (!approach) return fail(approach.error());
    prepared->X_WD = approach->X_PD;
    approachIsClear = approach->clear;
  }

  progress(0.1, "Looking for what cannot be reached");
  const ReachableAnatomy reachable = reachableAnatomy(scene, prepared->labels, *anatomy, moves,
                                                      *prepared->shell, prepared->X_WD, saving);
  prepared->saving = reachable.saving;
  prepared->reachLimit = reachable.limit;
  const bool any = std::any_of(reachable.labels->labels.begin(), reachable.labels->labels.end(),
                               [&anatomy](std::uint8_t label) { return (*anatomy)[label]; });
  if (!any) {
    return fail(inputRefused("The device reaches no voxel of the scene's labels.")
                    .inField("device_pose")
                    .advise("Place the device at the anatomy, or ask for reach = \"sealed\"."));
  }
  if (progress.cancelled()) return fail(cancelled());

  auto tree = openOrBuildTree(*reachable.labels, *values, scene.setting.tree, treeCache,
                              shareOf(progress, 0.2, 0.8));
  if (!tree) return fail(tree.error());
  prepared->tree = std::make_shared<const VoxelTree>(std::move(*tree));
  if (progress.cancelled()) return fail(cancelled());

  if (auto bodies = prepareBodies(*prepared, shareOf(progress, 0.8, 0.95)); !bodies) {
    return fail(bodies.error());
  }
  prepared->fingerprint = fingerprintOf(*prepared, felt);
  prepared->plan = planOf(*prepared, *values, spacing, approachIsClear);
  progress(1.0, "Ready");
  return std::shared_ptr<const PreparedScene>(std::move(prepared));
}

FeltLabels feltLabelsOf(const PreparedScene& prepared) {
  // The names were checked when the scene was prepared.
  return withBodies(*anatomyLabels(prepared.scene, prepared.table),
                    *bodyLabels(prepared.scene, prepared.table));
}

}  // namespace palpate
