#include "core/trade/bench.h"

#include <algorithm>
#include <chrono>

#include "core/geometry/units.h"
#include "core/simulation/fingerprint.h"
#include "core/trade/grid_reference.h"
#include "core/trade/promise.h"

namespace palpate {
namespace {

// Poses compared: a slide moves less than half a voxel in ten ticks; the many random approaches,
// which differ anyway, are looked at more sparsely.
constexpr std::size_t kStride = 10, kRandomStride = 25;
// A step's time is the median of so many: one that the system interrupted does not count.
constexpr int kRepeats = 3;
// cos 25°: flatter, the handpiece would touch the shape where its voxels have ended.
constexpr double kShapeCone = 0.906;

struct Counts {
  std::size_t slides = 10, cavities = 10, random = 50;
};
Counts countsOf(TradeEffort effort) {
  switch (effort) {
    case TradeEffort::Quick:
      return {6, 6, 16};
    case TradeEffort::Full:
      return {40, 40, 200};
    default:
      return {};
  }
}

double microsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
      .count();
}

std::size_t bytesOf(const PreparedScene& scene) {
  const TreeStats& stats = scene.tree->stats();
  return stats.topologyBytes + stats.payloadBytes +
         scene.shell->size() * 2 * sizeof(Eigen::Vector3d);
}

}  // namespace

Bench::Bench(const PreparedScene& base, const TradeRequest& request)
    : base_(base), request_(request), variants_(base) {
  shape_ =
      request.shape ? closedForm(*request.shape) : gridReference(base.labels, feltLabelsOf(base));
}

Result<Bench> Bench::create(const PreparedScene& base, const TradeRequest& request,
                            const Progress& progress) {
  Bench bench(base, request);
  auto finest = bench.variants_.shellAt(0.5 * bench.variants_.spacingOf(base.scene.setting));
  if (!finest) return fail(finest.error());
  bench.finest_ = *finest;
  if (auto added = bench.addMotions(progress); !added) return fail(added.error());
  return bench;
}

CouplingGains Bench::gainsOf(const SimulationSetting& setting) const {
  return recommendedGains(request_.device, setting.stepPeriod);
}

std::vector<Trajectory> Bench::trajectories() {
  const Counts counts = countsOf(request_.effort);
  Surround surround = surroundOf(base_);
  if (request_.shape) {
    surround.up_W = Eigen::Vector3d::UnitZ();
    surround.leastCosine = kShapeCone;
  }
  std::vector<Trajectory> all;  // sweeps of seeds 1, 2, ... share none but the first
  all.push_back(approachPath(base_));
  for (std::size_t i = 0; i < counts.slides; ++i) {
    all.push_back(slidePath(base_, 1000 * request_.seed + i));
  }
  for (std::size_t i = 0; i < counts.cavities; ++i) {
    all.push_back(cavityPath(*shape_, surround, 1000 * request_.seed + i));
  }
  for (std::size_t i = 0; i < counts.random; ++i) {
    all.push_back(randomPath(*shape_, surround, 1000 * request_.seed + i));
  }
  all.insert(all.end(), request_.recorded.begin(), request_.recorded.end());
  std::erase_if(all, [](const Trajectory& path) { return path.samples.empty(); });
  return all;
}

Result<void> Bench::addMotions(const Progress& progress) {
  std::vector<Trajectory> all = trajectories();
  const CouplingGains gains = softened(gainsOf({}), base_.scene.setting.couplingShare);
  reference_.name = "reference";
  reference_.offered = false;
  reference_.setting.simulation = base_.scene.setting;
  reference_.setting.simulation.shellSpacing = 0.5 * variants_.spacingOf(base_.scene.setting);
  reference_.setting.doublePrecision = true;
  ErrorSamples errors;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (progress.cancelled()) return fail(cancelled());
    progress(static_cast<double>(i) / static_cast<double>(all.size()), "Working out what is right");
    Motion motion;
    motion.trajectory = std::move(all[i]);
    ReferenceRun run;
    const Pass pass = runReferencePass(base_, *finest_, gains, *shape_, motion.trajectory, &run);
    addCost(pass);
    errors.addFelt(motion.trajectory, pass.felt, pass.felt);
    motion.felt = pass.felt;
    motion.probed = probedPoses(run, motion.trajectory, *finest_, *shape_,
                                motion.trajectory.smooth ? kStride : kRandomStride);
    motions_.push_back(std::move(motion));
  }
  reference_.errors = errors.errors();
  reference_.cost = costOf(base_, true);
  reference_.cost.shellPoints = finest_->size();
  return {};
}

