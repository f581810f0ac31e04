#pragma once
/// Clearance words after an edit: taken over by other blocks, and lowered where new region comes
/// nearer. Internal to TreeEditor. Length unit: the smallest spacing.

#include <array>
#include <cstdint>

namespace palpate {

struct SpaceBox {
  std::array<float, 3> lo{}, hi{};
};

/// The same bound as a word in other steps, for a block whose middle lies `by` from the old one's
/// and that lies within it.
[[nodiscard]] std::uint32_t recodedClearance(std::uint32_t word, float steps, float newSteps,
                                             const std::array<float, 3>& by) noexcept;

/// A word of a block that bounds the distance to `region` too, with the slopes it has.
[[nodiscard]] std::uint32_t loweredClearance(std::uint32_t word, float steps, const SpaceBox& block,
                                             const SpaceBox& region) noexcept;

/// Between two boxes.
[[nodiscard]] float gapBetween(const SpaceBox& a, const SpaceBox& b) noexcept;

}  // namespace palpate
