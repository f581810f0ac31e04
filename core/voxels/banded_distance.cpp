#include "core/voxels/banded_distance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/voxels/axis_distance.h"

namespace palpate {
namespace {

constexpr std::size_t kTile = 16;

// One tile of lines, aligned for whole vectors.
class Lines {
 public:
  explicit Lines(std::size_t n) : store_(n * kTile + kTile) {}
  [[nodiscard]] float* data() noexcept {
    const auto at = reinterpret_cast<std::uintptr_t>(store_.data());
    return reinterpret_cast<float*>((at + 63) / 64 * 64);
  }

 private:
  std::vector<float> store_;
};

}  // namespace

BandedDistance::BandedDistance(const VoxelBits& solid, const DepthPalette& palette, float outside)
    : solid_(solid),
      palette_(palette),
      farCap_(std::max(palette.farSquare() + 0.5f, outside * outside)),
      deepCap_(palette.deepSquare() + 0.5f),
      reach_(
          static_cast<std::int32_t>(std::sqrt(std::max(farCap_, deepCap_) / palette.weight()[2])) +
          1) {}

void BandedDistance::fillPlane(std::int32_t z, std::vector<float>& plane) const {
  const auto nx = static_cast<std::size_t>(solid_.extent[0]);
  const auto ny = static_cast<std::size_t>(solid_.extent[1]);
  plane.resize(nx * ny);
  const RowSpan whole{0, solid_.extent[0], 0, solid_.extent[0]};
  const SquareCaps caps{farCap_, deepCap_};
  for (std::size_t j = 0; j < ny; ++j) {
    squaresAlongRow(solid_.row(static_cast<std::int32_t>(j), z), whole, palette_.weight()[0], caps,
                    plane.data() + j * nx);
  }
  Lines in(ny);
  Lines out(ny);
  for (std::size_t x = 0; x < nx; x += kTile) {
    const std::size_t width = std::min(kTile, nx - x);
    bool band = false;
    for (std::size_t j = 0; j < ny; ++j) {
      const float* from = plane.data() + j * nx + x;
      float* to = in.data() + j * kTile;
      for (std::size_t l = 0; l < kTile; ++l) {
        to[l] = from[std::min(l, width - 1)];
        band = band || to[l] < farCap_;
      }
    }
    if (!band) continue;
    refineRows(in.data(), kTile, ny, out.data(), kTile, 0, ny, kTile, palette_.weight()[1]);
    for (std::size_t j = 0; j < ny; ++j) {
      std::copy_n(out.data() + j * kTile, width, plane.data() + j * nx + x);
    }
  }
}

void BandedDistance::slab(std::int32_t first, std::int32_t last, std::vector<float>& out) {
  const auto nx = static_cast<std::size_t>(solid_.extent[0]);
  const auto ny = static_cast<std::size_t>(solid_.extent[1]);
  const std::int32_t from = std::max(0, first - reach_);
  const std::int32_t to = std::min(solid_.extent[2], last + reach_);
  // Planes [from, to) now; those of the last call that are still needed move to their places.
  std::vector<std::vector<float>> planes(static_cast<std::size_t>(to - from));
  std::vector<std::int32_t> missing;
  for (std::int32_t z = from; z < to; ++z) {
    const std::int32_t had = z - firstPlane_;
    if (had >= 0 && had < static_cast<std::int32_t>(plane_.size())) {
      planes[static_cast<std::size_t>(z - from)].swap(plane_[static_cast<std::size_t>(had)]);
    }
    if (planes[static_cast<std::size_t>(z - from)].empty()) missing.push_back(z);
  }
  plane_.swap(planes);
  firstPlane_ = from;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, missing.size()), [&](const auto& range) {
    for (std::size_t m = range.begin(); m != range.end(); ++m) {
      fillPlane(missing[m], plane_[static_cast<std::size_t>(missing[m] - from)]);
    }
  });

  const std::size_t depth = plane_.size();
  const auto begin = static_cast<std::size_t>(first - from);
  const auto end = static_cast<std::size_t>(last - from);
  out.resize((end - begin) * ny * nx);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ny), [&](const auto& range) {
    Lines in(depth);
    Lines lines(depth);
    for (std::size_t j = range.begin(); j != range.end(); ++j) {
      for (std::size_t x = 0; x < nx; x += kTile) {
        const std::size_t width = std::min(kTile, nx - x);
        bool band = false;
        for (std::size_t z = 0; z < depth; ++z) {
          const float* row = plane_[z].data() + j * nx + x;
          float* to16 = in.data() + z * kTile;
          for (std::size_t l = 0; l < kTile; ++l) {
            to16[l] = row[std::min(l, width - 1)];
            band = band || to16[l] < farCap_;
          }
        }
        if (band) {
          refineRows(in.data(), kTile, depth, lines.data(), kTile, begin, end, kTile,
                     palette_.weight()[2]);
        } else {
          std::fill_n(lines.data(), (end - begin) * kTile, farCap_);
        }
        for (std::size_t z = 0; z < end - begin; ++z) {
          std::copy_n(lines.data() + z * kTile, width, out.data() + (z * ny + j) * nx + x);
        }
      }
    }
  });
}

}  // namespace palpate
