#include "ui/strip.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/units.h"
#include "ui/format.h"
#include "ui/trade_words.h"

namespace palpate::ui {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr float kTrace = 56.0F;  // width of the force trace, unscaled

double norm(const double (&v)[3]) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

float widthOf(ImFont* font, const std::string& text) {
  return font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, text.c_str()).x;
}

}  // namespace

std::vector<StripColumn> stripColumns(const Model& model, float left, float right, float scale,
                                      ImFont* font) {
  const Snapshot* s = model.snapshot;
  const bool times = s != nullptr && !model.hideTimes;
  const auto timing = [&](const char* name, const Timing Snapshot::*which) {
    return std::string(name) + " " +
           fixed(times ? std::round((s->*which).p50) : kNone, 4, 0, "\xc2\xb5s") + "  p99 " +
           fixed(times ? std::round((s->*which).p99) : kNone, 5, 0, "");
  };
  std::vector<std::string> texts;
  texts.push_back(fixed(s != nullptr ? norm(s->felt.force) : kNone, 2, 2, "N"));
  texts.push_back("");  // the trace
  texts.push_back(fixed(s != nullptr ? s->contacts : kNone, 5, 0, "contacts"));
  texts.push_back(fixed(s != nullptr ? millimetres(s->depth) : kNone, 2, 2, "mm deep"));
  texts.push_back(timing("simulation", &Snapshot::stepTime));
  texts.push_back(timing("servo", &Snapshot::tickTime));
  texts.push_back("missed " + fixed(times ? static_cast<double>(s->ticksMissed) : kNone, 4, 0, ""));
  texts.push_back(errorText(model.simulate.trade));

  std::vector<StripColumn> columns;
  float total = 0.0F;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const float width = i == 1 ? kTrace * scale : widthOf(font, texts[i]);
    columns.push_back({0.0F, width, texts[i]});
    total += width;
  }
  // What is left is shared out as gaps; where there is none, the last columns go.
  const float least = 14.0F * scale;
  while (columns.size() > 1 &&
         total + least * static_cast<float>(columns.size() - 1) > right - left) {
    total -= columns.back().width;
    columns.pop_back();
  }
  const float gap =
      std::min(44.0F * scale, (right - left - total) /
                                  static_cast<float>(std::max<std::size_t>(1, columns.size() - 1)));
  float x = left;
  for (StripColumn& column : columns) {
    column.x = std::round(x);
    x += column.width + gap;
  }
  return columns;
}

void drawStrip(const Painter& paint, const Rect& area, const Model& model) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const Theme& t = paint.theme;
  list->AddRectFilled({area.x, area.y}, {area.right(), area.bottom()}, packed(t.panel));
  ImFont* font = paint.fonts.secondary;
  const float margin = paint.px(Measures::kPadding + 2.0F);
  const auto columns =
      stripColumns(model, area.x + margin, area.right() - margin, paint.scale, font);
  const float y = std::round(area.y + 0.5F * (area.h - font->FontSize));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const StripColumn& column = columns[i];
    const bool strong = i == 0 || i == 2 || i == 3;
    const bool missed =
        i == 6 && model.snapshot != nullptr && !model.hideTimes && model.snapshot->ticksMissed > 0;
    const ImVec4& colour = missed                                ? t.attention
                           : strong && model.snapshot != nullptr ? t.text
                                                                 : t.secondary;
    if (i == 1) {
      // Force of the last seconds as bars from the bottom; full height is 4 N.
      const std::size_t bars = 14;
      const float each = column.width / static_cast<float>(bars);
      const float high = paint.px(18.0F);
      const float bottom = std::round(area.y + 0.5F * (area.h + high));
      for (std::size_t b = 0; b < bars; ++b) {
        const std::size_t from = model.forceTrace.size() * b / bars;
        const std::size_t to = std::max(from + 1, model.forceTrace.size() * (b + 1) / bars);
        float most = 0.0F;
        for (std::size_t k = from; k < std::min(to, model.forceTrace.size()); ++k) {
          most = std::max(most, model.forceTrace[k]);
        }
        const float h = std::max(paint.px(1.5F), high * std::min(1.0F, most / 4.0F));
        const float x = column.x + static_cast<float>(b) * each;
        list->AddRectFilled({x, bottom - h}, {x + each - paint.px(1.0F), bottom},
                            packed(most > 0.0F ? t.accent : t.line));
      }
      continue;
    }
    list->AddText(font, font->FontSize, {column.x, y}, packed(colour), column.text.c_str());
    if (i == 3 || i == 4 || i == 5 || i == 6) {
      if (i + 1 < columns.size()) {
        const float x = std::round(0.5F * (column.x + column.width + columns[i + 1].x));
        list->AddLine({x, area.y + paint.px(13.0F)}, {x, area.bottom() - paint.px(13.0F)},
                      packed(t.line), 1.0F);
      }
    }
  }
}

}  // namespace palpate::ui
