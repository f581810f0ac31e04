#include "app/collide_clearance.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <chrono>
#include <utility>

#include "core/collision/clearance_finder.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

template <class T>
void append(std::string& text, T value, char after) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  text.append(digits.data(), end);
  text.push_back(after);
}

Result<void> checkLabels(const LabelGrid& grid, const std::vector<int>& labels) {
  std::array<bool, 256> present{};
  for (const std::uint8_t label : grid.labels) present[label] = true;
  for (const int label : labels) {
    if (present[static_cast<std::size_t>(label)]) continue;
    std::string known;
    for (std::size_t i = 1; i < present.size(); ++i) {
      if (present[i]) known += (known.empty() ? "" : ", ") + std::to_string(i);
    }
    return fail(inputRefused("The world has no voxel of a label to keep clear of.")
                    .inField("--clearance-labels")
                    .butFound(std::to_string(label))
                    .wants(known.empty() ? "a world with labels" : "some of " + known)
                    .advise("Give labels that the world has."));
  }
  return {};
}

ClearanceStep stepOf(std::int64_t number, const Clearance& c, const ClearanceWorld& world) {
  ClearanceStep step;
  step.step = number;
  step.withinReach = c.status == ClearanceStatus::Complete;
  if (!step.withinReach) return step;
  step.clearance_mm = millimetres(c.distance);
  step.index = c.shellIndex;
  step.label = world.grid.at(c.voxel[0], c.voxel[1], c.voxel[2]);
  const Eigen::Isometry3d& X_WV = world.grid.geometry.X_PV;
  const Eigen::Vector3d tool = X_WV * Eigen::Vector3d(c.tool[0], c.tool[1], c.tool[2]);
  const Eigen::Vector3d anatomy = X_WV * Eigen::Vector3d(c.anatomy[0], c.anatomy[1], c.anatomy[2]);
  for (std::size_t a = 0; a < 3; ++a) {
    step.tool_mm[a] = millimetres(tool[static_cast<Eigen::Index>(a)]);
    step.anatomy_mm[a] = millimetres(anatomy[static_cast<Eigen::Index>(a)]);
  }
  return step;
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  if (values.size() % 2 == 1) return values[middle];
  return 0.5 * (values[middle - 1] + values[middle]);
}

}  // namespace

void addCollideClearanceOptions(CLI::App& command, CollideClearanceOptions& options) {
  CLI::Option* file = command.add_option(
      "--clearance", options.file,
      "CSV of the smallest distance to the anatomy's voxels, and where: step,clearance_mm,index,"
      "tool_x,tool_y,tool_z,x,y,z,label,time_us; world axes, mm. 0 inside; out of reach inf, with "
      "index to label empty");
  command
      .add_option("--clearance-labels", options.labels,
                  "Labels to keep clear of, as 3,4; every one but 0 if not given")
      ->delimiter(',')
      ->check(CLI::Range(1, 255))
      ->needs(file);
  command
      .add_option("--clearance-reach", options.reach_mm,
                  "Farther than this is not looked at, mm; everything is if not given")
      ->check(CLI::NonNegativeNumber)
      ->needs(file);
}

Result<ClearanceWorld> buildClearanceWorld(LabelGrid grid, const CollideClearanceOptions& options,
                                           Branching branching, int threads,
                                           const Progress& progress) {
  if (auto ok = checkLabels(grid, options.labels); !ok) return fail(ok.error());
  std::vector<std::uint8_t> labels;
  for (const int label : options.labels) labels.push_back(static_cast<std::uint8_t>(label));
  auto tree =
      VoxelTree::build(grid, labels, {branching, LeafModel::Voxel, false, threads}, progress);
  if (!tree) return fail(tree.error());
  return ClearanceWorld{std::move(grid), std::move(*tree)};
}

Result<std::vector<ClearanceStep>> runClearanceTrajectory(const ClearanceWorld& world,
                                                          const PointShell& shell,
                                                          const CollideClearanceOptions& options,
                                                          const std::vector<TrajectoryPose>& poses,
                                                          int repeats, const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  const Eigen::Isometry3d X_VP = world.grid.geometry.X_PV.inverse();
  std::vector<ClearanceStep> steps;
  std::vector<std::vector<double>> times(poses.size());
  for (int repeat = 0; repeat < repeats; ++repeat) {
    auto finder = ClearanceFinder::create(world.tree, shell, {metres(options.reach_mm)});
    if (!finder) return fail(finder.error());
    for (std::size_t i = 0; i < poses.size(); ++i) {
      if (progress.cancelled()) return fail(cancelled());
      const auto start = Clock::now();
      const Clearance found = finder->find(X_VP * poses[i].X_WT);
      const auto end = Clock::now();
      if (found.status == ClearanceStatus::BadPose) {
        return fail(inputRefused("The pose of step " + std::to_string(poses[i].step) +
                                 " cannot be computed with.")
                        .inField("tx..tz")
                        .advise("Its translation is too large; give millimetres."));
      }
      times[i].push_back(std::chrono::duration<double, std::micro>(end - start).count());
      if (repeat == 0) steps.push_back(stepOf(poses[i].step, found, world));
    }
  }
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i].time_us = medianOf(std::move(times[i]));
  return steps;
}

std::string clearanceCsv(const std::vector<ClearanceStep>& steps) {
  std::string text = "step,clearance_mm,index,tool_x,tool_y,tool_z,x,y,z,label,time_us\n";
  for (const ClearanceStep& step : steps) {
    append(text, step.step, ',');
    if (step.withinReach) {
      append(text, step.clearance_mm, ',');
      append(text, step.index, ',');
      for (const double mm : step.tool_mm) append(text, mm, ',');
      for (const double mm : step.anatomy_mm) append(text, mm, ',');
      append(text, static_cast<unsigned>(step.label), ',');
    } else {
      text += "inf,,,,,,,,,";
    }
    append(text, step.time_us, '\n');
  }
  return text;
}

const ClearanceStep* nearestOf(const std::vector<ClearanceStep>& steps) {
  const ClearanceStep* nearest = nullptr;
  for (const ClearanceStep& step : steps) {
    const bool nearer = nearest == nullptr || step.clearance_mm < nearest->clearance_mm;
    if (step.withinReach && nearer) nearest = &step;
  }
  return nearest;
}

nlohmann::ordered_json clearanceJson(const CollideClearanceOptions& options,
                                     const std::vector<ClearanceStep>& steps) {
  std::vector<CollideStep> timed;
  std::size_t beyond = 0;
  for (const ClearanceStep& step : steps) {
    timed.push_back({step.step, 0, 0.0, 0, step.time_us});
    beyond += step.withinReach ? 0 : 1;
  }
  const CollideQuantiles times = quantilesOf(timed);
  nlohmann::ordered_json json{
      {"labels", options.labels},
      {"min_mm", nullptr},
      {"min_step", nullptr},
      {"beyond_reach", beyond},
      {"step_us",
       {{"p50", times.p50}, {"p99", times.p99}, {"p999", times.p999}, {"max", times.max}}}};
  if (const ClearanceStep* nearest = nearestOf(steps)) {
    json["min_mm"] = nearest->clearance_mm;
    json["min_step"] = nearest->step;
  }
  return json;
}

}  // namespace palpate
