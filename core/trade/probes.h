#pragma once
/// The poses at which contacts are compared, and what the reference finds there.

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/collision/point_shell.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/reference_loop.h"
#include "core/trade/reference_shape.h"
#include "core/trade/trajectory.h"

namespace palpate {

/// What the reference finds at a pose with the points of a shell.
struct ProbedPose {
  Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
  std::uint64_t inside = 0;                            ///< Points.
  double deepest = 0.0;                                ///< m
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();  ///< Sum of depth times normal.
};

/// The reference's poses, every `stride` ticks, pressed 0.4 mm towards the hand: a rigid tool rests
/// with next to no depth.
[[nodiscard]] std::vector<ProbedPose> probedPoses(const ReferenceRun& run,
                                                  const Trajectory& trajectory,
                                                  const PointShell& finest,
                                                  const ReferenceShape& shape, std::size_t stride);

/// The same poses with another shell.
[[nodiscard]] std::vector<ProbedPose> probedWith(std::span<const ProbedPose> poses,
                                                 const PointShell& shell,
                                                 const ReferenceShape& shape);

/// Where the reference has the points of a shell at a pose: ascending shell indices. Those in
/// neither list are outside.
struct JudgedPose {
  std::vector<std::uint32_t> inside, undecided;
};

/// @param undecided  m: nearer to the surface than this is neither inside nor outside.
[[nodiscard]] std::vector<JudgedPose> judged(std::span<const ProbedPose> poses,
                                             const PointShell& shell, const ReferenceShape& shape,
                                             double undecided);
/// m: stored depths are within a thousandth of the smallest spacing.
[[nodiscard]] double undecidedOf(const PreparedScene& scene);

}  // namespace palpate
