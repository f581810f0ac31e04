#include "core/trade/variants.h"

#include "core/simulation/fingerprint.h"
#include "core/simulation/reach.h"
#include "core/trade/coarse_labels.h"

namespace palpate {
namespace {

bool sameTree(const TreeOptions& a, const TreeOptions& b) {
  return a.branching == b.branching && a.leaf == b.leaf && a.surfaceOnly == b.surfaceOnly;
}

std::vector<std::uint8_t> valuesOf(const FeltLabels& felt) {
  std::vector<std::uint8_t> values;
  for (std::size_t value = 1; value < felt.size(); ++value) {
    if (felt[value]) values.push_back(static_cast<std::uint8_t>(value));
  }
  return values;
}

}  // namespace

Variants::Variants(const PreparedScene& base)
    : base_(base),
      felt_(valuesOf(feltLabelsOf(base))),
      reachable_(reachableAnatomy(base.scene, base.labels, feltLabelsOf(base), {}, *base.shell,
                                  base.X_WD, {})
                     .labels) {
  if (base.bodies.empty()) trees_.push_back({1, base.labels, base.tree});
  shells_.emplace_back(spacingOf(base.scene.setting), base.shell);
}

double Variants::spacingOf(const SimulationSetting& setting) const noexcept {
  return setting.shellSpacing > 0.0 ? setting.shellSpacing : base_.instrument.shellSpacing;
}

Result<std::shared_ptr<const PreparedScene>> Variants::at(const TradeSetting& setting) {
  const auto tree = treeOf(setting.simulation.tree, setting.coarsening);
  if (!tree) return fail(tree.error());
  const auto shell = shellAt(spacingOf(setting.simulation));
  if (!shell) return fail(shell.error());
  auto variant = std::make_shared<PreparedScene>(base_);
  variant->scene.setting = setting.simulation;
  variant->bodies.clear();
  variant->levels.clear();
  variant->labels = tree->labels;
  variant->X_WV = tree->labels->geometry.X_PV;
  variant->tree = tree->tree;
  variant->shell = *shell;
  return std::shared_ptr<const PreparedScene>(std::move(variant));
}

Result<std::shared_ptr<const PointShell>> Variants::shellAt(double spacing) {
  for (const auto& [known, shell] : shells_) {
    if (known == spacing) return shell;
  }
  auto shell = PointShell::fromMesh(base_.instrument.mesh_T, spacing);
  if (!shell) return fail(shell.error());
  shells_.emplace_back(spacing, std::make_shared<const PointShell>(std::move(*shell)));
  return shells_.back().second;
}

Result<Variants::Built> Variants::treeOf(const TreeOptions& options, int coarsening) {
  for (const Built& built : trees_) {
    if (built.coarsening == coarsening && sameTree(built.tree->options(), options)) return built;
  }
  Built built{coarsening, base_.labels, nullptr};
  for (const Built& other : trees_) {
    if (other.coarsening == coarsening) built.labels = other.labels;
  }
  if (coarsening > 1 && built.labels == base_.labels) {
    built.labels = std::make_shared<const LabelGrid>(coarseLabels(*reachable_, coarsening));
  }
  auto tree = VoxelTree::build(coarsening > 1 ? *built.labels : *reachable_, felt_, options);
  if (!tree) return fail(tree.error());
  built.tree = std::make_shared<const VoxelTree>(std::move(*tree));
  trees_.push_back(built);
  return built;
}

}  // namespace palpate
