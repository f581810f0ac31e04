/// Time of edits in place: a ball of voxels, its middle on the bone's surface, removed and added
/// back.
///
/// A radius of 6.2 voxels is a ball of about a thousand, of which the bone has half; one of 8 takes
/// about a thousand out of the bone. Counters: p50/p99 microseconds of each edit, voxels it
/// changed.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "core/voxels/tree_editor.h"
#include "tests/benchmarks/world.h"

namespace palpate::bench {
namespace {

double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
}

// Solid all through under its surface, where a crater changes depths far below it.
LabelGrid filledBone(int n) {
  LabelGrid grid = syntheticBone(n);
  const GridGeometry& g = grid.geometry;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        if (boneSurface(g.centre_V(i, j, k)) <= 0) grid.labels[g.index(i, j, k)] = 1;
      }
    }
  }
  return grid;
}

// The highest voxel of the bone over a place that the n-th edit takes.
TreeEditor::Voxel surfaceAt(const LabelGrid& grid, int n) {
  const auto& dims = grid.geometry.dims;
  const int i = dims[0] / 2 + (n % 8 - 4) * dims[0] / 32;
  const int j = dims[1] / 2 + (n / 8 % 8 - 4) * dims[1] / 32;
  int k = dims[2] - 1;
  while (k > 0 && grid.at(i, j, k) == 0) --k;
  return {i, j, k};
}

// Arguments: voxels a side, tenths of a voxel of radius, branching, leaf, filled.
void editBall(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const double radius = 0.1 * static_cast<double>(state.range(1));
  const LabelGrid grid = state.range(4) != 0 ? filledBone(n) : syntheticBone(n);
  auto tree = VoxelTree::build(grid, {},
                               {static_cast<Branching>(state.range(2)),
                                static_cast<LeafModel>(state.range(3)), false})
                  .value();
  auto editor = TreeEditor::create(tree).value();
  editor.reserve({0, 0, 0}, grid.geometry.dims);
  std::vector<double> remove;
  std::vector<double> add;
  double changed = 0;
  const auto timed = [](std::vector<double>& micros, auto&& f) {
    const auto start = std::chrono::steady_clock::now();
    const EditResult result = f();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    micros.push_back(took.count());
    return result;
  };
  for (auto _ : state) {
    for (int place = 0; place < 64 * 3; ++place) {  // the first time around memory is touched
      const TreeEditor::Voxel c = surfaceAt(grid, place);
      std::vector<TreeEditor::Voxel> all;
      std::vector<TreeEditor::Voxel> solid;
      const int r = static_cast<int>(radius) + 1;
      for (int z = -r; z <= r; ++z) {
        for (int y = -r; y <= r; ++y) {
          for (int x = -r; x <= r; ++x) {
            if (x * x + y * y + z * z > radius * radius) continue;
            all.push_back({c[0] + x, c[1] + y, c[2] + z});
            if (grid.at(c[0] + x, c[1] + y, c[2] + z) != 0) solid.push_back(all.back());
          }
        }
      }
      const EditResult removed = timed(remove, [&] { return editor.remove(all); });
      const EditResult added = timed(add, [&] { return editor.add(solid, 1); });
      if (removed.tookMemory || added.tookMemory) state.SkipWithError("an edit took memory");
      changed += static_cast<double>(removed.changed);
    }
    remove.erase(remove.begin(), remove.begin() + 64);
    add.erase(add.begin(), add.begin() + 64);
  }
  state.counters["voxels"] = changed / (64 * 3);
  state.counters["remove_p50_us"] = quantile(remove, 0.5);
  state.counters["remove_p99_us"] = quantile(remove, 0.99);
  state.counters["add_p50_us"] = quantile(add, 0.5);
  state.counters["add_p99_us"] = quantile(add, 0.99);
}

BENCHMARK(editBall)
    ->ArgNames({"n", "radius", "branching", "leaf", "filled"})
    ->ArgsProduct({{256}, {62, 80}, {64}, {0, 1}, {0, 1}})
    ->ArgsProduct({{256}, {80}, {8, 512}, {0, 1}, {0}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);

}  // namespace
}  // namespace palpate::bench
