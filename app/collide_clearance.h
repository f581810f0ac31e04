#pragma once
/// `palpate collide --clearance`: over the same poses, the smallest distance of the tool to chosen
/// labels of the world, and where (core/collision/clearance_finder.h).

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/collide_trajectory.h"
#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/collision/point_shell.h"
#include "core/collision/trajectory_file.h"
#include "core/voxels/label_grid.h"
#include "core/voxels/voxel_tree.h"

namespace CLI {
class App;
}

namespace palpate {

struct CollideClearanceOptions {
  std::filesystem::path file;  ///< Empty: not asked for.
  std::vector<int> labels;     ///< Empty: every one but 0.
  double reach_mm = std::numeric_limits<double>::infinity();
};

/// Adds --clearance, --clearance-labels and --clearance-reach. `options` outlives `command`.
void addCollideClearanceOptions(CLI::App& command, CollideClearanceOptions& options);

/// The labels to keep clear of, ready to be asked.
struct ClearanceWorld {
  LabelGrid grid;
  VoxelTree tree;
};

/// Refuses a label of which the world has no voxel: nobody is to trust a clearance to a structure
/// that is not there.
[[nodiscard]] Result<ClearanceWorld> buildClearanceWorld(LabelGrid grid,
                                                         const CollideClearanceOptions& options,
                                                         Branching branching, int threads,
                                                         const Progress& progress);

/// One pose. Points in W = P of the world, mm.
struct ClearanceStep {
  std::int64_t step = 0;
  bool withinReach = false;  ///< False: nothing below is set but the time.
  double clearance_mm = 0.0;
  std::uint32_t index = 0;  ///< Of the shell point.
  std::array<double, 3> tool_mm{}, anatomy_mm{};
  std::uint8_t label = 0;
  double time_us = 0.0;  ///< The query alone; median over the repeats.
};

/// As runCollideTrajectory: each pass has a finder of its own.
[[nodiscard]] Result<std::vector<ClearanceStep>> runClearanceTrajectory(
    const ClearanceWorld& world, const PointShell& shell, const CollideClearanceOptions& options,
    const std::vector<TrajectoryPose>& poses, int repeats, const Progress& progress);

/// `step,clearance_mm,index,tool_x,tool_y,tool_z,x,y,z,label,time_us`. Out of reach clearance_mm is
/// inf, and index to label are empty.
[[nodiscard]] std::string clearanceCsv(const std::vector<ClearanceStep>& steps);

/// The nearest step, of equals the first; nullptr where every pose is out of reach.
[[nodiscard]] const ClearanceStep* nearestOf(const std::vector<ClearanceStep>& steps);

/// `labels, min_mm, min_step, beyond_reach, step_us{p50,p99,p999,max}`; min_mm and min_step are
/// null where every pose is out of reach.
[[nodiscard]] nlohmann::ordered_json clearanceJson(const CollideClearanceOptions& options,
                                                   const std::vector<ClearanceStep>& steps);

}  // namespace palpate
