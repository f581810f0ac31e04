#pragma once
/// 256 names for the depths that occur, and exact 16-bit depths for the rest.

#include <array>
#include <cstdint>
#include <vector>

namespace palpate::bench {

/// Depths in steps of 1/kDepthUnit of the smallest spacing, saturated at 16 of them.
[[nodiscard]] std::int16_t depthSteps(float value);

struct DepthCodes {
  std::array<std::int16_t, 256> steps{};
  std::vector<std::int16_t> code;  ///< by steps + 32768; -1 where there is none

  /// From how often each depth occurs, by steps + 32768. `farSteps` is always code 0: all outside
  /// depths from there on, which no cell with an inside corner has.
  DepthCodes(const std::vector<std::uint32_t>& histogram, std::int16_t farSteps);
  [[nodiscard]] std::int16_t of(std::int16_t s) const {
    return code[static_cast<std::size_t>(s + 32768)];
  }
};

}  // namespace palpate::bench
