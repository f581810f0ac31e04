#include "tests/benchmarks/dense_field.h"

#include <algorithm>
#include <cmath>
#include <thread>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/dense_field.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace palpate::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Square distances of 16 neighbouring lines along one axis; `in` and `out` are [n][16]; `weight` is
// the square of the step.
void refineLines(const float* in, float* out, std::size_t n, float weight) {
  const hn::ScalableTag<float> d;
  const std::size_t lanes = std::min<std::size_t>(hn::Lanes(d), 16);
  const auto zero = hn::Zero(d);
  for (std::size_t at = 0; at < 16; at += lanes) {
    for (std::size_t i = 0; i < n; ++i) {
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
      hn::Store(hn::CopySign(best, own), d, out + i * 16 + at);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::bench {
namespace {

HWY_EXPORT(refineLines);

constexpr float kFar = 1e9f;  // square of a distance that no grid has

// Along x: the distance to the next voxel of the other kind in the row, signed by kind.
void firstAxis(const std::uint8_t* label, float* out, std::int32_t n, float weight) {
  std::int32_t last = -(1 << 20);  // last position of the other kind
  for (std::int32_t i = 0; i < n; ++i) {
    if (i > 0 && (label[i] != 0) != (label[i - 1] != 0)) last = i - 1;
    const auto gap = static_cast<float>(i - last);
    out[i] = i - last >= (1 << 19) ? kFar : weight * (gap * gap);
  }
  std::int32_t next = 1 << 20;
  for (std::int32_t i = n - 1; i >= 0; --i) {
    if (i + 1 < n && (label[i] != 0) != (label[i + 1] != 0)) next = i + 1;
    const auto gap = static_cast<float>(next - i);
    if (next - i < (1 << 19)) out[i] = std::min(out[i], weight * (gap * gap));
    if (label[i] != 0) out[i] = -out[i];
  }
}

// Lines along y (stride = nx) or z (stride = nx·ny), 16 neighbours in x at a time.
void otherAxis(float* base, std::size_t nx, std::size_t n, std::size_t stride, float weight,
               std::vector<float>& in, std::vector<float>& out) {
  in.resize(n * 16 + 16);
  out.resize(n * 16 + 16);
  auto* a = reinterpret_cast<float*>((reinterpret_cast<std::uintptr_t>(in.data()) + 63) / 64 * 64);
  auto* b = reinterpret_cast<float*>((reinterpret_cast<std::uintptr_t>(out.data()) + 63) / 64 * 64);
  for (std::size_t x = 0; x < nx; x += 16) {
    const std::size_t width = std::min<std::size_t>(16, nx - x);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t l = 0; l < 16; ++l) {
        a[i * 16 + l] = base[i * stride + x + std::min(l, width - 1)];
      }
    }
    HWY_DYNAMIC_DISPATCH(refineLines)(a, b, n, weight);
    for (std::size_t i = 0; i < n; ++i) {
      std::copy_n(b + i * 16, width, base + i * stride + x);
    }
  }
}

template <class F>
void onBothCores(std::size_t n, F&& work) {
  std::thread half([&] { work(0, n / 2); });
  work(n / 2, n);
  half.join();
}

}  // namespace

DenseField denseField(const LabelGrid& grid) {
  const auto nx = static_cast<std::size_t>(grid.geometry.dims[0]);
  const auto ny = static_cast<std::size_t>(grid.geometry.dims[1]);
  const auto nz = static_cast<std::size_t>(grid.geometry.dims[2]);
  DenseField field;
  field.dims = grid.geometry.dims;
  field.unit = grid.geometry.spacing.minCoeff();
  float weight[3];
  for (std::size_t a = 0; a < 3; ++a) {
    field.spacing[a] = grid.geometry.spacing[static_cast<Eigen::Index>(a)];
    const auto step = static_cast<float>(field.spacing[a] / field.unit);
    weight[a] = step * step;
  }
  field.value = HugeBuffer<float>(nx * ny * nz + nx * ny + nx + 2);
  float* value = field.value.data();
  onBothCores(nz, [&](std::size_t from, std::size_t to) {
    std::vector<float> in;
    std::vector<float> out;
    for (std::size_t k = from; k < to; ++k) {
      for (std::size_t j = 0; j < ny; ++j) {
        const std::size_t row = (k * ny + j) * nx;
        firstAxis(grid.labels.data() + row, value + row, grid.geometry.dims[0], weight[0]);
      }
      otherAxis(value + k * ny * nx, nx, ny, nx, weight[1], in, out);
    }
  });
  onBothCores(ny, [&](std::size_t from, std::size_t to) {
    std::vector<float> in;
    std::vector<float> out;
    for (std::size_t j = from; j < to; ++j) {
      otherAxis(value + j * nx, nx, nz, nx * ny, weight[2], in, out);
      for (std::size_t k = 0; k < nz; ++k) {
        float* row = value + (k * ny + j) * nx;
        for (std::size_t i = 0; i < nx; ++i) {
          row[i] = std::copysign(std::sqrt(std::abs(row[i])) - 0.5f, row[i]);
        }
      }
    }
  });
  return field;
}

}  // namespace palpate::bench
#endif
