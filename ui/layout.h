#pragma once
/// Where everything is: header, task panel, four views, strip. A pure function of size and scale.

#include <array>
#include <cstdint>
#include <optional>

namespace palpate::ui {

struct Rect {
  float x = 0, y = 0, w = 0, h = 0;
  [[nodiscard]] float right() const noexcept { return x + w; }
  [[nodiscard]] float bottom() const noexcept { return y + h; }
  [[nodiscard]] bool contains(float px, float py) const noexcept {
    return px >= x && py >= y && px < right() && py < bottom();
  }
  /// Share of area in common counts; touching edges do not.
  [[nodiscard]] bool overlaps(const Rect& o) const noexcept {
    return x < o.right() && o.x < right() && y < o.bottom() && o.y < bottom();
  }
};

enum class View : std::uint8_t { Scene, Axial, Coronal, Sagittal };
inline constexpr std::size_t kViews = 4;

struct Layout {
  Rect header, panel, strip;
  std::array<Rect, kViews> view;  ///< By View; empty where another view fills the window.
};

/// Framebuffer pixels. `filled`: that view takes the place of panel and views; header and strip
/// stay. Below 1280×800 (times scale) the views shrink first, down to nothing, never negative.
[[nodiscard]] Layout computeLayout(float width, float height, float scale,
                                   std::optional<View> filled);

}  // namespace palpate::ui
