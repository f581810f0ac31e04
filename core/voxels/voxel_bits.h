#pragma once
/// A dense occupancy, one bit an item, for the builders: 64 items a word along x.
///
/// 1/8 byte a voxel, so that the passes over a whole volume (surface, cells, coarser levels) are
/// passes over little memory. Plain values; functions are parallel inside, same result at any
/// number of threads.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

using Extent3 = std::array<std::int32_t, 3>;

struct VoxelBits {
  Extent3 extent{0, 0, 0};
  std::size_t rowWords = 0;  ///< Words along x; bits past the extent are zero.
  std::vector<std::uint64_t> word;

  VoxelBits() = default;
  explicit VoxelBits(const Extent3& size);

  [[nodiscard]] std::size_t rowAt(std::int32_t j, std::int32_t k) const noexcept {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(extent[1]) +
            static_cast<std::size_t>(j)) *
           rowWords;
  }
  [[nodiscard]] const std::uint64_t* row(std::int32_t j, std::int32_t k) const noexcept {
    return word.data() + rowAt(j, k);
  }
  [[nodiscard]] std::uint64_t* row(std::int32_t j, std::int32_t k) noexcept {
    return word.data() + rowAt(j, k);
  }
  [[nodiscard]] bool test(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return (row(j, k)[i >> 6] >> (i & 63) & 1U) != 0;
  }
  void set(std::int32_t i, std::int32_t j, std::int32_t k) noexcept {
    row(j, k)[i >> 6] |= std::uint64_t{1} << (i & 63);
  }
  [[nodiscard]] std::size_t count() const;
};

/// Bit set where `wanted[value]` is not 0. Bytes x fastest.
[[nodiscard]] VoxelBits packBits(const Extent3& extent, std::span<const std::uint8_t> bytes,
                                 const std::array<std::uint8_t, 256>& wanted);
/// Surface voxels: solid, and a face neighbour is empty or outside the grid.
[[nodiscard]] VoxelBits surfaceOf(const VoxelBits& solid);
/// Cells between voxel centres with a corner that is set; extent one less along every axis.
[[nodiscard]] VoxelBits cellsOf(const VoxelBits& corners);
/// Which boxes of 2^bits items a side hold anything.
[[nodiscard]] VoxelBits coarser(const VoxelBits& fine, int bits);

}  // namespace palpate
