#include "core/voxels/axis_distance.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/voxels/axis_distance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void refineRowsHere(const float* in, std::size_t inStride, std::size_t n, float* out,
                    std::size_t outStride, std::size_t first, std::size_t last, std::size_t width,
                    float weight) {
  const hn::CappedTag<float, 16> d;
  const auto zero = hn::Zero(d);
  for (std::size_t at = 0; at < width; at += hn::Lanes(d)) {
    for (std::size_t i = first; i < last; ++i) {
      const auto own = hn::Load(d, in + i * inStride + at);
      const auto sign = hn::CopySign(hn::Set(d, 1.0f), own);
      auto best = hn::Abs(own);
      for (std::size_t k = 1; k < n; ++k) {
        const auto step = hn::Set(d, weight * static_cast<float>(k * k));
        if (hn::AllTrue(d, hn::Le(best, step))) break;
        if (i >= k) {
          const float* from = in + (i - k) * inStride + at;
          best = hn::Min(best, hn::Add(hn::Max(hn::Mul(sign, hn::Load(d, from)), zero), step));
        }
        if (i + k < n) {
          const float* from = in + (i + k) * inStride + at;
          best = hn::Min(best, hn::Add(hn::Max(hn::Mul(sign, hn::Load(d, from)), zero), step));
        }
      }
      hn::Store(hn::CopySign(best, own), d, out + (i - first) * outStride + at);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate {

HWY_EXPORT(refineRowsHere);

void refineRows(const float* in, std::size_t inStride, std::size_t n, float* out,
                std::size_t outStride, std::size_t first, std::size_t last, std::size_t width,
                float weight) {
  HWY_DYNAMIC_DISPATCH(refineRowsHere)(in, inStride, n, out, outStride, first, last, width, weight);
}

bool squaresAlongRow(const std::uint64_t* bits, const RowSpan& row, float weight,
                     const SquareCaps& caps, float* out) noexcept {
  const auto [from, to, x0, x1] = row;
  std::int32_t begin = from;
  while (begin < to) {
    const bool inside = (bits[begin >> 6] >> (begin & 63) & 1U) != 0;
    std::int32_t end = begin;
    while (end < to) {  // to the first bit of the other kind
      const std::uint64_t w = (inside ? ~bits[end >> 6] : bits[end >> 6]) >> (end & 63);
      if (w != 0) {
        end += std::countr_zero(w);
        break;
      }
      end = ((end >> 6) + 1) << 6;
    }
    end = std::min(end, to);
    const float cap = inside ? caps.deep : caps.far;
    const float sign = inside ? -1.0f : 1.0f;
    const std::int32_t first = std::max(begin, x0);
    const std::int32_t last = std::min(end, x1);
    if (begin == from && end == to) {
      std::fill(out + (first - x0), out + (last - x0), sign * cap);
      return true;
    }
    for (std::int32_t i = first; i < last; ++i) {
      const auto left = static_cast<float>(i - begin + 1);
      const auto right = static_cast<float>(end - i);
      const float toLeft = begin > from ? weight * (left * left) : cap;
      const float toRight = end < to ? weight * (right * right) : cap;
      out[i - x0] = sign * std::min(cap, std::min(toLeft, toRight));
    }
    begin = end;
  }
  return false;
}

}  // namespace palpate
#endif
