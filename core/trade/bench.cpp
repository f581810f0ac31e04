#include "core/trade/bench.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <mutex>

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
  std::size_t slides = 40, cavities = 40, random = 100;
};
Counts countsOf(TradeEffort effort) {
  switch (effort) {
    case TradeEffort::Quick:
      return {20, 20, 40};
    case TradeEffort::Full:
      return {160, 160, 400};
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

/// Calls `work` with every index below `count`, several at once. False: cancelled.
bool forEach(std::size_t count, const Progress& progress,
             const std::function<void(std::size_t)>& work) {
  std::mutex reporting;
  std::size_t done = 0;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (progress.cancelled()) return;
    work(i);
    const std::lock_guard<std::mutex> lock(reporting);
    progress(static_cast<double>(++done) / static_cast<double>(count), "Working out what is right");
  });
  return !progress.cancelled();
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

std::vector<Bench::Maker> Bench::makers() const {
  const Counts counts = countsOf(request_.effort);
  Surround surround = surroundOf(base_);
  if (request_.shape) {
    surround.up_W = Eigen::Vector3d::UnitZ();
    surround.leastCosine = kShapeCone;
  }
  const std::uint64_t seed = 1000 * request_.seed;  // seeds 1, 2, ... share none but the first
  const PreparedScene& base = base_;
  const ReferenceShape& shape = *shape_;
  std::vector<Maker> all{[&base] { return approachPath(base); }};
  for (std::size_t i = 0; i < counts.slides; ++i) {
    all.emplace_back([&base, seed, i] { return slidePath(base, seed + i); });
  }
  for (std::size_t i = 0; i < counts.cavities; ++i) {
    all.emplace_back([=, &shape] { return cavityPath(shape, surround, seed + i); });
  }
  for (std::size_t i = 0; i < counts.random; ++i) {
    all.emplace_back([=, &shape] { return randomPath(shape, surround, seed + i); });
  }
  for (const Trajectory& recorded : request_.recorded) {
    all.emplace_back([&recorded] { return recorded; });
  }
  return all;
}

Bench::Motion Bench::motionOf(const Maker& make) const {
  const CouplingGains gains = softened(gainsOf({}), base_.scene.setting.couplingShare);
  Motion motion;
  motion.trajectory = make();
  if (motion.trajectory.samples.empty()) return motion;
  ReferenceRun run;
  motion.reference = runReferencePass(base_, *finest_, gains, *shape_, motion.trajectory, &run);
  if (!motion.reference.settled) return motion;
  motion.probed = probedPoses(run, motion.trajectory, *finest_, *shape_,
                              motion.trajectory.smooth ? kStride : kRandomStride);
  return motion;
}

Result<void> Bench::addMotions(const Progress& progress) {
  const std::vector<Maker> all = makers();
  motions_.resize(all.size());
  const auto add = [&](std::size_t i) { motions_[i] = motionOf(all[i]); };
  if (!forEach(all.size(), progress, add)) return fail(cancelled());
  std::erase_if(motions_, [](const Motion& motion) { return motion.trajectory.samples.empty(); });
  for (const Motion& motion : motions_) {
    if (!motion.reference.settled) leftOut_.push_back(motion.trajectory.name);
  }
  std::erase_if(motions_, [](const Motion& motion) { return !motion.reference.settled; });
  if (motions_.empty()) {
    return fail(checkFailed("There is nothing to measure: the reference settles on no motion.")
                    .butFound(std::to_string(leftOut_.size()) + " motions that were tried")
                    .advise("Place the device where the instrument has room."));
  }
  reference_.name = "reference";
  reference_.offered = false;
  reference_.setting.simulation = base_.scene.setting;
  reference_.setting.simulation.shellSpacing = 0.5 * variants_.spacingOf(base_.scene.setting);
  reference_.setting.doublePrecision = true;
  ErrorSamples errors;
  for (const Motion& motion : motions_) {
    addCost(motion.reference);
    errors.addFelt(motion.trajectory, motion.reference.felt, motion.reference.felt);
  }
  reference_.errors = errors.errors();
  reference_.cost = costOf(base_, true);
  reference_.cost.shellPoints = finest_->size();
  return {};
}

const Bench::Judged* Bench::judgedFor(const PreparedScene& scene, const Progress& progress) {
  const double undecided = undecidedOf(scene);
  for (const auto& known : judged_) {
    if (known->shell == scene.shell.get() && known->undecided == undecided) return known.get();
  }
  auto judged = std::make_unique<Judged>();
  judged->shell = scene.shell.get();
  judged->undecided = undecided;
  judged->byMotion.resize(motions_.size());
  const auto judge = [&](std::size_t i) {
    judged->byMotion[i] = palpate::judged(motions_[i].probed, *scene.shell, *shape_, undecided);
  };
  Progress quiet;
  quiet.cancel = progress.cancel;
  if (!forEach(motions_.size(), quiet, judge)) return nullptr;
  judged_.push_back(std::move(judged));
  return judged_.back().get();
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
  // The reference has no tree: the labels themselves.
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
  const Judged* judged = exact ? nullptr : judgedFor(**scene, progress);
  if (!exact && judged == nullptr) return fail(cancelled());
  std::size_t leftOut = 0;
  ErrorSamples errors;
  for (std::size_t i = 0; i < motions_.size(); ++i) {
    const Motion& motion = motions_[i];
    if (progress.cancelled()) return fail(cancelled());
    const Pass pass =
        exact ? runReferencePass(**scene, *(*scene)->shell, gains, *shape_, motion.trajectory)
              : runPass(*scene, gains, motion.trajectory, kRepeats);
    if (!pass.settled) {
      ++leftOut;
      continue;
    }
    addCost(pass);
    errors.addFelt(motion.trajectory, pass.felt, motion.reference.felt);
    if (exact) {
      errors.addReferenceContacts(motion.probed,
                                  probedWith(motion.probed, *(*scene)->shell, *shape_));
    } else {
      errors.addContacts(**scene, motion.probed, judged->byMotion[i]);
    }
  }
  TradePoint point;
  point.name = named.name;
  point.option = named.option;
  point.value = named.value;
  point.setting = named.setting;
  point.errors = errors.errors();
  point.leftOut = leftOut;
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
