#pragma once
/// Colours of labels that nothing else gives one: people with any colour vision tell them apart.
/// Source: Okabe and Ito, "Color Universal Design", 2008; black left out.

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

inline constexpr std::array<std::array<std::uint8_t, 3>, 7> kLabelColours{{{230, 159, 0},
                                                                           {86, 180, 233},
                                                                           {0, 158, 115},
                                                                           {240, 228, 66},
                                                                           {0, 114, 178},
                                                                           {213, 94, 0},
                                                                           {204, 121, 167}}};

/// The index wraps.
[[nodiscard]] inline std::array<std::uint8_t, 3> labelColour(std::size_t index) {
  return kLabelColours[index % kLabelColours.size()];
}

}  // namespace palpate
