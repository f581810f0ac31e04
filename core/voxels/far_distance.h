#pragma once
/// How far the solid is from every fourth voxel centre, out to where clearances end.
///
/// Exact squared distances outside (0 inside), smallest spacings; what clearances of far blocks
/// are made of, for a sixteenth of the cost of a whole transform and less. Separable as
/// banded_distance.h, but only the sampled places are carried from axis to axis.

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxels/depth_palette.h"
#include "core/voxels/voxel_bits.h"

namespace palpate {

class FarDistance {
 public:
  static constexpr std::int32_t kStep = 4;  ///< Voxels between samples.
  static constexpr float kReach = 130.0f;   ///< Farther is not told apart.

  FarDistance(const VoxelBits& solid, const DepthPalette& palette);

  /// Samples along an axis: the last one may lie past the last voxel.
  [[nodiscard]] const std::array<std::int32_t, 3>& count() const noexcept { return count_; }
  /// A lower bound of the distance from place (kStep·i, kStep·j, kStep·k) to any solid centre;
  /// exact within the grid, ever lower past its end.
  [[nodiscard]] float at(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept;

 private:
  void fillRow(const std::uint64_t* bits, float* out) const;
  void fillPlane(std::int32_t z, float* out) const;

  const VoxelBits& solid_;
  const DepthPalette& palette_;
  std::array<std::int32_t, 3> count_{}, last_{};  // samples; voxels less one
  std::vector<float> square_;                     // x fastest
};

}  // namespace palpate
