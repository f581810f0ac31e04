#pragma once
/// A box of voxels, for edits.

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/voxels/voxel_bits.h"

namespace palpate {

struct VoxelBox {
  Extent3 lo{0, 0, 0};
  Extent3 hi{0, 0, 0};  ///< Exclusive.

  [[nodiscard]] bool empty() const noexcept {
    return lo[0] >= hi[0] || lo[1] >= hi[1] || lo[2] >= hi[2];
  }
  [[nodiscard]] std::int32_t size(std::size_t a) const noexcept { return hi[a] - lo[a]; }
  [[nodiscard]] bool contains(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return i >= lo[0] && i < hi[0] && j >= lo[1] && j < hi[1] && k >= lo[2] && k < hi[2];
  }
  void include(const Extent3& voxel) noexcept {
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::min(lo[a], voxel[a]);
      hi[a] = std::max(hi[a], voxel[a] + 1);
    }
  }
  /// By so many voxels to every side, as far as the grid goes.
  [[nodiscard]] VoxelBox grown(const Extent3& steps, const Extent3& dims) const noexcept {
    VoxelBox box;
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = std::max(lo[a] - steps[a], 0);
      box.hi[a] = std::min(hi[a] + steps[a], dims[a]);
    }
    return box;
  }
  [[nodiscard]] bool operator==(const VoxelBox&) const noexcept = default;
};

/// n >= 1 bits (at most 32) from item `at` on, of a row of so many items; those past either end
/// are 0.
[[nodiscard]] inline std::uint32_t bitsAt(const std::uint64_t* row, std::int32_t items,
                                          std::int32_t at, int n) noexcept {
  std::uint64_t bits = 0;
  if (at >= items || at + n <= 0) return 0;
  if (at < 0) {
    bits = row[0] << -at;
  } else {
    bits = row[at >> 6] >> (at & 63);
    if ((at & 63) + n > 64 && (at >> 6) + 1 < (items + 63) >> 6) {
      bits |= row[(at >> 6) + 1] << (64 - (at & 63));
    }
  }
  return static_cast<std::uint32_t>(bits & ((std::uint64_t{1} << n) - 1));
}

}  // namespace palpate
