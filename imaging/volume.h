#pragma once
/// A scan as a plain value: rescaled voxels and where they are in the patient.

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/grid_geometry.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Palpate's largest grid, 1290³. A header that states more is damaged.
inline constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 31U;

enum class VoxelType : std::uint8_t { Int16, Float32 };

/// x fastest, slices ascending along row × column direction. Exactly one of the arrays is used:
/// int16 where every rescaled value is one, else float32 (interface.md, `voxels_sha256`).
struct Volume {
  GridGeometry geometry;
  VoxelType type = VoxelType::Int16;
  std::vector<std::int16_t> int16;
  std::vector<float> float32;
  std::string modality;  ///< "CT", "MR", ... ; empty when the file does not say.

  [[nodiscard]] double value(std::size_t index) const noexcept {
    return type == VoxelType::Int16 ? static_cast<double>(int16[index])
                                    : static_cast<double>(float32[index]);
  }
  [[nodiscard]] std::size_t size() const noexcept {
    return type == VoxelType::Int16 ? int16.size() : float32.size();
  }
};

/// Smallest and largest value, NaN left out; {0, 0} when empty.
[[nodiscard]] std::pair<double, double> valueRange(const Volume& volume);
/// As interface.md defines `voxels_sha256`: lower-case hex.
[[nodiscard]] std::string voxelsSha256(const Volume& volume);

/// Turns a float32 volume into int16 where every value is one (-0.0 becomes 0); else leaves it.
void narrowToInt16IfExact(Volume& volume);
/// Reverses the order of the slices; the geometry is the caller's.
void flipSliceOrder(Volume& volume);
void flipSliceOrder(LabelGrid& labels);

}  // namespace palpate
