#include <algorithm>
#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/duration_text.h"
#include "app/program_paths.h"
#include "app/scene_loading.h"
#include "app/text_table.h"
#include "app/tradeoff_files.h"
#include "core/base/whole_file.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::uint64_t kFullSeeds = 5;

struct TradeoffOptions {
  fs::path caseOrScene, out;
  bool full = false, choose = false;
  std::string deadline = "1ms";
  double headroom = 0.5;
  std::uint64_t seed = 1;
};

/// The worst of both: what --full promises of a setting holds on every trajectory.
void keepWorst(TradePoint& worst, const TradePoint& other) {
  const auto keep = [](auto& mine, auto theirs) { mine = std::max(mine, theirs); };
  keep(worst.depthErrorP95_mm, other.depthErrorP95_mm);
  keep(worst.normalErrorP95_deg, other.normalErrorP95_deg);
  keep(worst.forceErrorP95_N, other.forceErrorP95_N);
  keep(worst.contactsMissed, other.contactsMissed);
  keep(worst.contactsExtra, other.contactsExtra);
  keep(worst.stepP50_us, other.stepP50_us);
  keep(worst.stepP99_us, other.stepP99_us);
  keep(worst.stepP999_us, other.stepP999_us);
  worst.onFront = worst.onFront && other.onFront;
}

/// One sweep, or with --full five trajectories and the worst of each setting.
Result<std::vector<TradePoint>> sweep(const TradeoffOptions& options, const PreparedScene& scene,
                                      const Progress& progress) {
  const std::uint64_t runs = options.full ? kFullSeeds : 1;
  std::vector<TradePoint> points;
  for (std::uint64_t run = 0; run < runs; ++run) {
    Progress part;
    part.cancel = progress.cancel;
    part.report = [&](double fraction, const std::string& what) {
      progress((static_cast<double>(run) + fraction) / static_cast<double>(runs), what);
    };
    Result<std::vector<TradePoint>> found = sweepTrade(scene, options.seed + run, part);
    if (!found) return fail(found.error());
    if (run == 0) {
      points = std::move(*found);
      continue;
    }
    for (std::size_t i = 0; i < std::min(points.size(), found->size()); ++i) {
      keepWorst(points[i], (*found)[i]);
    }
  }
  return points;
}

Result<CommandOutput> runTradeoff(const TradeoffOptions& options, const CommandContext& context) {
  const Result<double> deadline = parseDuration(options.deadline, "--deadline");
  if (!deadline) return fail(deadline.error());
  if (options.out.empty() && !options.choose) {
    return fail(usageError("Nothing says where the sweep goes.")
                    .inField("--out")
                    .advise("Give --out DIR, or --choose to see only the choice."));
  }
  if (!options.out.empty()) {
    const Result<void> writable = checkWritable(options.out);
    if (!writable) return fail(writable.error());
  }
  const Result<fs::path> datasets = datasetsFolder();
  if (!datasets) return fail(datasets.error());
  const auto scene = loadScene(options.caseOrScene, *datasets, {}, context.progress);
  if (!scene) return fail(scene.error());
  const Result<std::vector<TradePoint>> points = sweep(options, **scene, context.progress);
  if (!points) return fail(points.error());

  TradeoffResult result{*points, {}, options.seed, *deadline, options.headroom};
  if (options.choose) {
    Result<TradePoint> chosen = chooseSetting(*points, *deadline, options.headroom);
    if (!chosen) return fail(chosen.error());
    result.chosen = std::move(*chosen);
  }
  if (!options.out.empty()) {
    const Result<void> written = writeTradeoffFiles(result, options.out);
    if (!written) return fail(written.error());
  }
  CommandOutput output;
  output.json = tradeoffJson(result);
  output.text = tradeoffText(result);
  return output;
}

}  // namespace

void addTradeoffCommand(CommandSet& commands) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App* sub = commands.add(
      "tradeoff", "Measures speed against accuracy over many settings",
      [options](const CommandContext& context) { return runTradeoff(*options, context); });
  sub->add_option("CASE|SCENE", options->caseOrScene, "A case's folder, or a scene.toml in one")
      ->required();
  sub->add_option("--out", options->out, "Folder for tradeoff.csv, tradeoff.json, tradeoff.svg");
  sub->add_flag("--full", options->full, "Five trajectories, the worst of each setting");
  sub->add_flag("--choose", options->choose, "Choose the most accurate setting under the deadline");
  sub->add_option("--deadline", options->deadline, "Of a step: 1ms, 500us, 0.001s")
      ->capture_default_str();
  sub->add_option("--headroom", options->headroom, "Part of the deadline that p99.9 may use")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  sub->add_option("--seed", options->seed, "Of the trajectory")->capture_default_str();
}

}  // namespace palpate
