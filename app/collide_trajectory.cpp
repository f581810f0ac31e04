#include "app/collide_trajectory.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

#include "core/geometry/units.h"

namespace palpate {
namespace {

Error tooFar(std::int64_t step) {
  return inputRefused("The pose of step " + std::to_string(step) + " cannot be computed with.")
      .inField("tx..tz")
      .advise("Its translation is too large; give millimetres.");
}

double medianOf(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

Result<std::vector<CollideStep>> runCollideTrajectory(const VoxelTree& tree,
                                                      const PointShell& shell,
                                                      const QueryOptions& options,
                                                      const std::vector<TrajectoryPose>& poses,
                                                      int repeats, const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const Eigen::Isometry3d X_VP = tree.geometry().X_PV.inverse();
  std::vector<CollideStep> steps(poses.size());
  std::vector<std::vector<double>> times(poses.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    ContactFinder finder(tree, shell, options);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (progress.cancelled()) return fail(cancelled());
      const auto start = Clock::now();
      const QueryResult result = finder.findPacked(X_VP * poses[i].X_WT);
      const auto end = Clock::now();
      if (result.status == QueryStatus::BadPose) return fail(tooFar(poses[i].step));
      times[i].push_back(std::chrono::duration<double, std::micro>(end - start).count());
      if (repeat > 0) continue;
      CollideStep& step = steps[i];
      step.step = poses[i].step;
      step.contacts = result.contactCount;
      step.tests = result.tests;
      const PackedContacts& found = finder.packed();
      for (std::size_t c = 0; c < found.count; ++c) {
        step.sumDepth_mm += millimetres(static_cast<double>(found.depth[c]));
      }
    }
    progress(static_cast<double>(repeat + 1) / repeats, "Measuring");
  }
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].time_us = medianOf(times[i]);
  return steps;
}

Result<void> forEachPoseContacts(
    const VoxelTree& tree, const PointShell& shell, const QueryOptions& options,
    const std::vector<TrajectoryPose>& poses, const Progress& progress,
    const std::function<bool(std::int64_t, std::span<const Contact>)>& take) {
  const Eigen::Isometry3d X_VP = tree.geometry().X_PV.inverse();
  ContactFinder finder(tree, shell, options);
  std::vector<Contact> contacts(shell.size());
  for (const TrajectoryPose& pose : poses) {
    if (progress.cancelled()) return fail(cancelled());
    const QueryResult result = finder.find(X_VP * pose.X_WT, contacts);
    if (result.status == QueryStatus::BadPose) return fail(tooFar(pose.step));
    if (!take(pose.step, std::span(contacts).first(result.contactCount))) break;
  }
  return {};
}

CollideQuantiles quantilesOf(const std::vector<CollideStep>& steps) {
  if (steps.empty()) return {};
  std::vector<double> times;
  for (const CollideStep& step : steps) times.push_back(step.time_us);
  std::sort(times.begin(), times.end());
  const auto at = [&times](double share) {
    const double rank = std::ceil(share * static_cast<double>(times.size()));
    return times[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
  };
  return {at(0.5), at(0.99), at(0.999), times.back()};
}

}  // namespace palpate
