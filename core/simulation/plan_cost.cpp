#include "core/simulation/plan_cost.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <string_view>

#include "core/geometry/pose.h"
#include "core/simulation/plan.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

constexpr std::size_t kSteps = 400;  // measured, once the hand is down
constexpr std::size_t kDown = 150;   // steps to get there
constexpr double kAbove = 10e-3;     // m, where it starts
constexpr double kPressed = 1e-3;    // m below the surface: about 0.5 N
constexpr double kFree = 30e-3;      // m above, for steps in no contact
constexpr double kRadius = 3e-3;     // m of the circle
constexpr double kAcross = 20e-3;    // m/s: a hand that slides
constexpr int kRuns = 3;

using Poses = std::vector<std::pair<Eigen::Isometry3d, std::vector<Eigen::Isometry3d>>>;

/// The hand on rails at a step: stylus upright on the anatomy, T's +z along +y of D.
DeviceSample handAt(std::size_t step, const Eigen::Isometry3d& X_WD, double height) {
  constexpr double kPeriod = 1e-3;
  const double down = std::min(1.0, static_cast<double>(step) / kDown);
  const double angle = kAcross * kPeriod * static_cast<double>(step) / kRadius;
  const Eigen::Vector3d p_D(kRadius * std::cos(angle), height + (1.0 - down) * kAbove,
                            kRadius * std::sin(angle));
  const double sink = down < 1.0 ? -kAbove / (kDown * kPeriod) : 0.0;
  const Eigen::Vector3d v_D(-kAcross * std::sin(angle), sink, kAcross * std::cos(angle));
  const Eigen::Quaterniond upright = expMap(Eigen::Vector3d(-0.5 * std::numbers::pi, 0, 0));
  const Eigen::Quaterniond q_WT(X_WD.linear() * upright.toRotationMatrix());
  DeviceSample sample;
  sample.index = step;
  sample.t = kPeriod * static_cast<double>(step);
  sample.pose = plain(X_WD * p_D, q_WT.normalized());
  const Eigen::Vector3d v_W = X_WD.linear() * v_D;
  for (int axis = 0; axis < 3; ++axis) sample.v[axis] = v_W[axis];
  return sample;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Passage {
  double step = 0.0, contacts = 0.0;  ///< µs; mean
  Poses poses;
};

Passage pass(const std::shared_ptr<const PreparedScene>& scene, double height) {
  Simulation simulation(scene, recommendedGains(DeviceInfo{}, scene->scene.setting.stepPeriod));
  const std::uint32_t ticks = simulation.stepTicks();
  Passage passage;
  std::vector<double> micros;
  for (std::size_t step = 0; step < kDown + kSteps; ++step) {
    const StepRecord& record = simulation.step(handAt(step * ticks, scene->X_WD, height));
    if (step < kDown) continue;
    micros.push_back(record.micros);
    passage.contacts += static_cast<double>(record.contacts) / kSteps;
    std::vector<Eigen::Isometry3d> bodies;
    for (const LooseBody& body : simulation.bodies()) bodies.push_back(body.X_WB());
    passage.poses.emplace_back(isometry(record.tool), std::move(bodies));
  }
  passage.step = median(micros);
  return passage;
}

double queryAlone(const std::shared_ptr<const PreparedScene>& scene, const Poses& poses) {
  ContactGathering gathering(scene);
  std::vector<double> micros;
  for (const auto& [X_WT, X_WB] : poses) {
    const auto start = std::chrono::steady_clock::now();
    gathering.gather(X_WT, X_WB);
    const auto spent = std::chrono::steady_clock::now() - start;
    micros.push_back(std::chrono::duration<double, std::micro>(spent).count());
  }
  return median(micros);
}

template <class Change>
std::shared_ptr<const PreparedScene> changed(const PreparedScene& scene, Change&& change) {
  auto copy = std::make_shared<PreparedScene>(scene);
  change(*copy);
  return copy;
}

/// What a step of `scene` takes more than one of `less`, and least of some runs of each in turn.
double more(const std::shared_ptr<const PreparedScene>& scene,
            const std::shared_ptr<const PreparedScene>& less) {
  double with = HUGE_VAL, without = HUGE_VAL;
  for (int run = 0; run < kRuns; ++run) {
    with = std::min(with, pass(scene, -kPressed).step);
    without = std::min(without, pass(less, -kPressed).step);
  }
  return std::max(0.0, with - without);
}

void measureBodies(const std::shared_ptr<const PreparedScene>& scene, StepCosts& costs) {
  const auto without = changed(*scene, [](PreparedScene& s) { s.bodies.clear(); });
  costs.bodies = more(scene, without);
  const auto weightless =
      changed(*scene, [](PreparedScene& s) { s.scene.surroundings.gravity.setZero(); });
  const auto heavy = changed(*scene, [](PreparedScene& s) {
    Eigen::Vector3d& gravity = s.scene.surroundings.gravity;
    if (gravity.norm() == 0.0) gravity.y() = 9.81;
  });
  costs.gravity = more(heavy, weightless);
  const auto still = changed(*scene, [](PreparedScene& s) { s.scene.surroundings.drag = 0.0; });
  const auto dragged = changed(*scene, [](PreparedScene& s) {
    double& drag = s.scene.surroundings.drag;
    if (drag == 0.0) drag = Surroundings{}.drag;
  });
  costs.drag = more(dragged, still);
}

std::size_t bytesOf(const VoxelTree& tree) {
  return tree.stats().topologyBytes + tree.stats().payloadBytes;
}

/// Bytes of the tree, were the scene to leave out less.
Result<std::size_t> bytesWith(const PreparedScene& scene, Scene more,
                              const std::shared_ptr<const LabelGrid>& labels,
                              const Progress& progress) {
  more.X_WD = scene.X_WD;
  const auto whole =
      prepareScene(more, labels, scene.table, scene.materials, scene.instrument, progress);
  if (!whole) return fail(whole.error());
  return bytesOf(*(*whole)->tree);
}

Result<std::size_t> bytesReaching(const PreparedScene& scene, Reach reach,
                                  const Progress& progress) {
  Scene more = scene.scene;
  more.reach = reach;
  return bytesWith(scene, std::move(more), scene.labels, progress);
}

Result<std::size_t> bytesEverywhere(const PreparedScene& scene, const Progress& progress) {
  Scene more = scene.scene;
  more.region.reset();
  return bytesWith(scene, std::move(more), scene.wholeLabels, progress);
}

/// The region's and the workspace's rows as if the others stayed; the cavities' of all within the
/// region. A scene that its region alone makes small enough has no bytes there.
Result<void> weighWhatIsLeftOut(const PreparedScene& scene, std::vector<PlanRow>& plan,
                                const Progress& progress) {
  const std::size_t here = bytesOf(*scene.tree);
  std::size_t sealed = here;
  const auto weigh = [&plan](std::string_view what, std::size_t without, std::size_t with) {
    for (PlanRow& row : plan) {
      if (row.what == what) row.bytes = without - std::min(with, without);
    }
  };
  if (scene.saving.outsideRegion > 0) {
    const auto bytes = bytesEverywhere(scene, progress);
    if (!bytes && bytes.error().kind == ErrorKind::Cancelled) return fail(bytes.error());
    if (bytes) weigh(kRegionRow, *bytes, here);
  }
  if (scene.saving.outsideDevice > 0) {
    const auto bytes = bytesReaching(scene, Reach::Sealed, progress);
    if (!bytes) return fail(bytes.error());
    sealed = *bytes;
    weigh(kWorkspaceRow, sealed, here);
  }
  if (scene.saving.filledVoxels > 0) {
    const auto bytes = bytesReaching(scene, Reach::All, progress);
    if (!bytes) return fail(bytes.error());
    weigh(kCavitiesRow, *bytes, sealed);
  }
  return {};
}

}  // namespace

