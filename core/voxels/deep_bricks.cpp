#include "core/voxels/deep_bricks.h"

#include <algorithm>
#include <cmath>

#include "core/voxels/clearance_word.h"
#include "core/voxels/depth_bricks.h"
#include "core/voxels/distance_field.h"
#include "core/voxels/outward_normal.h"

namespace palpate {
namespace {

constexpr int kSide = 5;  // components −2 .. 2

}  // namespace

void appendDeepBricks(const DepthPalette& palette, LargeArray<std::uint32_t>& slots) {
  for (int number = 0; number < kSide * kSide * kSide; ++number) {
    const int d[3] = {number % kSide - 2, number / kSide % kSide - 2, number / (kSide * kSide) - 2};
    std::uint32_t rows[2 * DepthBricks::kSlotWords] = {};
    for (int z = 0; z < 5; ++z) {
      for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 5; ++x) {
          // Shallower along the direction: rungs ascend with depth.
          const int rung = 32 - (d[0] * (x - 2) + d[1] * (y - 2) + d[2] * (z - 2));
          const std::uint32_t code = palette.rung(rung);
          const int row = y + 5 * z;
          rows[row] |= (code & 63U) << (6 * x);
          rows[static_cast<std::size_t>(row) + DepthBricks::kSlotWords] |= code >> 6 << (6 * x);
        }
      }
    }
    rows[DepthBricks::kRows] = ClearanceWord::kNever;
    slots.append(rows, 2 * DepthBricks::kSlotWords);
  }
}

DeepDirections::DeepDirections(const VoxelBits& deep, const Eigen::Vector3d& spacing) {
  geometry_.dims = deep.extent;
  geometry_.spacing = spacing;
  std::vector<std::uint8_t> solid(geometry_.voxelCount());
  std::size_t at = 0;
  for (std::int32_t k = 0; k < deep.extent[2]; ++k) {
    for (std::int32_t j = 0; j < deep.extent[1]; ++j) {
      for (std::int32_t i = 0; i < deep.extent[0]; ++i) solid[at++] = deep.test(i, j, k) ? 1 : 0;
    }
  }
  field_ = *signedDistanceField(geometry_, solid);  // without a cancel it cannot fail
}

std::uint32_t DeepDirections::brickFor(const std::array<std::int32_t, 3>& block) const {
  const Eigen::Vector3d n = outwardNormal(geometry_, field_, block[0], block[1], block[2]);
  // Per cell, not per length: the ramp is along the grid's axes.
  const Eigen::Vector3d slope = n.cwiseProduct(geometry_.spacing);
  const double largest = slope.cwiseAbs().maxCoeff();
  std::uint32_t number = 0;
  for (int a = 2; a >= 0; --a) {
    const auto step = static_cast<int>(std::lround(2.0 * slope[a] / largest));
    number = number * kSide + static_cast<std::uint32_t>(step + 2);
  }
  return number;
}

}  // namespace palpate
