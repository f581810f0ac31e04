#include "ui/layout.h"

#include <algorithm>
#include <cmath>

#include "ui/theme.h"

namespace palpate::ui {

Layout computeLayout(float width, float height, float scale, std::optional<View> filled) {
  const auto px = [scale](float v) { return std::round(v * scale); };
  const float gap = std::max(1.0F, px(Measures::kHairline * 2.0F));
  Layout layout;
  layout.header = {0, 0, width, px(Measures::kHeader)};
  layout.strip = {0, height - px(Measures::kStrip), width, px(Measures::kStrip)};
  const float top = layout.header.bottom();
  const float middle = std::max(0.0F, layout.strip.y - top);
  if (filled) {
    layout.view[static_cast<std::size_t>(*filled)] = {0, top, width, middle};
    return layout;
  }
  layout.panel = {0, top, std::min(px(Measures::kPanel), width), middle};
  const float left = layout.panel.right();
  const float free = std::max(0.0F, width - left);
  // Three slices one above the other; as square as the height allows, at most 40 % of the width.
  const float third = std::floor(std::max(0.0F, middle - 2.0F * gap) / 3.0F);
  const float slices = std::round(std::min(third * 1.15F, free * 0.4F));
  layout.view[0] = {left, top, std::max(0.0F, free - slices - gap), middle};
  for (std::size_t i = 1; i < kViews; ++i) {
    const float y = top + static_cast<float>(i - 1) * (third + gap);
    const float h = i + 1 == kViews ? std::max(0.0F, layout.strip.y - y) : third;
    layout.view[i] = {width - slices, y, slices, h};
  }
  return layout;
}

}  // namespace palpate::ui
