#pragma once
/// A trajectory of a shell through a tree, timed: what `palpate collide` measures.

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/collision/contact_finder.h"
#include "core/collision/trajectory_file.h"

namespace palpate {

/// One pose: contacts and tests are the same in every repeat; the time is the median over them.
struct CollideStep {
  std::int64_t step = 0;
  std::size_t contacts = 0;
  double sumDepth_mm = 0.0;
  std::uint32_t tests = 0;
  double time_us = 0.0;  ///< The query alone, from the pose to the full contact list.
};

struct CollideQuantiles {
  double p50 = 0, p99 = 0, p999 = 0, max = 0;
};

/// Runs the whole trajectory `repeats` times, each pass with a finder of its own (a reset: nothing
/// of an earlier pass is remembered). Poses take the tool to W = P of the tree's grid. Refuses a
/// pose so far away that it cannot be computed with; cancelled where progress says so.
[[nodiscard]] Result<std::vector<CollideStep>> runCollideTrajectory(
    const VoxelTree& tree, const PointShell& shell, const QueryOptions& options,
    const std::vector<TrajectoryPose>& poses, int repeats, const Progress& progress);

/// Hands every pose's contacts, p and n in V, to `take`; untimed. `take` returns false to stop.
[[nodiscard]] Result<void> forEachPoseContacts(
    const VoxelTree& tree, const PointShell& shell, const QueryOptions& options,
    const std::vector<TrajectoryPose>& poses, const Progress& progress,
    const std::function<bool(std::int64_t step, std::span<const Contact> contacts)>& take);

/// Over the steps' times: the smallest time that this share of the steps does not exceed.
[[nodiscard]] CollideQuantiles quantilesOf(const std::vector<CollideStep>& steps);

}  // namespace palpate
