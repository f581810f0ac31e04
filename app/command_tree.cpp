#include <memory>

#include "app/case_label.h"
#include "app/command.h"
#include "app/commands.h"
#include "app/setting_report.h"
#include "app/text_table.h"
#include "core/voxels/tree_cache.h"
#include "core/voxels/voxel_tree.h"
#include "imaging/case_folder.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct TreeCommandOptions {
  fs::path caseFolder;
  std::string label;
  int branching = 64;
  std::string leaf = "distance";
};

CommandOutput reportTree(const TreeStats& stats) {
  CommandOutput output;
  output.json["levels"] = stats.levels;
  output.json["nodes_per_level"] = stats.nodesPerLevel;
  output.json["surface_voxels"] = stats.surfaceVoxels;
  output.json["bytes"] = bytesJson(stats);
  output.json["build_ms"] = stats.buildMs;

  TextTable nodes({"level", "nodes"});
  for (std::size_t i = 0; i < stats.nodesPerLevel.size(); ++i) {
    nodes.add({std::to_string(i + 1), std::to_string(stats.nodesPerLevel[i])});
  }
  TextTable table({"what", ""});
  table.add({"surface voxels", std::to_string(stats.surfaceVoxels)});
  table.add({"solid voxels", std::to_string(stats.solidVoxels)});
  table.add({"topology", byteSize(stats.topologyBytes)});
  table.add({"depths, labels, clearances", byteSize(stats.payloadBytes)});
  table.add({"built in", decimal(stats.buildMs, 1) + " ms"});
  output.text = nodes.text() + "\n" + table.text();
  return output;
}

Result<CommandOutput> runTree(const TreeCommandOptions& options, const CommandContext& context) {
  context.progress(0.0, "Reading the labels");
  const Result<LabelState> state = readCaseLabelState(options.caseFolder);
  if (!state) return fail(state.error());
  const LabelGrid& labels = state->labels;
  const Result<std::uint8_t> value = labelValue(state->table, options.label);
  if (!value) return fail(value.error());
  TreeOptions treeOptions;
  treeOptions.branching = static_cast<Branching>(options.branching);
  treeOptions.leaf = options.leaf == "voxel" ? LeafModel::Voxel : LeafModel::Distance;
  const Result<VoxelTree> tree =
      VoxelTree::build(labels, std::span(&*value, 1), treeOptions, context.progress);
  if (!tree) return fail(tree.error());
  // Left in the case, so that simulate and the desktop need not build it again.
  const std::uint64_t source = treeSourceFingerprint(labels, std::span(&*value, 1), treeOptions);
  const auto kept = saveTreeCache(*tree, source, options.caseFolder / treeCacheName(source));
  CommandOutput output = reportTree(tree->stats());
  if (!kept) output.warnings.push_back(kept.error().message);
  return output;
}

}  // namespace

void addTreeCommand(CommandSet& commands) {
  const auto options = std::make_shared<TreeCommandOptions>();
  CLI::App* sub =
      commands.add("tree", "Builds the implicit sphere tree of a label",
                   [options](const CommandContext& context) { return runTree(*options, context); });
  sub->add_option("CASE", options->caseFolder, "The case's folder")->required();
  sub->add_option("--label", options->label, "The label, by name")->required();
  sub->add_option("--branching", options->branching, "Children a node")
      ->check(CLI::IsMember({8, 64, 512}))
      ->capture_default_str();
  sub->add_option("--leaf", options->leaf, "Leaf model")
      ->check(CLI::IsMember({"voxel", "distance"}))
      ->capture_default_str();
}

}  // namespace palpate
