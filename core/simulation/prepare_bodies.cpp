#include "core/simulation/prepare_bodies.h"

#include <algorithm>
#include <utility>

#include "core/collision/voxel_body_shell.h"
#include "core/simulation/loose_parts.h"

namespace palpate {
namespace {

const LabelInfo* rowOf(const LabelTable& table, const std::string& name) {
  const auto row = std::find_if(table.begin(), table.end(),
                                [&name](const LabelInfo& label) { return label.name == name; });
  return row == table.end() ? nullptr : &*row;
}

std::string labelNames(const LabelTable& table) {
  std::string names;
  for (const auto& label : table) names += (names.empty() ? "" : ", ") + label.name;
  return names.empty() ? "none" : names;
}

Error bodyError(const std::string& message, const SceneBody& body) {
  return inputRefused(message).inField("body." + body.label);
}

Result<PreparedBody> prepareBody(const PreparedScene& prepared, const LabelInfo& label,
                                 LabelGrid voxels) {
  PreparedBody body;
  body.name = label.name;
  body.label = label.value;
  body.voxels = std::make_shared<const LabelGrid>(std::move(voxels));
  const std::uint8_t values[] = {label.value};
  auto tree = VoxelTree::build(*body.voxels, values, prepared.scene.setting.tree);
  if (!tree) return fail(tree.error());
  body.tree = std::make_shared<const VoxelTree>(std::move(*tree));
  auto shell = shellOfVoxelBody(*body.voxels);
  if (!shell) return fail(shell.error());
  body.shell = std::make_shared<const PointShell>(std::move(*shell));
  const Material& material = prepared.materialOf[label.value];
  const auto mass = massPropertiesOf(*body.voxels, material.density_kgPerM3);
  if (!mass) return fail(mass.error());
  body.massProperties = *mass;
  body.surface = surfaceOf(prepared, material.name);
  return body;
}

}  // namespace

Result<FeltLabels> bodyLabels(const Scene& scene, const LabelTable& table) {
  FeltLabels moves{};
  for (const SceneBody& body : scene.bodies) {
    const LabelInfo* row = rowOf(table, body.label);
    if (row == nullptr) {
      return fail(bodyError("A loose body is of a label that the case does not have.", body)
                      .butFound(body.label)
                      .wants("one of: " + labelNames(table))
                      .advise("Segment that label, or name another in the scene."));
    }
    moves[row->value] = true;
  }
  return moves;
}

SurfaceTable surfaceOf(const PreparedScene& prepared, const std::string& material) {
  SurfaceTable table;
  for (const LabelInfo& label : prepared.table) {
    const MaterialPair pair = pairOf(prepared.materials, material, label.material);
    table[label.value] = {pair.friction, pair.restitution};
  }
  return table;
}

Result<void> prepareBodies(PreparedScene& prepared, const Progress& progress) {
  for (const SceneBody& body : prepared.scene.bodies) {
    const LabelInfo& label = *rowOf(prepared.table, body.label);
    std::vector<LabelGrid> parts = looseParts(*prepared.labels, label.value, body);
    if (parts.empty()) {
      return fail(
          bodyError("A loose body has no voxel, or none of its parts is large enough.", body)
              .wants("a part of at least " + std::to_string(body.leastVolume_mm3) + " mm3")
              .advise("Segment that label, or lower least_volume_mm3."));
    }
    if (prepared.bodies.size() + parts.size() > kMostBodies) {
      return fail(bodyError("There are too many loose bodies.", body)
                      .butFound(std::to_string(prepared.bodies.size() + parts.size()) + " parts")
                      .wants("at most " + std::to_string(kMostBodies))
                      .advise("Raise least_volume_mm3, or set separate = false."));
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (progress.cancelled()) return fail(cancelled());
      progress(static_cast<double>(i) / static_cast<double>(parts.size()),
               "Preparing loose bodies");
      auto made = prepareBody(prepared, label, std::move(parts[i]));
      if (!made) return fail(made.error());
      if (parts.size() > 1) made->name.append(" ").append(std::to_string(i + 1));
      prepared.bodies.push_back(std::move(*made));
    }
  }
  return {};
}

}  // namespace palpate
