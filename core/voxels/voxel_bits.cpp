#include "core/voxels/voxel_bits.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace palpate {
namespace {

template <class F>
void forEachSlice(std::int32_t slices, F&& f) {
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, slices), [&](const auto& range) {
    for (std::int32_t k = range.begin(); k != range.end(); ++k) f(k);
  });
}

// A row shifted by one item, towards lower and towards higher x.
std::uint64_t fromRight(const std::uint64_t* row, std::size_t w, std::size_t words) noexcept {
  return row[w] >> 1 | (w + 1 < words ? row[w + 1] << 63 : 0);
}
std::uint64_t fromLeft(const std::uint64_t* row, std::size_t w) noexcept {
  return row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 0);
}

// One bit for every 2^bits bits of a word, to the front.
std::uint64_t squeeze(std::uint64_t w, int bits) noexcept {
  for (int s = 1; s < 1 << bits; s *= 2) w |= w >> s;
  const int step = 1 << bits;
  std::uint64_t out = 0;
  for (int i = 0; i < 64 / step; ++i) out |= (w >> (i * step) & 1U) << i;
  return out;
}

}  // namespace

VoxelBits::VoxelBits(const Extent3& size)
    : extent(size),
      rowWords((static_cast<std::size_t>(size[0]) + 63) / 64),
      word(rowWords * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2])) {}

std::size_t VoxelBits::count() const {
  std::size_t n = 0;
  for (const std::uint64_t w : word) n += static_cast<std::size_t>(std::popcount(w));
  return n;
}

VoxelBits packBits(const Extent3& extent, std::span<const std::uint8_t> bytes,
                   const std::array<std::uint8_t, 256>& wanted) {
  VoxelBits bits(extent);
  const auto nx = static_cast<std::size_t>(extent[0]);
  forEachSlice(extent[2], [&](std::int32_t k) {
    for (std::int32_t j = 0; j < extent[1]; ++j) {
      const std::uint8_t* from =
          bytes.data() + (static_cast<std::size_t>(k) * static_cast<std::size_t>(extent[1]) +
                          static_cast<std::size_t>(j)) *
                             nx;
      std::uint64_t* to = bits.row(j, k);
      for (std::size_t i = 0; i < nx; i += 64) {
        const std::size_t n = std::min<std::size_t>(64, nx - i);
        std::uint64_t w = 0;
        std::uint8_t any = 0;
        for (std::size_t b = 0; b < n; ++b) any |= from[i + b];
        if (any != 0 || wanted[0] != 0) {
          for (std::size_t b = 0; b < n; ++b) {
            w |= static_cast<std::uint64_t>(wanted[from[i + b]] != 0) << b;
          }
        }
        to[i / 64] = w;
      }
    }
  });
  return bits;
}

VoxelBits surfaceOf(const VoxelBits& solid) {
  VoxelBits surface(solid.extent);
  const Extent3& e = solid.extent;
  const std::size_t words = solid.rowWords;
  const std::vector<std::uint64_t> open(words, 0);
  forEachSlice(e[2], [&](std::int32_t k) {
    for (std::int32_t j = 0; j < e[1]; ++j) {
      const std::uint64_t* at = solid.row(j, k);
      const std::uint64_t* below = k > 0 ? solid.row(j, k - 1) : open.data();
      const std::uint64_t* above = k + 1 < e[2] ? solid.row(j, k + 1) : open.data();
      const std::uint64_t* front = j > 0 ? solid.row(j - 1, k) : open.data();
      const std::uint64_t* back = j + 1 < e[1] ? solid.row(j + 1, k) : open.data();
      std::uint64_t* to = surface.row(j, k);
      for (std::size_t w = 0; w < words; ++w) {
        to[w] = at[w] & ~(below[w] & above[w] & front[w] & back[w] & fromLeft(at, w) &
                          fromRight(at, w, words));
      }
    }
  });
  return surface;
}

VoxelBits cellsOf(const VoxelBits& corners) {
  VoxelBits cells({corners.extent[0] - 1, corners.extent[1] - 1, corners.extent[2] - 1});
  const std::size_t words = corners.rowWords;
  const int last = (cells.extent[0] - 1) & 63;  // highest bit of the last word
  const std::uint64_t lastMask = ~std::uint64_t{0} >> (63 - last);
  forEachSlice(cells.extent[2], [&](std::int32_t k) {
    std::vector<std::uint64_t> any(words);
    for (std::int32_t j = 0; j < cells.extent[1]; ++j) {
      const std::uint64_t* r[4] = {corners.row(j, k), corners.row(j + 1, k), corners.row(j, k + 1),
                                   corners.row(j + 1, k + 1)};
      for (std::size_t w = 0; w < words; ++w) any[w] = r[0][w] | r[1][w] | r[2][w] | r[3][w];
      std::uint64_t* to = cells.row(j, k);
      for (std::size_t w = 0; w < cells.rowWords; ++w) {
        to[w] = any[w] | fromRight(any.data(), w, words);
      }
      to[cells.rowWords - 1] &= lastMask;
    }
  });
  return cells;
}

VoxelBits coarser(const VoxelBits& fine, int bits) {
  const auto half = [bits](std::int32_t n) { return ((n - 1) >> bits) + 1; };
  VoxelBits out({half(fine.extent[0]), half(fine.extent[1]), half(fine.extent[2])});
  const std::int32_t edge = 1 << bits;
  const int perWord = 64 >> bits;
  forEachSlice(out.extent[2], [&](std::int32_t k) {
    std::vector<std::uint64_t> any(fine.rowWords);
    for (std::int32_t j = 0; j < out.extent[1]; ++j) {
      std::fill(any.begin(), any.end(), 0);
      for (std::int32_t z = k * edge; z < std::min((k + 1) * edge, fine.extent[2]); ++z) {
        for (std::int32_t y = j * edge; y < std::min((j + 1) * edge, fine.extent[1]); ++y) {
          const std::uint64_t* from = fine.row(y, z);
          for (std::size_t w = 0; w < any.size(); ++w) any[w] |= from[w];
        }
      }
      std::uint64_t* to = out.row(j, k);
      for (std::size_t w = 0; w < any.size(); ++w) {
        if (any[w] == 0) continue;
        const std::size_t bit = w * static_cast<std::size_t>(perWord);
        to[bit / 64] |= squeeze(any[w], bits) << (bit % 64);
      }
    }
  });
  return out;
}

}  // namespace palpate
