#pragma once
/// The colours and measures of Palpate (dark and light), and Dear ImGui's style made from them.

#include <imgui.h>

#include <cstdint>

namespace palpate::ui {

struct Theme {
  bool light = false;
  ImVec4 ground, panel, raised, hover, text, secondary, line, accent, onAccent, attention, danger;

  [[nodiscard]] static Theme dark();
  [[nodiscard]] static Theme bright();
};

/// WCAG 2 contrast ratio of two opaque colours, 1..21.
[[nodiscard]] double contrastRatio(const ImVec4& a, const ImVec4& b);

/// `alpha` replaces the colour's own.
[[nodiscard]] ImU32 packed(const ImVec4& colour, float alpha = 1.0F);

/// Sets every style colour and measure for a display scale. ImGui context required.
void applyTheme(const Theme& theme, float scale);

/// Measures of the layout in unscaled pixels; multiply by the display scale.
struct Measures {
  static constexpr float kHeader = 48.0F;
  static constexpr float kStrip = 44.0F;
  static constexpr float kPanel = 300.0F;
  static constexpr float kPadding = 12.0F;
  static constexpr float kGap = 8.0F;
  static constexpr float kControl = 32.0F;
  static constexpr float kCorner = 6.0F;
  static constexpr float kHairline = 1.0F;
};

}  // namespace palpate::ui
