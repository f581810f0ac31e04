/// Steps of a case at every setting that a sweep changes by itself, for an instruction counter: the
/// approach and four slides, one dump of the counter a setting (instructions.py adds them up).
///
///     settings_counted CASE
///
/// Prints a line a setting: its name and how many steps were made.

#include <valgrind/callgrind.h>

#include <cstdio>

#include "app/device_facts.h"
#include "app/program_paths.h"
#include "app/scene_loading.h"
#include "core/trade/felt.h"
#include "core/trade/variants.h"

namespace palpate {
namespace {

constexpr std::uint64_t kSlides = 4;

int failed(const Error& error) {
  std::fprintf(stderr, "%s\n", sentence(error).c_str());
  return exitCode(error.kind);
}

int count(const char* folder) {
  const auto datasets = datasetsFolder();
  if (!datasets) return failed(datasets.error());
  const auto base = loadScene(folder, *datasets, {}, {});
  if (!base) return failed(base.error());
  std::vector<Trajectory> motions{approachPath(**base)};
  for (std::uint64_t i = 0; i < kSlides; ++i) motions.push_back(slidePath(**base, 1000 + i));
  const DeviceInfo device = deviceFacts((*base)->scene.device);
  Variants variants(**base);
  const SimulationSetting& own = (*base)->scene.setting;
  const auto options = optionsAround(own, variants.spacingOf(own));
  for (const NamedSetting& setting : singleChanges(own, options)) {
    if (setting.setting.doublePrecision) continue;  // the reference's loop, which has no step
    const auto scene = variants.at(setting.setting);
    if (!scene) return failed(scene.error());
    const CouplingGains gains = recommendedGains(device, setting.setting.simulation.stepPeriod);
    std::size_t steps = 0;
    CALLGRIND_ZERO_STATS;
    for (const Trajectory& motion : motions) {
      steps += runPass(*scene, gains, motion, 1).micros.size();
    }
    CALLGRIND_DUMP_STATS_AT(setting.name.c_str());
    std::printf("%s %zu\n", setting.name.c_str(), steps);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "settings_counted CASE\n");
    return 2;
  }
  return palpate::count(argv[1]);
}