std::vector<std::string> Bench::names() const {
  std::vector<std::string> names;
  for (const Motion& motion : motions_) names.push_back(motion.trajectory.name);
  return names;
}

void Bench::addCost(const Pass& pass) {
  micros_.push_back(pass.micros);
  slowest_.push_back(pass.slowest);
  tests_.insert(tests_.end(), pass.tests.begin(), pass.tests.end());
}

TradeCost Bench::costOf(const PreparedScene& scene, bool reference) const {
  TradeCost cost;
  std::vector<double> all;
  for (const auto& motion : micros_) all.insert(all.end(), motion.begin(), motion.end());
  cost.p50_us = percentile(all, 0.5);
  cost.p99_us = percentile(all, 0.99);
  cost.p999_us = percentile(all, 0.999);
  cost.worst_us = percentile(all, 1.0);
  cost.testsP50 = percentile(tests_, 0.5);
  cost.testsP99 = percentile(tests_, 0.99);
  cost.shellPoints = scene.shell->size();
  // The reference has no tree: the labels themselves, and a number for each voxel it looked at.
  cost.bytes = reference ? scene.labels->labels.size() : bytesOf(scene);
  cost.build_ms = reference ? 0.0 : scene.tree->stats().buildMs;
  return cost;
}

Result<TradePoint> Bench::measure(const NamedSetting& named, const Progress& progress) {
  const auto scene = variants_.at(named.setting);
  if (!scene) return fail(scene.error());
  const SimulationSetting& setting = named.setting.simulation;
  const bool exact = named.setting.doublePrecision;
  const CouplingGains gains =
      exact ? softened(gainsOf({}), setting.couplingShare) : gainsOf(setting);
  micros_.clear();
  slowest_.clear();
  tests_.clear();
  ErrorSamples errors;
  for (const Motion& motion : motions_) {
    if (progress.cancelled()) return fail(cancelled());
    const Pass pass =
        exact ? runReferencePass(**scene, *(*scene)->shell, gains, *shape_, motion.trajectory)
              : runPass(*scene, gains, motion.trajectory, kRepeats);
    addCost(pass);
    errors.addFelt(motion.trajectory, pass.felt, motion.felt);
    if (exact) {
      errors.addReferenceContacts(**scene, motion.probed, *shape_);
    } else {
      errors.addContacts(**scene, motion.probed, *shape_);
    }
  }
  TradePoint point;
  point.name = named.name;
  point.option = named.option;
  point.value = named.value;
  point.setting = named.setting;
  point.errors = errors.errors();
  point.cost = costOf(**scene, exact);
  point.promise = {errors.promisedForce(), errors.promisedDepth(), boundOf(slowest_, 0.999)};
  point.offered = named.setting.coarsening == 1 && !exact;
  return point;
}

Bench::Queries Bench::queries() {
  constexpr double kDeepest = 3e-3;
  constexpr int kDepths = 12, kTimed = 5;
  Queries queries;
  const auto scene = variants_.at({base_.scene.setting});
  if (!scene) return queries;
  ContactFinder finder(*(*scene)->tree, *(*scene)->shell, base_.scene.setting.query);
  std::vector<Contact> buffer((*scene)->shell->size());
  const Eigen::Isometry3d X_VW = (*scene)->X_WV.inverse();
  for (const Motion& motion : motions_) {
    if (motion.trajectory.smooth || motion.probed.empty()) continue;
    const ProbedPose& rest = motion.probed.back();
    if (rest.normal_W.isZero()) continue;
    for (int level = 0; level < kDepths; ++level) {
      Eigen::Isometry3d X_WT = rest.X_WT;
      X_WT.translation() -= (kDeepest * level / kDepths) * rest.normal_W.normalized();
      std::vector<double> times;
      QueryResult found;
      for (int i = 0; i < kTimed; ++i) {
        const auto start = std::chrono::steady_clock::now();
        found = finder.find(X_VW * X_WT, buffer);
        times.push_back(microsSince(start));
      }
      queries.contacts.push_back(static_cast<double>(found.contactCount));
      queries.micros.push_back(percentile(times, 0.5));
      queries.tests.push_back(found.tests);
    }
  }
  return queries;
}

}  // namespace palpate
