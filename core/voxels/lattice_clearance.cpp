#include "core/voxels/lattice_clearance.h"

#include <algorithm>
#include <cmath>

#include "core/voxels/clearance_word.h"

namespace palpate {

LatticeClearance::LatticeClearance(const DepthPalette& palette,
                                   const std::array<std::int32_t, 3>& dims, const FarDistance& far)
    : dims_(dims), far_(far), value_(kSide * kSide * kSide), low_(value_.size()) {
  float diagonal2 = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    edge_[a] = std::sqrt(palette.weight()[a]);
    diagonal2 += palette.weight()[a];
  }
  // The region keeps within this of a centre inside. Cubic voxels: the worst is a point near the
  // one outside corner of a cell, 0.858 away. Otherwise a cell's diagonal does.
  const bool cubic = edge_[0] == 1.0f && edge_[1] == 1.0f && edge_[2] == 1.0f;
  overhang_ = cubic ? 0.87f : std::sqrt(diagonal2);
  // Between places the square of a distance lies above its interpolation less a quarter of the
  // square diagonal: a square distance to a point has unit curvature, the least of them no more.
  sag_ = 0.25f * diagonal2;
}

// From the distance to the nearest centre inside to a bound that may be interpolated.
float LatticeClearance::lowBound(float distance, float sag) const noexcept {
  const float e = distance - overhang_;
  const float e2 = e * e - sag;
  return e > 0.0f && e2 > 0.0f ? std::sqrt(e2) : LatticeBound::kNone;
}

bool LatticeClearance::read(const SquareView& view, const std::array<std::int32_t, 3>& block,
                            float near) {
  block_ = block;
  const float limit = near + overhang_;
  const float nearSquare = limit * limit;
  bool any = false;
  std::size_t at = 0;
  for (int z = 0; z < kSide; ++z) {
    const std::int32_t k = std::min(block[2] * 16 + z, dims_[2] - 1);
    for (int y = 0; y < kSide; ++y) {
      const std::int32_t j = std::min(block[1] * 16 + y, dims_[1] - 1);
      const float* row = view.square + view.rowAt(j, k);
      for (int x = 0; x < kSide; ++x, ++at) {
        const float square = row[std::min(block[0] * 16 + x, dims_[0] - 1) - view.origin[0]];
        const float distance = std::sqrt(std::abs(square));
        value_[at] = square > 0.0f ? distance - 0.5f : 0.5f - distance;
        low_[at] = square > 0.0f ? lowBound(distance, sag_) : LatticeBound::kNone;
        any = any || square < nearSquare;
      }
    }
  }
  return any;
}

LatticeBound LatticeClearance::bound(int child) const {
  const std::array<std::int32_t, 3> corner{child & 3, child >> 2 & 3, child >> 4};
  float value[125];
  float low[125];
  std::size_t to = 0;
  for (int z = 0; z < 5; ++z) {
    for (int y = 0; y < 5; ++y) {
      const auto from = static_cast<std::size_t>(corner[0] * 4 + kSide * (corner[1] * 4 + y) +
                                                 kSide * kSide * (corner[2] * 4 + z));
      for (std::size_t x = 0; x < 5; ++x, ++to) {
        value[to] = value_[from + x];
        low[to] = low_[from + x];
      }
    }
  }
  const LatticeBound near = fit(value, low, 5, 1);
  if (near.best() < kLatticeReach - 4.0f) return near;
  const LatticeBound far = farBound(
      {block_[0] * 4 + corner[0], block_[1] * 4 + corner[1], block_[2] * 4 + corner[2]}, 2);
  return far.best() > near.best() ? far : near;
}

LatticeBound LatticeClearance::coarseBound(const std::array<std::int32_t, 3>& block) const {
  return farBound({block[0] * 4, block[1] * 4, block[2] * 4}, 5);
}

LatticeBound LatticeClearance::farBound(const std::array<std::int32_t, 3>& place, int side) const {
  float value[125];
  float low[125];
  std::size_t to = 0;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x, ++to) {
        value[to] = far_.at(place[0] + x, place[1] + y, place[2] + z);
        low[to] = lowBound(value[to], sag_ * FarDistance::kStep * FarDistance::kStep);
      }
    }
  }
  return fit(value, low, side, FarDistance::kStep);
}

// Least-squares slopes, then for these and for none the lowest of the bounds less the slopes.
LatticeBound LatticeClearance::fit(const float* value, const float* low, int side, int step) const {
  const float middle = 0.5f * static_cast<float>(side - 1);
  float g[3] = {0, 0, 0};
  float least = 1e9f;
  std::size_t at = 0;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      float sum = 0;
      for (int x = 0; x < side; ++x, ++at) {
        sum += value[at];
        g[0] += (static_cast<float>(x) - middle) * value[at];
        least = std::min(least, low[at]);
      }
      g[1] += (static_cast<float>(y) - middle) * sum;
      g[2] += (static_cast<float>(z) - middle) * sum;
    }
  }
  LatticeBound bound;
  if (least > 0.0f) bound.level = least - 1e-3f;
  // The sum of squares of the places along one axis.
  const auto n = static_cast<float>(side);
  const float squares = n * n * n * (n * n - 1.0f) / 12.0f;
  std::array<float, 3> slope;
  float length = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    slope[a] = g[a] / (squares * edge_[a] * static_cast<float>(step));
    length += slope[a] * slope[a];
  }
  length = std::max(1.0f, std::sqrt(length));
  for (float& s : slope) s /= length;
  const std::array<int, 3> q = ClearanceWord::slopesOf(slope);
  float rise[3];  // from one place to the next
  for (std::size_t a = 0; a < 3; ++a) {
    bound.slopes[a] = static_cast<std::int8_t>(q[a]);
    rise[a] =
        static_cast<float>(q[a]) / ClearanceWord::kSlopeSteps * edge_[a] * static_cast<float>(step);
  }
  if (least < 0.0f) return bound;
  float lowest = 1e9f;
  at = 0;
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      const float base = rise[1] * (static_cast<float>(y) - middle) +
                         rise[2] * (static_cast<float>(z) - middle) - rise[0] * middle;
      for (int x = 0; x < side; ++x, ++at) {
        lowest = std::min(lowest, low[at] - base - rise[0] * static_cast<float>(x));
      }
    }
  }
  bound.sloped = lowest - 1e-3f;
  return bound;
}

}  // namespace palpate
