#include "tests/benchmarks/peers_main.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>

#include <hwy/targets.h>

#include "core/voxels/surface_descriptor.h"
#include "tests/benchmarks/dense_peers.h"
#include "tests/benchmarks/machine.h"
#include "tests/benchmarks/probe.h"
#include "tests/benchmarks/runner.h"
#include "tests/benchmarks/skull.h"
#include "tests/benchmarks/wide_peers.h"
#include "tests/benchmarks/world.h"

namespace palpate::bench {
namespace {

struct Options {
  std::vector<int> sides{256};
  std::vector<double> skull_mm;
  std::vector<std::size_t> points{10000};
  std::vector<std::string> trajectories{"slide", "approach"};
  std::size_t steps = 1000;
  int passes = 5;
  double press_mm = 0;
  std::uint64_t seed = 1;
  bool check = false, scalar = false, dense = false, wide = false, voxel = false, paper = false;
  bool unequal = false, avx2 = false;
  std::vector<std::string> ours;
  std::string csv;
};

std::string simdName() {
  const std::int64_t supported = hwy::SupportedTargets();
  return hwy::TargetName(supported & -supported);  // the best one is the lowest bit
}

double mebibytes(std::size_t bytes) {
  return static_cast<double>(bytes) / 1048576.0;
}

void report(const Options& options, const std::string& what, int n, std::size_t points,
            const Trajectory& trajectory, const std::vector<std::unique_ptr<Peer>>& peers,
            std::ofstream& csv) {
  const std::vector<Timing> timings = timePeers(peers, trajectory, points, options.passes);
  std::printf("\n%s, %s of %d, %zu points, median %.0f, at most %zu contacts, seed %llu\n",
              trajectory.name.c_str(), what.c_str(), n, points, timings[0].contacts,
              timings[0].maxContacts, static_cast<unsigned long long>(options.seed));
  std::printf("  %-22s %8s %8s %8s %9s %8s %8s | rival/this p50  p99\n", "peer", "p50 us", "p99 us",
              "worst", "touching", "tests", "MiB");
  std::size_t rival = 0;
  for (std::size_t i = 0; i < peers.size(); ++i) {
    if (peers[i]->name() == "rival") rival = i;
  }
  for (std::size_t i = 0; i < peers.size(); ++i) {
    const Timing& t = timings[i];
    std::printf("  %-22s %8.2f %8.2f %8.2f %9.2f %8.0f %8.1f | %6.2f %6.2f\n",
                peers[i]->name().c_str(), t.p50, t.p99, t.worst, t.p50Touching, t.tests,
                mebibytes(peers[i]->worldBytes()), timings[rival].p50 / t.p50,
                timings[rival].p99 / t.p99);
    if (csv) {
      csv << trajectory.name << ',' << what << ',' << n << ',' << points << ',' << peers[i]->name()
          << ',' << t.p50 << ',' << t.p99 << ',' << t.worst << ',' << t.worstRaw << ','
          << t.p50Touching << ',' << t.contacts << ',' << t.maxContacts << ',' << t.tests << ','
          << peers[i]->worldBytes() << ',' << timings[rival].p50 / t.p50 << ','
          << timings[rival].p99 / t.p99 << '\n';
    }
  }
}

void check(Peer& reference, const std::vector<std::unique_ptr<Peer>>& peers,
           const Trajectory& trajectory, std::size_t points) {
  for (const auto& peer : peers) {
    const Agreement a = compare(reference, *peer, trajectory, points, 5);
    std::printf(
        "  check %-22s %zu of %zu steps differ by %zu points (to depth %.2g voxel); depth +-%.2g "
        "voxel, normal +-%.2g rad\n",
        peer->name().c_str(), a.differentSteps, a.steps, a.differentPoints, a.deepestDifferent,
        a.depthError, a.normalError);
  }
}

void oneWorld(const Options& options, const std::string& what, const LabelGrid& grid,
              std::ofstream& csv) {
  const auto start = std::chrono::steady_clock::now();
  const DenseField field = denseField(grid);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  const auto solid =
      static_cast<double>(std::count(grid.labels.begin(), grid.labels.end(), std::uint8_t{1}));
  const auto kinds = classifySurface(grid.geometry, grid.labels);
  const auto surface = std::count(kinds.begin(), kinds.end(), SurfaceDescriptor::Surface);
  std::printf("\nworld %s, %dx%dx%d: %.1f %% solid, %lld surface voxels, dense field in %.2f s\n",
              what.c_str(), field.dims[0], field.dims[1], field.dims[2],
              100.0 * solid / static_cast<double>(grid.labels.size()),
              static_cast<long long>(surface), took.count());
  for (const std::size_t wanted : options.points) {
    const auto points = drillPoints(wanted);
    const ProbeTree probe = buildProbeTree(points);
    std::vector<std::unique_ptr<Peer>> peers;
    if (field.cubic()) {
      peers.push_back(makeRival(field, probe));
      peers.push_back(makeTunedRival(field, probe));
    }
    peers.push_back(makePalpate(grid, points, "hierarchy"));
    if (options.voxel) peers.push_back(makePalpate(grid, points, "voxel"));
    if (options.paper) peers.push_back(makePalpate(grid, points, "paper"));
    for (const std::string& with : options.ours) peers.push_back(makePalpate(grid, points, with));
    if (options.dense) peers.push_back(makeDenseSimd(field, probe));
    if (options.scalar) peers.push_back(makeScalarReference(field, points));
    if (options.wide) {
      for (auto make : {makeOpenVdb, makeBullet}) {
        if (auto peer = make(field, points)) peers.push_back(std::move(peer));
      }
      if (auto peer = makeFcl(grid, points)) peers.push_back(std::move(peer));
    }
    const auto reference = makeScalarReference(field, points);
    for (const std::string& name : options.trajectories) {
      const double press =
          options.press_mm > 0 ? options.press_mm * 1e-3 : usualPress(name, wanted);
      const Trajectory trajectory = what == "skull"
                                        ? slideAround(field, press, options.steps)
                                        : makeTrajectory(name, press, options.steps, options.seed);
      report(options, what, field.dims[0], points.size(), trajectory, peers, csv);
      if (options.check) check(*reference, peers, trajectory, points.size());
    }
  }
}

}  // namespace

int runPeers(int argc, char** argv) {
  Options options;
  CLI::App app("Contacts per step: the implicit sphere tree beside its peers");
  app.add_option("--n", options.sides, "voxels along a side")->delimiter(',');
  app.add_option("--skull-mm", options.skull_mm, "the real skull at these spacings instead")
      ->delimiter(',');
  app.add_option("--points", options.points, "shell points")->delimiter(',');
  app.add_option("--trajectory", options.trajectories,
                 "slide, approach, flat, random50, teleport, away")
      ->delimiter(',');
  app.add_option("--steps", options.steps, "steps of a trajectory");
  app.add_option("--passes", options.passes, "passes over it, peers in turn");
  app.add_option("--press-mm", options.press_mm, "depth, instead of the usual one");
  app.add_option("--seed", options.seed, "of the random trajectories");
  app.add_option("--csv", options.csv, "also write a table here");
  app.add_flag("--check", options.check, "compare every peer's contacts with the scalar reference");
  app.add_flag("--dense", options.dense, "also the dense field with SIMD for every point");
  app.add_flag("--avx2", options.avx2, "nothing wider than AVX2");
  app.add_flag("--unequal", options.unequal, "spacings 1 : 1.25 : 2; no rivals");
  app.add_option("--ours", options.ours, "also ours with an option: threads=2, contact_budget=300")
      ->delimiter(',');
  app.add_flag("--voxel", options.voxel, "also ours with voxel leaves (another leaf model)");
  app.add_flag("--paper", options.paper, "also its paper method");
  app.add_flag("--wide", options.wide, "also OpenVDB, Bullet (to 128^3) and FCL, where built in");
  app.add_flag("--scalar", options.scalar, "also the scalar reference");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (options.avx2) {
    hwy::SetSupportedTargetsForTest(hwy::SupportedTargets() & ~(HWY_AVX3 | HWY_AVX3_DL));
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
  std::printf("%s, %s, %s, commit %s\n", processorName().c_str(), simdName().c_str(),
              buildName().c_str(), commitName().c_str());
  std::ofstream csv;
  if (!options.csv.empty()) {
    csv.open(options.csv);
    csv << "trajectory,world,side,points,peer,p50_us,p99_us,worst_us,worst_raw_us,p50_touching_us,"
           "contacts,max_contacts,tests,bytes,ratio_p50,ratio_p99\n";
  }
  for (const double mm : options.skull_mm) {
    const auto grid = skull(mm * 1e-3);
    if (!grid) {
      std::fprintf(stderr, "The head CT is not here: install invesalius-examples.\n");
      return 2;
    }
    oneWorld(options, "skull", *grid, csv);
  }
  if (!options.skull_mm.empty()) return 0;
  for (const int n : options.sides) {
    oneWorld(options, "bone",
             options.unequal ? syntheticBone(n, n * 4 / 5, n / 2) : syntheticBone(n), csv);
  }
  return 0;
}

}  // namespace palpate::bench
