#pragma once
/// The part of a label volume that a tool works on: a box of voxels with eight planes of one bit.
///
/// One byte a voxel holds the label, what a tool makes of it, and what it needs in between, so that
/// a large scan fits. Work goes in slabs of slices where a filter needs wider numbers.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/voxels/label_grid.h"

namespace palpate {

/// Voxels low..high, both inclusive; empty where low > high.
struct VoxelBox {
  std::array<std::int32_t, 3> low{0, 0, 0}, high{-1, -1, -1};

  [[nodiscard]] bool empty() const noexcept {
    return low[0] > high[0] || low[1] > high[1] || low[2] > high[2];
  }
  [[nodiscard]] std::array<std::int32_t, 3> dims() const noexcept {
    return {high[0] - low[0] + 1, high[1] - low[1] + 1, high[2] - low[2] + 1};
  }
};

[[nodiscard]] VoxelBox wholeBox(const GridGeometry& geometry);
/// The smallest box with all voxels of that value.
[[nodiscard]] VoxelBox boundsOf(const LabelGrid& labels, std::uint8_t value);
[[nodiscard]] VoxelBox unite(const VoxelBox& a, const VoxelBox& b);
/// Grown by whole voxels that cover `mm`, and cut at the scan's edge.
[[nodiscard]] VoxelBox grownBy(const VoxelBox& box, double mm, const GridGeometry& geometry);
/// Spacing in mm.
[[nodiscard]] inline Eigen::Vector3d spacing_mm(const GridGeometry& geometry) {
  return geometry.spacing * 1e3;
}

/// Bits of a block's voxels.
namespace plane {
inline constexpr std::uint8_t kMask = 1;  ///< The label; when a tool is done, its result.
inline constexpr std::uint8_t kA = 2, kB = 4, kC = 8;
}  // namespace plane

struct MaskBlock {
  VoxelBox box;
  std::array<std::int32_t, 3> dims{0, 0, 0};
  Eigen::Vector3d spacing_mm = Eigen::Vector3d::Ones();
  std::vector<std::uint8_t> voxels;  ///< x fastest.
  /// What a slab of a filter may take; nothing of a result depends on it.
  std::size_t slabBytes = std::size_t{64} << 20U;

  [[nodiscard]] std::size_t sliceVoxels() const noexcept {
    return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]);
  }
  [[nodiscard]] std::size_t index(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(dims[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(dims[0]) +
           static_cast<std::size_t>(x);
  }
};

/// The box with kMask set where the label is `value`.
[[nodiscard]] MaskBlock blockOf(const LabelGrid& labels, std::uint8_t value, const VoxelBox& box);

/// Calls `row(first, count, x0, y, z)` for each row of the box: `first` is the linear index in the
/// grid of its first voxel. Parallel over slices; `row` touches nothing of other rows.
void forEachRow(
    const GridGeometry& geometry, const VoxelBox& box,
    const std::function<void(std::size_t, std::int32_t, std::int32_t, std::int32_t)>& row);

/// Copies plane `from` to plane `to`, or its complement.
void copyPlane(MaskBlock& block, std::uint8_t from, std::uint8_t to, bool complement = false);
[[nodiscard]] bool anySet(const MaskBlock& block, std::uint8_t bits);

}  // namespace palpate
