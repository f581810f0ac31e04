#pragma once
/// The bottom strip: fixed columns, fixed-width digits, units always shown.

#include <vector>

#include "ui/model.h"
#include "ui/widgets.h"

namespace palpate::ui {

/// One column: where it starts and the words in it. Same places whatever the numbers are.
struct StripColumn {
  float x = 0, width = 0;
  std::string text;
};
/// A pure function, so that a test can see that nothing moves or overlaps. `measure`: width of a
/// text in pixels.
[[nodiscard]] std::vector<StripColumn> stripColumns(const Model& model, float left, float right,
                                                    float scale, ImFont* font);
void drawStrip(const Painter& paint, const Rect& area, const Model& model);

}  // namespace palpate::ui
