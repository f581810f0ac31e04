#pragma once
/// Signed squared distances of a window of a grid, as banded_distance.h makes them.

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

/// Signed squares of some slices of a grid (banded_distance.h), or of a window of it.
struct SquareView {
  const float* square = nullptr;
  std::array<std::int32_t, 3> origin{0, 0, 0};  ///< Voxel of the first value.
  std::array<std::int32_t, 3> extent{0, 0, 0};  ///< Values along x, y, z.

  /// Place of the first value of a row.
  [[nodiscard]] std::size_t rowAt(std::int32_t j, std::int32_t k) const noexcept {
    return (static_cast<std::size_t>(k - origin[2]) * static_cast<std::size_t>(extent[1]) +
            static_cast<std::size_t>(j - origin[1])) *
           static_cast<std::size_t>(extent[0]);
  }
  [[nodiscard]] float at(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return square[rowAt(j, k) + static_cast<std::size_t>(i - origin[0])];
  }
};

}  // namespace palpate
