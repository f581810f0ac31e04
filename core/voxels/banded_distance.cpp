#include "core/voxels/banded_distance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxels/banded_distance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Refines sixteen neighbouring lines along one axis: `in` is [n][16]; rows first .. last go to
// `out`, [last - first][16].
void refineLines(const float* in, float* out, std::size_t n, std::size_t first, std::size_t last,
                 float weight) {
  const hn::CappedTag<float, 16> d;
  const auto zero = hn::Zero(d);
  for (std::size_t at = 0; at < 16; at += hn::Lanes(d)) {
    for (std::size_t i = first; i < last; ++i) {
      const auto own = hn::Load(d, in + i * 16 + at);
      const auto sign = hn::CopySign(hn::Set(d, 1.0f), own);
      auto best = hn::Abs(own);
      for (std::size_t k = 1; k < n; ++k) {
        const auto step = hn::Set(d, weight * static_cast<float>(k * k));
        if (hn::AllTrue(d, hn::Le(best, step))) break;
        if (i >= k) {
          const auto other = hn::Max(hn::Mul(sign, hn::Load(d, in + (i - k) * 16 + at)), zero);
          best = hn::Min(best, hn::Add(other, step));
        }
        if (i + k < n) {
          const auto other = hn::Max(hn::Mul(sign, hn::Load(d, in + (i + k) * 16 + at)), zero);
          best = hn::Min(best, hn::Add(other, step));
        }
      }
      hn::Store(hn::CopySign(best, own), d, out + (i - first) * 16 + at);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate {
namespace {

HWY_EXPORT(refineLines);

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

// Run by run: a voxel's distance along the row is that to the nearer end of its run that is not
// the grid's.
void BandedDistance::fillRow(const std::uint64_t* bits, float* out) const {
  const std::int32_t n = solid_.extent[0];
  const float weight = palette_.weight()[0];
  std::int32_t begin = 0;
  while (begin < n) {
    const bool inside = (bits[begin >> 6] >> (begin & 63) & 1U) != 0;
    std::int32_t end = begin;
    while (end < n) {  // to the first bit of the other kind
      const std::uint64_t w = (inside ? ~bits[end >> 6] : bits[end >> 6]) >> (end & 63);
      if (w != 0) {
        end += std::countr_zero(w);
        break;
      }
      end = ((end >> 6) + 1) << 6;
    }
    end = std::min(end, n);
    const float cap = inside ? deepCap_ : farCap_;
    const float sign = inside ? -1.0f : 1.0f;
    for (std::int32_t i = begin; i < end; ++i) {
      const auto left = static_cast<float>(i - begin + 1);
      const auto right = static_cast<float>(end - i);
      const float toLeft = begin > 0 ? weight * (left * left) : cap;
      const float toRight = end < n ? weight * (right * right) : cap;
      out[i] = sign * std::min(cap, std::min(toLeft, toRight));
    }
    begin = end;
  }
}

void BandedDistance::fillPlane(std::int32_t z, std::vector<float>& plane) const {
  const auto nx = static_cast<std::size_t>(solid_.extent[0]);
  const auto ny = static_cast<std::size_t>(solid_.extent[1]);
  plane.resize(nx * ny);
  for (std::size_t j = 0; j < ny; ++j) {
    fillRow(solid_.row(static_cast<std::int32_t>(j), z), plane.data() + j * nx);
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
    HWY_DYNAMIC_DISPATCH(refineLines)(in.data(), out.data(), ny, 0, ny, palette_.weight()[1]);
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
          HWY_DYNAMIC_DISPATCH(refineLines)
          (in.data(), lines.data(), depth, begin, end, palette_.weight()[2]);
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
#endif
