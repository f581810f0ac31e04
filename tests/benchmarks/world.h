#pragma once
/// The worlds of the benchmarks.

#include <cstdint>
#include <string>
#include <vector>

#include "core/voxels/label_grid.h"

namespace palpate::bench {

inline constexpr double kWorldSize = 0.1;  ///< Edge of the synthetic world, metres.

/// Synthetic bone in a cube of n³ voxels and 100 mm: a rounded box, turned against the axes, with
/// a cortical shell of 2.6 mm around a gyroid core; about a tenth is solid.
[[nodiscard]] LabelGrid syntheticBone(int n);
/// The same bone in n x ny x nz voxels of different spacings.
[[nodiscard]] LabelGrid syntheticBone(int nx, int ny, int nz);

/// The frame of the box: its centre, and axes along its edges; the upper face is at +z.
[[nodiscard]] Eigen::Isometry3d boneFrame();
inline constexpr double kBoneTop = 36e-3;  ///< Height of the upper face in that frame, metres.

/// Distance of a point to the bone's outer surface, metres, positive outside. For trajectories.
[[nodiscard]] double boneSurface(const Eigen::Vector3d& p_V);

}  // namespace palpate::bench
