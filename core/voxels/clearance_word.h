#pragma once
/// A lower bound of the distance to the contact region over a cubic block of cells, in 32 bits.
///
/// No point of the region is nearer to u than b + g·(u − c), c the block's middle: three slopes of
/// seven bits and a bound of ten, which leaves the top bit to tell a bound from a link. Lengths in
/// the smallest spacing.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace palpate {

struct ClearanceWord {
  static constexpr std::uint32_t kLink = 0x80000000U;  ///< Set: not a bound.
  static constexpr int kSlopeBits = 7;
  static constexpr std::uint32_t kSlopeMask = 127;
  static constexpr int kSlopeBias = 64;
  static constexpr float kSlopeSteps = 63.0f;
  static constexpr int kBoundShift = 3 * kSlopeBits;
  static constexpr int kBoundBias = 512;
  /// A block without any clearance.
  static constexpr std::uint32_t kNever =
      kSlopeBias | kSlopeBias << kSlopeBits | kSlopeBias << (2 * kSlopeBits);

  /// Steps of the bound in a unit of length: of blocks of 16³ cells, of 4³ cells, of bricks.
  static constexpr float kCoarseSteps = 4.0f, kBlockSteps = 16.0f, kBrickSteps = 64.0f;

  /// Slopes as they are stored: whole steps, towards zero, so that |g| stays at most 1.
  [[nodiscard]] static std::array<int, 3> slopesOf(const std::array<float, 3>& g) noexcept {
    std::array<int, 3> q{};
    for (std::size_t a = 0; a < 3; ++a) q[a] = static_cast<int>(g[a] * kSlopeSteps);
    return q;
  }
  [[nodiscard]] static std::uint32_t encode(const std::array<int, 3>& slopes, float bound,
                                            float steps) noexcept {
    const float whole = std::floor(std::max(bound, -1e6f) * steps);
    if (whole < -kBoundBias) return kNever;
    const int b = static_cast<int>(std::min(whole, kBoundBias - 1.0f)) + kBoundBias;
    std::uint32_t word = static_cast<std::uint32_t>(b) << kBoundShift;
    for (std::size_t a = 0; a < 3; ++a) {
      word |= static_cast<std::uint32_t>(slopes[a] + kSlopeBias)
              << (kSlopeBits * static_cast<int>(a));
    }
    return word;
  }
  /// The bound at u, `from` = u − c.
  [[nodiscard]] static float at(std::uint32_t word, const std::array<float, 3>& from,
                                float steps) noexcept {
    float sum = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto q = static_cast<int>(word >> (kSlopeBits * a) & kSlopeMask) - kSlopeBias;
      sum += static_cast<float>(q) / kSlopeSteps * from[a];
    }
    return (static_cast<float>(word >> kBoundShift) - kBoundBias) / steps + sum;
  }
};

}  // namespace palpate
