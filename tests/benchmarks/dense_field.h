#pragma once
/// The signed distance of design.md's distance leaf at every voxel centre, as one dense array.
///
/// What the dense peers look up, and what the tree's structures are checked against. The unit of
/// length is the smallest spacing: values are dist - 1/2 outside and -(dist - 1/2) inside, with
/// dist the exact Euclidean distance to the nearest centre of the other kind.

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxels/label_grid.h"
#include "tests/benchmarks/huge_buffer.h"

namespace palpate::bench {

struct DenseField {
  std::array<std::int32_t, 3> dims{0, 0, 0};
  std::array<double, 3> spacing{1e-3, 1e-3, 1e-3};  ///< Metres.
  double unit = 1e-3;                               ///< The smallest of them.
  HugeBuffer<float> value;  ///< x fastest; one more row and slice are readable past the end.

  [[nodiscard]] std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(dims[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(dims[0]) +
           static_cast<std::size_t>(i);
  }
  [[nodiscard]] bool cubic() const noexcept {
    return spacing[0] == spacing[1] && spacing[1] == spacing[2];
  }
  [[nodiscard]] float at(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return value[index(i, j, k)];
  }
};

/// Every non-zero label is solid. The grid needs both kinds.
///
/// Method: one signed square distance a voxel, refined axis by axis in place; along a line a voxel
/// of one kind sees its own kind's values and zero at the other kind, so both transforms are one
/// pass. A search widens until its square step alone exceeds the best found; 16 lines at a time.
[[nodiscard]] DenseField denseField(const LabelGrid& grid);

}  // namespace palpate::bench
