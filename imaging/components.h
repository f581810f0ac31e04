#pragma once
/// Connected parts of a mask, by runs along x and union-find (two passes, no recursion).
/// Source: Rosenfeld & Pfaltz 1966, on runs instead of pixels. Memory is proportional to the runs.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace palpate {

/// One run of set voxels in a row.
struct MaskRun {
  std::int32_t first = 0, last = 0;  ///< x, inclusive.
  std::uint32_t row = 0;             ///< z · ny + y.
  std::uint32_t part = 0;            ///< Index into MaskParts::voxels.
};

struct MaskParts {
  std::vector<MaskRun> runs;          ///< In the order of the voxels.
  std::vector<std::uint64_t> voxels;  ///< Voxels of each part, in the order of first voxels.
};

enum class Connectivity : std::uint8_t { Faces, Corners };  ///< 6 or 26 neighbours.

/// Which voxels of a mask are meant, and which of them touch.
struct PartsOf {
  std::uint8_t bits = 0xff;  ///< Set: any of these bits.
  bool clear = false;        ///< The voxels without any of the bits instead.
  Connectivity connectivity = Connectivity::Corners;
};

/// @param mask  x fastest; size dims[0]·dims[1]·dims[2].
[[nodiscard]] MaskParts findParts(const std::vector<std::uint8_t>& mask,
                                  const std::array<std::int32_t, 3>& dims, PartsOf of = {});

/// The part of a voxel; nothing where the voxel is in none. `row` is z · ny + y.
[[nodiscard]] std::optional<std::uint32_t> partAt(const MaskParts& parts, std::uint32_t row,
                                                  std::int32_t x);
/// Writes `value` over every voxel of the parts that are `chosen`. `nx`: voxels a row.
void fillParts(const MaskParts& parts, const std::vector<bool>& chosen, std::uint8_t value,
               std::int32_t nx, std::vector<std::uint8_t>& mask);

}  // namespace palpate