StepCosts measureStep(const std::shared_ptr<const PreparedScene>& scene) {
  const auto slippery = changed(*scene, [](PreparedScene& s) { s.scene.setting.friction = false; });
  const auto rough = changed(*scene, [](PreparedScene& s) { s.scene.setting.friction = true; });
  StepCosts costs;
  double step = HUGE_VAL, query = HUGE_VAL, free = HUGE_VAL, freeQuery = HUGE_VAL;
  for (int run = 0; run < kRuns; ++run) {
    const Passage pressed = pass(slippery, -kPressed), above = pass(slippery, kFree);
    step = std::min(step, pressed.step);
    query = std::min(query, queryAlone(slippery, pressed.poses));
    free = std::min(free, above.step);
    freeQuery = std::min(freeQuery, queryAlone(slippery, above.poses));
    costs.contacts = pressed.contacts;
  }
  costs.query = query;
  costs.motion = std::max(0.0, free - freeQuery);
  costs.response = std::max(0.0, step - query - costs.motion);
  costs.friction = more(rough, slippery);
  if (!scene->bodies.empty()) measureBodies(scene, costs);
  return costs;
}

Result<std::vector<PlanRow>> measuredPlan(const std::shared_ptr<const PreparedScene>& scene,
                                          WholeTree whole, const Progress& progress) {
  std::vector<PlanRow> plan = scene->plan;
  const StepCosts costs = measureStep(scene);
  double bodyPoints = 0.0;
  for (const PreparedBody& body : scene->bodies)
    bodyPoints += static_cast<double>(body.shell->size());
  std::size_t body = 0;
  for (PlanRow& row : plan) {
    const std::string_view what = row.what;
    if (what == "contact query") row.us = costs.query;
    if (what == "contact response") row.us = costs.response;
    if (what == "coupling and motion") row.us = costs.motion;
    if (what == "friction") row.us = costs.friction;
    if (what == "gravity on loose bodies") row.us = costs.gravity;
    if (what == "drag on loose bodies") row.us = costs.drag;
    if (what.starts_with("loose body ") && body < scene->bodies.size()) {
      row.us = costs.bodies * static_cast<double>(scene->bodies[body++].shell->size()) / bodyPoints;
    }
  }
  if (whole == WholeTree::Build) {
    if (auto weighed = weighWhatIsLeftOut(*scene, plan, progress); !weighed) {
      return fail(weighed.error());
    }
  }
  return plan;
}

}  // namespace palpate
