#include "core/voxels/distance_window.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "core/voxels/axis_distance.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxels/distance_window.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// One row out: the least of `cap` and every row in plus its step. Steps may be left out that are
// no less than the cap.
void leastOfRows(const float* in, std::size_t inStride, const float* step, std::size_t count,
                 float cap, float* out, std::size_t width) {
  const hn::CappedTag<float, 16> d;
  for (std::size_t at = 0; at < width; at += hn::Lanes(d)) {
    auto best = hn::Set(d, cap);
    for (std::size_t s = 0; s < count; ++s) {
      best = hn::Min(best, hn::Add(hn::Load(d, in + s * inStride + at), hn::Set(d, step[s])));
    }
    hn::Store(best, d, out + at);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate {
namespace {

HWY_EXPORT(leastOfRows);

constexpr std::size_t kLanes = 16;

std::size_t padded(std::int32_t n) noexcept {
  return (static_cast<std::size_t>(n) + kLanes - 1) / kLanes * kLanes;
}

}  // namespace

Extent3 DistanceWindow::reachOf(const DepthPalette& palette, Band band) noexcept {
  const float far = palette.farSquare();
  const float square = band == Band::Outside ? far : std::max(far, palette.deepSquare());
  Extent3 reach;
  for (std::size_t a = 0; a < 3; ++a) {
    reach[a] = static_cast<std::int32_t>(std::sqrt(square / palette.weight()[a]));
  }
  return reach;
}

DistanceWindow::DistanceWindow(const DepthPalette& palette, const Extent3& dims,
                               const Extent3& largest, Band widest)
    : palette_(palette),
      dims_(dims),
      farCap_(palette.farSquare() + 0.5f),
      deepCap_(palette.deepSquare() + 0.5f) {
  const Extent3 reach = reachOf(palette, widest);
  Extent3 most;
  Extent3 wide;
  for (std::size_t a = 0; a < 3; ++a) {
    most[a] = std::min(largest[a], dims[a]);
    wide[a] = std::min(largest[a] + 2 * reach[a], dims[a]);
  }
  const auto rows = [](std::int32_t y, std::int32_t z) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(z);
  };
  const std::size_t stride = padded(most[0]);
  alongX_.resize(stride * rows(wide[1], wide[2]));
  alongY_.resize(stride * rows(most[1], wide[2]));
  out_.resize(stride * rows(most[1], most[2]) + kLanes);
}

void DistanceWindow::measure(const VoxelBits& solid, const VoxelBox& box, Band band) noexcept {
  box_ = box;
  stride_ = padded(box.size(0));
  const VoxelBox wide = box.grown(reachOf(palette_, band), dims_);
  const float deepCap = band == Band::Both ? deepCap_ : farCap_;
  const auto ny = static_cast<std::size_t>(box.size(1));
  const auto nz = static_cast<std::size_t>(box.size(2));
  const auto wideY = static_cast<std::size_t>(wide.size(1));
  const auto wideZ = static_cast<std::size_t>(wide.size(2));
  const auto firstY = static_cast<std::size_t>(box.lo[1] - wide.lo[1]);
  const auto firstZ = static_cast<std::size_t>(box.lo[2] - wide.lo[2]);
  const std::size_t plane = ny * stride_;
  const auto used = static_cast<std::size_t>(box.size(0));
  assert(wideY * wideZ * stride_ <= alongX_.size() && wideZ * plane <= alongY_.size() &&
         nz * plane <= out_.size());
  for (std::size_t z = 0; z < wideZ; ++z) {
    float* rows = alongX_.data() + z * wideY * stride_;
    bool same = true;  // one kind all over the plane
    for (std::size_t y = 0; y < wideY; ++y) {
      float* row = rows + y * stride_;
      const std::uint64_t* bits = solid.row(wide.lo[1] + static_cast<std::int32_t>(y),
                                            wide.lo[2] + static_cast<std::int32_t>(z));
      const bool one = squaresAlongRow(bits, {wide.lo[0], wide.hi[0], box_.lo[0], box_.hi[0]},
                                       palette_.weight()[0], {farCap_, deepCap}, row);
      std::fill(row + used, row + stride_, row[used - 1]);
      same = same && one && row[0] == rows[0];
    }
    float* to = alongY_.data() + z * plane;
    if (same) {
      std::fill_n(to, plane, rows[0]);
    } else {
      refineRows(rows, stride_, wideY, to, stride_, firstY, firstY + ny, stride_,
                 palette_.weight()[1]);
    }
  }
  for (std::size_t y = 0; y < ny; ++y) {
    refineRows(alongY_.data() + y * stride_, plane, wideZ, out_.data() + y * stride_, plane, firstZ,
               firstZ + nz, stride_, palette_.weight()[2]);
  }
}

void DistanceWindow::measureTo(const VoxelBits& sites, const VoxelBox& from,
                               const VoxelBox& box) noexcept {
  box_ = box;
  stride_ = padded(box.size(0));
  const auto ny = static_cast<std::size_t>(box.size(1));
  const std::size_t plane = ny * stride_;
  const std::array<float, 3>& weight = palette_.weight();
  constexpr std::size_t kMost = 128;  // rows and planes of `from`
  assert(from.size(1) <= static_cast<std::int32_t>(kMost) &&
         from.size(2) <= static_cast<std::int32_t>(kMost));
  assert(static_cast<std::size_t>(from.size(1)) * stride_ <= alongX_.size() &&
         static_cast<std::size_t>(from.size(2)) * plane <= alongY_.size() &&
         static_cast<std::size_t>(box.size(2)) * plane <= out_.size());
  std::array<std::int32_t, kMost> siteZ;
  std::array<float, kMost> step;
  std::size_t planes = 0;
  const auto stepTo = [](float w, std::int32_t i) { return w * static_cast<float>(i * i); };
  for (std::int32_t k = from.lo[2]; k < from.hi[2]; ++k) {
    std::array<std::int32_t, kMost> siteY;
    std::size_t rows = 0;
    for (std::int32_t j = from.lo[1]; j < from.hi[1]; ++j) {
      const std::uint64_t* bits = sites.row(j, k);
      std::int32_t last = -1;  // site
      float* row = alongX_.data() + rows * stride_;
      const auto fill = [&](std::int32_t begin, std::int32_t end, std::int32_t left,
                            std::int32_t right) {
        for (std::int32_t i = std::max(begin, box.lo[0]); i < std::min(end, box.hi[0]); ++i) {
          const float toLeft = left >= 0 ? stepTo(weight[0], i - left) : deepCap_;
          const float toRight = right >= 0 ? stepTo(weight[0], right - i) : deepCap_;
          row[i - box.lo[0]] = std::min(deepCap_, std::min(toLeft, toRight));
        }
      };
      std::int32_t done = box.lo[0];
      for (std::int32_t i = from.lo[0]; i < from.hi[0]; ++i) {
        if ((bits[i >> 6] >> (i & 63) & 1U) == 0) continue;
        fill(done, i + 1, last, i);
        done = i + 1;
        last = i;
      }
      if (last < 0) continue;
      fill(done, box.hi[0], last, -1);
      const auto used = static_cast<std::size_t>(box.size(0));
      std::fill(row + used, row + stride_, deepCap_);
      siteY[rows++] = j;
    }
    if (rows == 0) continue;
    float* to = alongY_.data() + planes * plane;
    for (std::size_t y = 0; y < ny; ++y) {
      for (std::size_t s = 0; s < rows; ++s) {
        step[s] = stepTo(weight[1], box.lo[1] + static_cast<std::int32_t>(y) - siteY[s]);
      }
      HWY_DYNAMIC_DISPATCH(leastOfRows)
      (alongX_.data(), stride_, step.data(), rows, deepCap_, to + y * stride_, stride_);
    }
    siteZ[planes++] = k;
  }
  for (std::int32_t k = box.lo[2]; k < box.hi[2]; ++k) {
    for (std::size_t s = 0; s < planes; ++s) step[s] = stepTo(weight[2], k - siteZ[s]);
    HWY_DYNAMIC_DISPATCH(leastOfRows)
    (alongY_.data(), plane, step.data(), planes, deepCap_,
     out_.data() + static_cast<std::size_t>(k - box.lo[2]) * plane, plane);
  }
}

}  // namespace palpate
#endif
