#include "core/trade/tradeoff.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/progress_part.h"
#include "core/base/short_number.h"
#include "core/geometry/units.h"
#include "core/trade/bench.h"
#include "core/trade/choice.h"

namespace palpate {
namespace {

constexpr std::size_t kMatterMost = 5;  // options that are tried in pairs

/// What a hand can tell apart and a scene can declare: enough for a choice.
const std::set<std::string> kQuick{"leaf", "perceptual", "shell", "iterations", "rate"};
const std::set<std::string> kQuickNot{"iterations=5",      "iterations=1000",   "perceptual=0.25mm",
                                      "perceptual=0.50mm", "perceptual=2.00mm", "rate=100Hz"};

/// How much a change matters: felt force in units of what a hand can tell, and tests in octaves.
/// Counts, not times: the same on every machine.
double effectOf(const TradePoint& point, const TradePoint& own) {
  constexpr double kTold_N = 0.05;
  const double force = std::abs(point.errors.force_N.p95 - own.errors.force_N.p95) / kTold_N;
  const double tests = std::log2((point.cost.testsP99 + 1.0) / (own.cost.testsP99 + 1.0));
  return force + std::abs(tests);
}

/// Of the options that matter most, the value that matters most.
std::vector<NamedSetting> strongest(const std::vector<NamedSetting>& singles,
                                    const std::vector<TradePoint>& points) {
  const auto own = std::find_if(points.begin(), points.end(),
                                [](const TradePoint& p) { return p.name == "default"; });
  std::vector<std::pair<double, const NamedSetting*>> best;  // an option
  for (const NamedSetting& single : singles) {
    const auto point = std::find_if(points.begin(), points.end(),
                                    [&](const TradePoint& p) { return p.name == single.name; });
    if (single.option.empty() || single.option == "precision" || point == points.end()) continue;
    const double effect = effectOf(*point, *own);
    const auto same = std::find_if(best.begin(), best.end(), [&](const auto& other) {
      return other.second->option == single.option;
    });
    if (same == best.end()) {
      best.emplace_back(effect, &single);
    } else if (effect > same->first) {
      *same = {effect, &single};
    }
  }
  std::stable_sort(best.begin(), best.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<NamedSetting> chosen;
  for (std::size_t i = 0; i < std::min(kMatterMost, best.size()); ++i) {
    chosen.push_back(*best[i].second);
  }
  return chosen;
}

/// The choice under a limit, together with what a running simulation can change.
std::vector<NamedSetting> stepsDown(const SimulationSetting& own,
                                    const std::vector<TradeOption>& options,
                                    const std::vector<NamedSetting>& singles,
                                    const std::vector<TradePoint>& points, double limit_us) {
  const auto chosen = chooseSetting(points, 1e-6 * limit_us, 1.0);
  std::vector<NamedSetting> more;
  if (!chosen || chosen->option.empty()) return more;  // the singles are its steps down
  for (const NamedSetting& single : singles) {
    if (single.option == chosen->option) continue;
    if (single.option != "iterations" && single.option != "perceptual") continue;
    const std::string name = chosen->name + " " + single.name;
    if (const auto setting = settingNamed(own, options, name)) {
      more.push_back({name, *setting, {}, {}});
    }
  }
  return more;
}

/// Resolutions and shells between those that are tried, and beyond: a line wants more than three
/// points.
std::vector<NamedSetting> forGrowth(const SimulationSetting& own, double spacing) {
  std::vector<NamedSetting> all;
  for (const int joined : {3, 6, 8}) {
    NamedSetting named{"voxels=" + std::to_string(joined) + "x", {own}, "voxels", {}};
    named.setting.coarsening = joined;
    all.push_back(std::move(named));
  }
  for (const double factor : {0.7, 1.4, 2.8}) {
    const double shell = factor * spacing;
    NamedSetting named{formatted("shell=%.2fmm", millimetres(shell)), {own}, "shell", {}};
    named.setting.simulation.shellSpacing = shell;
    all.push_back(std::move(named));
  }
  return all;
}

std::vector<Growth> growthOf(const std::vector<TradePoint>& points, Bench& bench) {
  std::vector<double> resolution, shell, tests[2], time[2], bytes, build;
  for (const TradePoint& point : points) {
    const bool own = point.name == "default";
    if (own || point.option == "voxels") {
      resolution.push_back(1.0 / point.setting.coarsening);
      tests[0].push_back(point.cost.testsP99);
      time[0].push_back(point.cost.p99_us);
      bytes.push_back(static_cast<double>(point.cost.bytes));
      build.push_back(point.cost.build_ms);
    }
    if (own || point.option == "shell") {
      shell.push_back(static_cast<double>(point.cost.shellPoints));
      tests[1].push_back(point.cost.testsP99);
      time[1].push_back(point.cost.p99_us);
    }
  }
  const Bench::Queries queries = bench.queries();
  return {fitGrowth("p99 of a step", "voxels a side", resolution, time[0]),
          fitGrowth("tests at p99", "voxels a side", resolution, tests[0]),
          fitGrowth("bytes", "voxels a side", resolution, bytes),
          fitGrowth("build", "voxels a side", resolution, build),
          fitGrowth("p99 of a step", "shell points", shell, time[1]),
          fitGrowth("tests at p99", "shell points", shell, tests[1]),
          fitGrowth("time of a query", "contacts", queries.contacts, queries.micros),
          fitGrowth("tests of a query", "contacts", queries.contacts, queries.tests)};
}

/// Thin labels have no voxel left where many are joined: such a setting cannot be built.
enum class Unbuildable : std::uint8_t { Refuse, LeaveOut };

Result<void> measureAll(Bench& bench, const std::vector<NamedSetting>& settings,
                        const Progress& progress, std::vector<TradePoint>& points,
                        Unbuildable unbuildable = Unbuildable::Refuse) {
  for (std::size_t i = 0; i < settings.size(); ++i) {
    progress(static_cast<double>(i) / static_cast<double>(settings.size()),
             "Measuring " + settings[i].name);
    auto point = bench.measure(settings[i], progress);
    if (point) {
      points.push_back(std::move(*point));
    } else if (unbuildable == Unbuildable::Refuse || point.error().kind == ErrorKind::Cancelled) {
      return fail(point.error());
    }
  }
  return {};
}

}  // namespace

Result<TradeSweep> sweepTrade(const PreparedScene& base, const TradeRequest& request,
                              const Progress& progress) {
  auto bench = Bench::create(base, request, shareOf(progress, 0.0, 0.15));
  if (!bench) return fail(bench.error());
  const SimulationSetting& own = base.scene.setting;
  auto options = optionsAround(own, bench->variants().spacingOf(own));
  const bool quick = request.effort == TradeEffort::Quick;
  if (quick)
    std::erase_if(options, [](const auto& option) { return !kQuick.contains(option.name); });

  TradeSweep sweep;
  sweep.seed = request.seed;
  sweep.reference = request.shape ? std::string("the closed form of the ") + nameOf(*request.shape)
                                  : "the labels' own resolution, searched by brute force";
  sweep.reference += ", in double precision, with a shell of half the spacing";
  sweep.trajectories = bench->names();
  sweep.leftOut = bench->leftOut();
  sweep.points.push_back(bench->reference());
  auto singles = singleChanges(own, options);
  if (quick) {
    std::erase_if(singles, [](const NamedSetting& s) { return kQuickNot.contains(s.name); });
  }
  const double end = quick ? 0.75 : 0.4;
  if (auto done = measureAll(*bench, singles, shareOf(progress, 0.15, end), sweep.points); !done) {
    return fail(done.error());
  }
  if (!quick) {
    auto more = pairedChanges(own, options, strongest(singles, sweep.points));
    const std::size_t count = request.effort == TradeEffort::Full ? 200 : 50;
    const auto random = randomChanges(own, options, count, request.seed);
    more.insert(more.end(), random.begin(), random.end());
    if (auto done = measureAll(*bench, more, shareOf(progress, end, 0.95), sweep.points); !done) {
      return fail(done.error());
    }
    std::vector<TradePoint> grown = sweep.points;
    const auto steps = forGrowth(own, bench->variants().spacingOf(own));
    if (auto done =
            measureAll(*bench, steps, shareOf(progress, 0.95, 1.0), grown, Unbuildable::LeaveOut);
        !done) {
      return fail(done.error());
    }
    sweep.growth = growthOf(grown, *bench);
  }
  if (quick && request.limit_us > 0.0) {
    const auto more = stepsDown(own, options, singles, sweep.points, request.limit_us);
    if (auto done = measureAll(*bench, more, shareOf(progress, end, 1.0), sweep.points); !done) {
      return fail(done.error());
    }
  }
  markFront(sweep.points);
  progress(1.0, "Measured");
  return sweep;
}

Result<TradePoint> measureSetting(const PreparedScene& base, const TradeRequest& request,
                                  const NamedSetting& setting, const Progress& progress) {
  auto bench = Bench::create(base, request, shareOf(progress, 0.0, 0.5));
  if (!bench) return fail(bench.error());
  return bench->measure(setting, shareOf(progress, 0.5, 1.0));
}

}  // namespace palpate
