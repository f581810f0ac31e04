#pragma once
/// Bricks deeper than saturation all over: their depth says no more than that, so they share a few
/// bricks that only know the way out.
///
/// A shared brick is a ramp of depths beyond saturation along one of 124 directions (components −2
/// .. 2 in cells), so the query needs no case for it. The direction comes from the distance between
/// blocks of 4³ cells: mostly right within 20 degrees, at worst 30, which saturation says.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/large_array.h"
#include "core/geometry/grid_geometry.h"
#include "core/voxels/depth_palette.h"
#include "core/voxels/voxel_bits.h"

namespace palpate {

/// Appends the shared bricks, two slots each (they are wide), with no clearance.
void appendDeepBricks(const DepthPalette& palette, LargeArray<std::uint32_t>& slots);

/// Which shared brick a deep block takes.
class DeepDirections {
 public:
  /// @param deep  one bit a block of 4³ cells.
  DeepDirections(const VoxelBits& deep, const Eigen::Vector3d& spacing);
  /// Number of the shared brick, from 0.
  [[nodiscard]] std::uint32_t brickFor(const std::array<std::int32_t, 3>& block) const;

 private:
  GridGeometry geometry_;  // of the blocks
  std::vector<float> field_;
};

}  // namespace palpate
