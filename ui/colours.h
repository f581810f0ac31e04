#pragma once
/// Colours that carry meaning: labels (Okabe–Ito), contacts by depth.

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate::ui {

using Rgb = std::array<float, 3>;  ///< sRGB, 0..1.

/// Okabe and Ito's eight colours that people with any colour vision tell apart, black left out;
/// index wraps.
[[nodiscard]] std::array<std::uint8_t, 3> labelColour(std::size_t index);

/// Depth at which a contact has the deepest colour: 1 mm.
inline constexpr double kDeepestColour_m = 1e-3;

/// Pale yellow at 0 to deep orange at kDeepestColour_m and beyond. Red is for danger only.
[[nodiscard]] Rgb contactColour(double depth_m);

}  // namespace palpate::ui
