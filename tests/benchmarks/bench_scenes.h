#pragma once
/// Synthetic scenes for the benchmarks: a bone with a shell and a porous core, a drill over it.

#include <Eigen/Geometry>
#include <vector>

#include "core/collision/point_shell.h"
#include "core/voxels/label_grid.h"

namespace palpate::bench {

inline constexpr double kWorldSize = 0.1;  ///< Edge of the world, metres.

/// An ellipsoid of bone in a cube of n³ voxels: a cortical shell of 2.5 mm around a gyroid.
[[nodiscard]] LabelGrid bone(int n);

/// About `points` even points on a drill: a burr of 4 mm radius and a shaft of 60 mm along +z.
[[nodiscard]] PointShell drill(std::size_t points);

/// Poses of a tool that slides over the bone with its burr `press` metres deep.
[[nodiscard]] std::vector<Eigen::Isometry3d> slide(double press, int steps);

}  // namespace palpate::bench
