#include "core/voxels/clearance_edit.h"

#include <algorithm>
#include <cmath>

#include "core/voxels/clearance_word.h"

namespace palpate {
namespace {

// Single precision, lengths of some hundreds.
constexpr float kRounding = 1e-3f;

std::array<int, 3> slopesIn(std::uint32_t word) noexcept {
  std::array<int, 3> q{};
  for (std::size_t a = 0; a < 3; ++a) {
    q[a] = static_cast<int>(word >> (ClearanceWord::kSlopeBits * a) & ClearanceWord::kSlopeMask) -
           ClearanceWord::kSlopeBias;
  }
  return q;
}

int stepsIn(std::uint32_t word) noexcept {
  return static_cast<int>(word >> ClearanceWord::kBoundShift) - ClearanceWord::kBoundBias;
}

}  // namespace

std::uint32_t recodedClearance(std::uint32_t word, float steps, float newSteps,
                               const std::array<float, 3>& by) noexcept {
  const int stored = stepsIn(word);
  // The least that can be stored may stand for less.
  if (stored == -ClearanceWord::kBoundBias) return ClearanceWord::kNever;
  const std::array<int, 3> q = slopesIn(word);
  float bound = static_cast<float>(stored) / steps;
  bool moved = false;
  for (std::size_t a = 0; a < 3; ++a) {
    bound += static_cast<float>(q[a]) / ClearanceWord::kSlopeSteps * by[a];
    moved = moved || by[a] != 0.0f;
  }
  return ClearanceWord::encode(q, moved ? bound - kRounding : bound, newSteps);
}

float gapBetween(const SpaceBox& a, const SpaceBox& b) noexcept {
  float d2 = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const float d = std::max({0.0f, a.lo[i] - b.hi[i], b.lo[i] - a.hi[i]});
    d2 += d * d;
  }
  return std::sqrt(d2);
}

// For u in the block, c its middle, w from the region's nearest point to c, m = w / |w|:
//   dist(u) >= gap                   so  gap − max g·(u − c) will do,
//   dist(u) >= |w| + m·(u − c)       so  |w| − max (g − m)·(u − c) will do.
std::uint32_t loweredClearance(std::uint32_t word, float steps, const SpaceBox& block,
                               const SpaceBox& region) noexcept {
  const int stored = stepsIn(word);
  if (stored == -ClearanceWord::kBoundBias) return ClearanceWord::kNever;
  const std::array<int, 3> q = slopesIn(word);
  float w[3];
  float g[3];
  float half[3];
  float d2 = 0;
  float rise = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const float c = 0.5f * (block.lo[a] + block.hi[a]);
    half[a] = 0.5f * (block.hi[a] - block.lo[a]);
    g[a] = static_cast<float>(q[a]) / ClearanceWord::kSlopeSteps;
    w[a] = c - std::clamp(c, region.lo[a], region.hi[a]);
    d2 += w[a] * w[a];
    rise += std::abs(g[a]) * half[a];
  }
  float bound = gapBetween(block, region) - rise;
  const float d = std::sqrt(d2);
  if (d > 0.0f) {
    float turn = 0;
    for (std::size_t a = 0; a < 3; ++a) turn += std::abs(g[a] - w[a] / d) * half[a];
    bound = std::max(bound, d - turn);
  }
  bound -= kRounding;
  if (bound * steps >= static_cast<float>(stored)) return word;
  return ClearanceWord::encode(q, bound, steps);
}

}  // namespace palpate
