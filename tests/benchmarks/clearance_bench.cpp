/// Time per step of the clearance to chosen anatomy: the whole bone, or a thin nerve in it.
///
/// Counters: p50/p99/worst microseconds per step over one pass of the trajectory, tests per step,
/// mean clearance in mm.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <random>

#include "core/collision/clearance_finder.h"
#include "tests/benchmarks/bench_scenes.h"

namespace palpate::bench {
namespace {

enum Anatomy { kBone, kNerve };
enum Motion { kPressed, kHover, kApproach, kTeleport };

constexpr int kSteps = 2000;
constexpr double kPi = 3.14159265358979323846;

// A tube of 1.2 mm radius that winds through the bone.
LabelGrid nerve(int n) {
  LabelGrid grid;
  grid.geometry.dims = {n, n, n};
  const double s = kWorldSize / n;
  grid.geometry.spacing = Eigen::Vector3d::Constant(s);
  grid.labels.resize(grid.geometry.voxelCount());
  std::size_t at = 0;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i, ++at) {
        const double t = 2 * kPi * i / n;
        const double y = kWorldSize * (0.5 + 0.15 * std::sin(2 * t));
        const double z = kWorldSize * (0.65 + 0.1 * std::cos(t));
        if (std::hypot(s * j - y, s * k - z) < 1.2e-3) grid.labels[at] = 1;
      }
    }
  }
  return grid;
}

const VoxelTree& tree(Anatomy anatomy, int n, Branching branching) {
  static std::map<std::tuple<Anatomy, int, Branching>, VoxelTree> trees;
  const auto key = std::make_tuple(anatomy, n, branching);
  const auto at = trees.find(key);
  if (at != trees.end()) return at->second;
  const LabelGrid grid = anatomy == kBone ? bone(n) : nerve(n);
  return trees.emplace(key, VoxelTree::build(grid, {}, {branching, LeafModel::Voxel}).value())
      .first->second;
}

std::vector<Eigen::Isometry3d> posesOf(Motion motion) {
  if (motion == kPressed) return slide(150e-6, kSteps);
  if (motion == kHover) return slide(-2e-3, kSteps);
  std::vector<Eigen::Isometry3d> poses = slide(0.0, kSteps);
  if (motion == kApproach) {  // from 30 mm away into contact and back, while turning
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const double t = static_cast<double>(i) / kSteps;
      poses[i].translation().z() += 30e-3 * std::abs(std::cos(2 * kPi * t)) - 0.2e-3;
    }
    return poses;
  }
  std::mt19937 rng(4);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> place(-0.5 * kWorldSize, 1.5 * kWorldSize);
  for (auto& X : poses) {
    const Eigen::Quaterniond q(normal(rng), normal(rng), normal(rng), normal(rng));
    X.linear() = q.normalized().toRotationMatrix();
    X.translation() = Eigen::Vector3d(place(rng), place(rng), place(rng));
  }
  return poses;
}

// Arguments: anatomy, voxels a side, points, branching, motion.
void clearanceStep(benchmark::State& state) {
  const VoxelTree& anatomy =
      tree(static_cast<Anatomy>(state.range(0)), static_cast<int>(state.range(1)),
           static_cast<Branching>(state.range(3)));
  const PointShell shell = drill(static_cast<std::size_t>(state.range(2)));
  ClearanceFinder finder = ClearanceFinder::create(anatomy, shell).value();
  const auto poses = posesOf(static_cast<Motion>(state.range(4)));
  // A step's time is the shortest of the passes': what the machine's other work adds is not ours.
  std::vector<double> micros(poses.size(), HUGE_VAL);
  double tests = 0;
  double clearance = 0;
  double passes = 0;
  for (auto _ : state) {
    ++passes;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      const Clearance c = finder.find(poses[i]);
      const std::chrono::duration<double, std::micro> took =
          std::chrono::steady_clock::now() - start;
      micros[i] = std::min(micros[i], took.count());
      tests += c.tests;
      clearance += c.distance;
    }
  }
  std::sort(micros.begin(), micros.end());
  const auto at = [&](double q) {
    return micros[static_cast<std::size_t>(q * static_cast<double>(micros.size() - 1))];
  };
  state.counters["p50_us"] = at(0.5);
  state.counters["p99_us"] = at(0.99);
  state.counters["worst_us"] = at(1.0);
  state.counters["tests"] = tests / (passes * kSteps);
  state.counters["mean_mm"] = 1e3 * clearance / (passes * kSteps);
}

BENCHMARK(clearanceStep)
    ->ArgNames({"anatomy", "n", "points", "branching", "motion"})
    ->ArgsProduct(
        {{kBone, kNerve}, {256}, {10000, 100000}, {64}, {kPressed, kHover, kApproach, kTeleport}})
    ->ArgsProduct({{kBone}, {256}, {10000}, {8, 512}, {kHover, kTeleport}})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(5);

}  // namespace
}  // namespace palpate::bench
