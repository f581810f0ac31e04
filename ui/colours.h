#pragma once
/// Colours that carry meaning: labels (Okabe–Ito), contacts by depth.

#include <array>
#include <cstddef>
#include <cstdint>

#include "imaging/segment/label_colours.h"

namespace palpate::ui {

using Rgb = std::array<float, 3>;  ///< sRGB, 0..1.

using palpate::labelColour;  // of labels and of a split's parts

/// Depth at which a contact has the deepest colour: 1 mm.
inline constexpr double kDeepestColour_m = 1e-3;

/// Pale yellow at 0 to deep orange at kDeepestColour_m and beyond. Red is for danger only.
[[nodiscard]] Rgb contactColour(double depth_m);

}  // namespace palpate::ui
