#include "core/trade/felt.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/geometry/pose.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

constexpr double kTick = 1e-3;

Eigen::Vector3d vector(const double (&v)[3]) {
  return {v[0], v[1], v[2]};
}

void nothingFelt(Felt& felt, const DeviceSample& sample) {
  felt.force_W.emplace_back(0.0, 0.0, 0.0);
  felt.torque_W.emplace_back(0.0, 0.0, 0.0);
  felt.tool_W.push_back(position(sample.pose));
}

/// The servo's answer to a sample from a state that held `late` seconds ago.
void answer(const CouplingGains& gains, const ToolState& state, double late,
            const DeviceSample& sample, Felt& felt) {
  const PlainPose moved =
      plain(position(state.pose) + late * vector(state.v),
            (expMap(late * vector(state.w)) * orientation(state.pose)).normalized());
  const Wrench wrench =
      couplingWrench(softened(gains, state.stiffnessShare), moved, state.v, state.w, sample);
  felt.force_W.push_back(vector(wrench.force));
  felt.torque_W.push_back(vector(wrench.torque));
  felt.tool_W.push_back(position(moved));
}

Pass runOnce(const std::shared_ptr<const PreparedScene>& scene, const CouplingGains& gains,
             const Trajectory& trajectory) {
  Pass pass;
  Simulation simulation(scene, gains);
  const std::uint64_t every = simulation.stepTicks();
  ToolState state, next;
  for (const DeviceSample& sample : trajectory.samples) {
    if (next.step > 0 && sample.index >= next.dueTick) state = next;
    if (state.step == 0) {
      nothingFelt(pass.felt, sample);
    } else {
      const double late = kTick * static_cast<double>(sample.index - state.dueTick);
      answer(gains, state, late, sample, pass.felt);
    }
    if (sample.index % every != 0) continue;
    const StepRecord& record = simulation.step(sample);
    next = simulation.tool();
    pass.micros.push_back(record.micros);
    pass.tests.push_back(record.tests);
    pass.contacts.push_back(record.contacts);
  }
  return pass;
}

/// Of the surface that is nearest to a place.
std::function<double(const Eigen::Vector3d&)> frictionOf(const PreparedScene& scene) {
  if (!scene.scene.setting.friction) return {};
  const Eigen::Isometry3d X_VW = scene.X_WV.inverse();
  const auto labels = scene.labels;
  const SurfaceTable surface = scene.instrumentSurface;
  return [X_VW, labels, surface](const Eigen::Vector3d& p_W) {
    const auto at = labels->geometry.voxelAt(X_VW * p_W);
    int best = 4;
    double friction = 0.0;
    for (int code = 0; code < 27; ++code) {
      const std::int32_t di = code % 3 - 1, dj = code / 3 % 3 - 1, dk = code / 9 - 1;
      const std::int32_t i = at[0] + di, j = at[1] + dj, k = at[2] + dk;
      const int away = std::abs(di) + std::abs(dj) + std::abs(dk);
      if (away >= best || !labels->geometry.contains(i, j, k)) continue;
      const std::uint8_t label = labels->at(i, j, k);
      if (label == 0) continue;
      best = away;
      friction = surface[label].friction;
    }
    return friction;
  };
}

}  // namespace

Pass runPass(const std::shared_ptr<const PreparedScene>& scene, const CouplingGains& gains,
             const Trajectory& trajectory, int repeats) {
  Pass pass = runOnce(scene, gains, trajectory);  // every repeat gives the same bits but for times
  std::vector<std::vector<double>> times;
  for (const double micros : pass.micros) times.push_back({micros});
  for (int repeat = 1; repeat < repeats; ++repeat) {
    const Pass again = runOnce(scene, gains, trajectory);
    for (std::size_t i = 0; i < times.size(); ++i) times[i].push_back(again.micros[i]);
  }
  for (std::size_t i = 0; i < times.size(); ++i) {
    std::sort(times[i].begin(), times[i].end());
    pass.micros[i] = times[i][times[i].size() / 2];
    pass.slowest.push_back(times[i].back());
  }
  return pass;
}

Pass runReferencePass(const PreparedScene& scene, const PointShell& shell,
                      const CouplingGains& gains, const ReferenceShape& shape,
                      const Trajectory& trajectory, ReferenceRun* poses) {
  ReferenceTool tool;
  tool.mass = scene.instrument.massProperties;
  tool.points_T.assign(shell.points_T().begin(), shell.points_T().end());
  tool.stiffness = gains.stiffness;
  tool.damping = gains.damping;
  tool.stiffnessR = gains.stiffnessR;
  tool.dampingR = gains.dampingR;
  tool.frictionAt = frictionOf(scene);
  ReferenceRun run = runReference(tool, shape, trajectory.samples);
  Pass pass;
  pass.settled = run.settled;
  for (std::size_t i = 0; i < run.tool.size(); ++i) {
    if (i == 0) {
      nothingFelt(pass.felt, trajectory.samples[i]);
      continue;
    }
    ToolState state;
    state.pose = run.tool[i - 1];
    std::copy_n(run.v[i - 1].data(), 3, state.v);
    std::copy_n(run.w[i - 1].data(), 3, state.w);
    answer(gains, state, 0.0, trajectory.samples[i], pass.felt);
  }
  pass.micros = run.micros;
  if (poses != nullptr) *poses = std::move(run);
  return pass;
}

}  // namespace palpate
