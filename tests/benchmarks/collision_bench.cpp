/// Time per step of the contact query, with its full contact list, and of the tree's build.
///
/// Counters: p50/p99 microseconds per step over one pass of the trajectory, mean contacts, tests
/// per step; for a build milliseconds and MiB.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "core/collision/contact_finder.h"
#include "core/collision/query_workers.h"
#include "tests/benchmarks/bench_scenes.h"

namespace palpate::bench {
namespace {

const VoxelTree& boneTree(int n, Branching branching, LeafModel leaf) {
  static std::map<std::tuple<int, Branching, LeafModel>, VoxelTree> trees;
  const auto key = std::make_tuple(n, branching, leaf);
  const auto at = trees.find(key);
  if (at != trees.end()) return at->second;
  return trees.emplace(key, VoxelTree::build(bone(n), {}, {branching, leaf, false}).value())
      .first->second;
}

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1));
  return values[at];
}

// Arguments: voxels a side, points, press in micrometres, branching, leaf, method.
void contactStep(benchmark::State& state) {
  const auto branching = static_cast<Branching>(state.range(3));
  const VoxelTree& tree =
      boneTree(static_cast<int>(state.range(0)), branching, static_cast<LeafModel>(state.range(4)));
  const PointShell shell = drill(static_cast<std::size_t>(state.range(1)));
  QueryOptions options;
  options.method = static_cast<QueryMethod>(state.range(5));
  ContactFinder finder(tree, shell, options);
  std::vector<Contact> out(shell.size());
  const bool slow = options.method == QueryMethod::Paper;
  const auto poses = slide(static_cast<double>(state.range(2)) * 1e-6, slow ? 200 : 2000);
  std::vector<double> micros;
  double contacts = 0;
  double tests = 0;
  for (auto _ : state) {
    for (const auto& X : poses) {
      const auto start = std::chrono::steady_clock::now();
      const QueryResult result = finder.find(X, out);
      const std::chrono::duration<double, std::micro> took =
          std::chrono::steady_clock::now() - start;
      benchmark::DoNotOptimize(out.data());
      micros.push_back(took.count());
      contacts += static_cast<double>(result.contactCount);
      tests += result.tests;
    }
  }
  const auto steps = static_cast<double>(micros.size());
  state.counters["p50_us"] = quantile(micros, 0.5);
  state.counters["p99_us"] = quantile(micros, 0.99);
  state.counters["contacts"] = contacts / steps;
  state.counters["tests"] = tests / steps;
}

void build(benchmark::State& state) {
  const LabelGrid grid = bone(static_cast<int>(state.range(0)));
  const TreeOptions options{static_cast<Branching>(state.range(1)),
                            static_cast<LeafModel>(state.range(2)), false};
  TreeStats stats;
  for (auto _ : state) stats = VoxelTree::build(grid, {}, options)->stats();
  const auto perSurface = static_cast<double>(stats.surfaceVoxels);
  state.counters["topology_MiB"] = static_cast<double>(stats.topologyBytes) / 1048576.0;
  state.counters["payload_MiB"] = static_cast<double>(stats.payloadBytes) / 1048576.0;
  state.counters["topology_B_per_surface"] = static_cast<double>(stats.topologyBytes) / perSurface;
  state.counters["payload_B_per_surface"] = static_cast<double>(stats.payloadBytes) / perSurface;
}

void nothing(void* /*context*/, std::size_t /*part*/, std::size_t /*thread*/) noexcept {}

// From the caller to two threads and back, with nothing to do. `asleep`: a millisecond apart, as in
// a loop of 1 kHz.
void handOff(benchmark::State& state) {
  QueryWorkers workers(2);
  std::vector<double> micros;
  for (auto _ : state) {
    if (state.range(0) != 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto start = std::chrono::steady_clock::now();
    workers.run(&nothing, nullptr, 2);
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    micros.push_back(took.count());
  }
  state.counters["p50_us"] = quantile(micros, 0.5);
  state.counters["p90_us"] = quantile(micros, 0.9);
  state.counters["p99_us"] = quantile(micros, 0.99);
}

BENCHMARK(handOff)->ArgNames({"asleep"})->Arg(0)->Iterations(100000);
BENCHMARK(handOff)->ArgNames({"asleep"})->Arg(1)->Iterations(2000);
BENCHMARK(contactStep)
    ->ArgNames({"n", "points", "press_um", "branching", "leaf", "method"})
    ->ArgsProduct({{256}, {10000}, {150, 600, 4000}, {8, 64, 512}, {0, 1}, {0, 2}})
    ->ArgsProduct({{256}, {10000}, {150}, {8, 64}, {1}, {1}})
    ->ArgsProduct({{256}, {1000, 100000}, {150, 4000}, {64}, {1}, {0}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK(build)
    ->ArgNames({"n", "branching", "leaf"})
    ->ArgsProduct({{128, 256}, {8, 64, 512}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace palpate::bench
