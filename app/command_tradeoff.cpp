#include <algorithm>
#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/device_facts.h"
#include "app/duration_text.h"
#include "app/known_shape_scene.h"
#include "app/program_paths.h"
#include "app/scene_loading.h"
#include "app/trade_report.h"
#include "core/base/whole_file.h"
#include "core/trade/choice.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

// Half a voxel of a usual CT: fine enough for a closed form to be close, coarse enough for minutes.
constexpr double kShapeVoxel_mm = 0.5;

struct TradeoffOptions {
  fs::path caseOrScene, out;
  std::string shape;
  double voxel_mm = kShapeVoxel_mm;
  std::vector<std::string> sessions;
  bool quick = false, full = false, choose = false;
  std::string deadline = "1ms";
  double headroom = 0.5;
  std::uint64_t seed = 1;
};

Result<void> checkOptions(const TradeoffOptions& options) {
  if (options.caseOrScene.empty() == options.shape.empty()) {
    return fail(usageError("What is measured is a case, or a known shape.")
                    .inField("CASE|SCENE, --shape")
                    .wants("exactly one of them")
                    .advise("Name a case, or give --shape."));
  }
  if (options.out.empty() && !options.choose) {
    return fail(usageError("Nothing says where the sweep goes.")
                    .inField("--out")
                    .advise("Give --out DIR, or --choose to see only the choice."));
  }
  return options.out.empty() ? Result<void>{} : checkWritable(options.out);
}

/// The scene, and the shape whose closed form it is measured against.
Result<std::shared_ptr<const PreparedScene>> sceneOf(const TradeoffOptions& options,
                                                     TradeRequest& request,
                                                     const Progress& progress) {
  const Result<fs::path> datasets = datasetsFolder();
  if (!datasets) return fail(datasets.error());
  if (options.shape.empty()) return loadScene(options.caseOrScene, *datasets, {}, progress);
  const auto shape = knownShapeNamed(options.shape);
  if (!shape) return fail(shape.error());
  request.shape = *shape;
  return knownShapeScene(*shape, 1e-3 * options.voxel_mm, *datasets, progress);
}

Result<void> choose(const TradeoffOptions& options, const PreparedScene& scene,
                    TradeRequest request, const Progress& progress, TradeReport& report) {
  Result<TradePoint> chosen =
      chooseSetting(report.sweep.points, report.deadline_s, report.headroom);
  if (!chosen) return fail(chosen.error());
  report.chosen = std::move(*chosen);
  request.seed = report.checkedSeed = options.seed + 1;
  auto checked = measureSetting(scene, request,
                                {report.chosen->name, report.chosen->setting, {}, {}}, progress);
  if (!checked) return fail(checked.error());
  report.checked = std::move(*checked);
  return {};
}

Result<CommandOutput> runTradeoff(const TradeoffOptions& options, const CommandContext& context) {
  const Result<double> deadline = parseDuration(options.deadline, "--deadline");
  if (!deadline) return fail(deadline.error());
  if (auto checked = checkOptions(options); !checked) return fail(checked.error());
  TradeRequest request;
  request.seed = options.seed;
  if (options.quick) request.effort = TradeEffort::Quick;
  if (options.full) request.effort = TradeEffort::Full;
  const auto scene = sceneOf(options, request, context.progress);
  if (!scene) return fail(scene.error());
  request.device = deviceFacts((*scene)->scene.device);
  for (const std::string& session : options.sessions) {
    auto path = sessionPath(session);
    if (!path) return fail(path.error());
    request.recorded.push_back(std::move(*path));
  }
  auto sweep = sweepTrade(**scene, request, context.progress);
  if (!sweep) return fail(sweep.error());

  TradeReport report;
  report.sweep = std::move(*sweep);
  report.deadline_s = *deadline;
  report.headroom = options.headroom;
  if (options.choose) {
    auto chosen = choose(options, **scene, request, context.progress, report);
    if (!chosen) return fail(chosen.error());
  }
  if (!options.out.empty()) {
    const Result<void> written = writeTradeFiles(report, options.out);
    if (!written) return fail(written.error());
  }
  CommandOutput output;
  output.json = tradeJson(report);
  output.text = tradeText(report);
  return output;
}

}  // namespace

void addTradeoffCommand(CommandSet& commands) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App* sub = commands.add(
      "tradeoff", "Measures speed against accuracy over many settings",
      [options](const CommandContext& context) { return runTradeoff(*options, context); });
  sub->add_option("CASE|SCENE", options->caseOrScene, "A case's folder, or a scene.toml in one");
  sub->add_option("--shape", options->shape,
                  "Instead of a case: sphere, plane, cylinder, wedge, torus, as voxels, against "
                  "the closed form");
  sub->add_option("--voxel", options->voxel_mm, "Of --shape, mm")
      ->check(CLI::Range(0.2, 4.0))
      ->capture_default_str();
  sub->add_option("--session", options->sessions,
                  "Recorded sessions of this scene, whose motions are measured as well")
      ->check(CLI::ExistingFile);
  sub->add_option("--out", options->out,
                  "Folder for tradeoff.csv, tradeoff.json, front and options as .svg and .png");
  auto* quick = sub->add_flag("--quick", options->quick, "Seconds: what can be felt, 81 motions");
  sub->add_flag("--full", options->full, "Four times as many motions and combinations")
      ->excludes(quick);
  sub->add_flag("--choose", options->choose, "Choose the most accurate setting under the deadline");
  sub->add_option("--deadline", options->deadline, "Of a step: 1ms, 500us, 0.001s")
      ->capture_default_str();
  sub->add_option("--headroom", options->headroom, "Part of the deadline that p99.9 may use")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  sub->add_option("--seed", options->seed, "Of the trajectory")->capture_default_str();
}

}  // namespace palpate
