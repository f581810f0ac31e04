#include "core/voxels/far_distance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {
namespace {

constexpr float kCap = FarDistance::kReach * FarDistance::kReach;
constexpr std::size_t kLanes = 16;

// best[l] = min over lines of line[l] + weight·steps²; `line(k)` gives line k of `n`, from `at`.
template <class F>
void refine(float* best, std::size_t width, std::int32_t at, std::int32_t n, float weight,
            F&& line) {
  for (std::size_t x = 0; x < width; x += kLanes) {
    const std::size_t lanes = std::min(kLanes, width - x);
    for (std::int32_t k = 1; k < n; ++k) {
      const float step = weight * static_cast<float>(k * k);
      float worst = 0.0f;
      for (std::size_t l = 0; l < lanes; ++l) worst = std::max(worst, best[x + l]);
      if (worst <= step) break;
      for (const std::int32_t to : {at - k, at + k}) {
        if (to < 0 || to >= n) continue;
        const float* other = line(to) + x;
        for (std::size_t l = 0; l < lanes; ++l) {
          best[x + l] = std::min(best[x + l], other[l] + step);
        }
      }
    }
  }
}

}  // namespace

FarDistance::FarDistance(const VoxelBits& solid, const DepthPalette& palette)
    : solid_(solid), palette_(palette) {
  for (std::size_t a = 0; a < 3; ++a) {
    last_[a] = solid.extent[a] - 1;
    count_[a] = (last_[a] + kStep - 1) / kStep + 1;
  }
  const auto width = static_cast<std::size_t>(count_[0]);
  const std::size_t plane = width * static_cast<std::size_t>(count_[1]);
  const std::int32_t nz = solid.extent[2];
  std::vector<float> planes(plane * static_cast<std::size_t>(nz));
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, nz), [&](const auto& range) {
    for (std::int32_t z = range.begin(); z != range.end(); ++z) {
      fillPlane(z, &planes[plane * static_cast<std::size_t>(z)]);
    }
  });
  square_.resize(plane * static_cast<std::size_t>(count_[2]));
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, count_[2]), [&](const auto& range) {
    for (std::int32_t k = range.begin(); k != range.end(); ++k) {
      const std::int32_t z = std::min(k * kStep, last_[2]);
      float* out = &square_[plane * static_cast<std::size_t>(k)];
      std::copy_n(&planes[plane * static_cast<std::size_t>(z)], plane, out);
      refine(out, plane, z, nz, palette_.weight()[2],
             [&](std::int32_t to) { return &planes[plane * static_cast<std::size_t>(to)]; });
    }
  });
}

// Squared distance along the row to its nearest voxel that is set.
void FarDistance::fillRow(const std::uint64_t* bits, float* out) const {
  const std::size_t words = solid_.rowWords;
  for (std::int32_t i = 0; i < count_[0]; ++i) {
    const std::int32_t x = std::min<std::int32_t>(i * kStep, last_[0]);
    const auto w = static_cast<std::size_t>(x >> 6);
    std::int32_t steps = 1 << 15;
    for (std::size_t r = w; r < words; ++r) {
      const std::uint64_t word = r == w ? bits[r] >> (x & 63) << (x & 63) : bits[r];
      if (word == 0) continue;
      steps = static_cast<std::int32_t>(r * 64) + std::countr_zero(word) - x;
      break;
    }
    for (std::size_t r = w + 1; r-- > 0;) {
      const std::uint64_t word = r == w ? bits[r] << (63 - (x & 63)) >> (63 - (x & 63)) : bits[r];
      if (word == 0) continue;
      const auto highest = static_cast<std::int32_t>(std::bit_width(word)) - 1;
      steps = std::min(steps, x - static_cast<std::int32_t>(r * 64) - highest);
      break;
    }
    const auto distance = static_cast<float>(steps);
    out[i] = std::min(kCap, palette_.weight()[0] * (distance * distance));
  }
}

void FarDistance::fillPlane(std::int32_t z, float* out) const {
  const auto width = static_cast<std::size_t>(count_[0]);
  const std::int32_t ny = solid_.extent[1];
  std::vector<float> rows(width * static_cast<std::size_t>(ny));
  for (std::int32_t y = 0; y < ny; ++y) {
    fillRow(solid_.row(y, z), &rows[width * static_cast<std::size_t>(y)]);
  }
  for (std::int32_t j = 0; j < count_[1]; ++j) {
    const std::int32_t y = std::min(j * kStep, last_[1]);
    float* row = out + width * static_cast<std::size_t>(j);
    std::copy_n(&rows[width * static_cast<std::size_t>(y)], width, row);
    refine(row, width, y, ny, palette_.weight()[1],
           [&](std::int32_t to) { return &rows[width * static_cast<std::size_t>(to)]; });
  }
}

float FarDistance::at(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
  const std::array<std::int32_t, 3> at{std::min(i, count_[0] - 1), std::min(j, count_[1] - 1),
                                       std::min(k, count_[2] - 1)};
  const std::array<std::int32_t, 3> asked{i, j, k};
  const std::size_t place = (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(count_[1]) +
                             static_cast<std::size_t>(at[1])) *
                                static_cast<std::size_t>(count_[0]) +
                            static_cast<std::size_t>(at[0]);
  // From the last voxel on to a place past it.
  float beyond2 = 0.0f;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto past = static_cast<float>(std::max(asked[a] * kStep - last_[a], 0));
    beyond2 += palette_.weight()[a] * (past * past);
  }
  return std::sqrt(square_[place]) - std::sqrt(beyond2);
}

}  // namespace palpate
