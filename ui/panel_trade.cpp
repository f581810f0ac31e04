/// The part of the Simulate panel where speed is traded for accuracy: the measured settings as
/// dots, the front through the best of them, and a marker that the user moves along it.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "ui/icons.h"
#include "ui/panels.h"
#include "ui/trade_words.h"

namespace palpate::ui {
namespace {

constexpr float kHeight = 120.0F;  // of the plot, unscaled

/// Time of a step across, on a logarithmic axis; error of the force up, from zero.
struct Plot {
  ImVec2 low, high;  // left bottom, right top
  double timeLow = 1.0, timeHigh = 10.0, errorHigh = 1.0;

  Plot(const Painter& paint, const TradeModel& trade, ImVec2 a, ImVec2 b)
      : low(a.x + paint.px(10.0F), b.y - paint.px(22.0F)),
        high(b.x - paint.px(10.0F), a.y + paint.px(22.0F)) {
    timeLow = timeHigh = trade.rows.front().p99_us;
    errorHigh = 0.0;
    for (const TradeRowModel& row : trade.rows) {
      timeLow = std::min(timeLow, row.p99_us);
      timeHigh = std::max(timeHigh, row.p99_us);
      errorHigh = std::max(errorHigh, row.force_N);
    }
    timeLow = std::max(0.8 * timeLow, 0.01);
    timeHigh = std::max(1.25 * timeHigh, 2.0 * timeLow);
    errorHigh = errorHigh > 0.0 ? 1.05 * errorHigh : 1.0;
  }
  [[nodiscard]] ImVec2 at(const TradeRowModel& row) const {
    const double across =
        std::log(std::max(row.p99_us, timeLow) / timeLow) / std::log(timeHigh / timeLow);
    const double up = row.force_N / errorHigh;
    return {low.x + static_cast<float>(across) * (high.x - low.x),
            low.y + static_cast<float>(up) * (high.y - low.y)};
  }
};

/// Of the rows on the front, the one whose dot is nearest to the mouse.
std::optional<std::size_t> nearestOnFront(const Plot& plot, const TradeModel& trade, ImVec2 mouse) {
  std::optional<std::size_t> best;
  float least = 0.0F;
  for (std::size_t i = 0; i < trade.rows.size(); ++i) {
    if (!trade.rows[i].onFront) continue;
    const ImVec2 at = plot.at(trade.rows[i]);
    const float away = std::hypot(at.x - mouse.x, at.y - mouse.y);
    if (best && away >= least) continue;
    best = i;
    least = away;
  }
  return best;
}

void drawDots(const Painter& paint, const Plot& plot, const TradeModel& trade, std::size_t marked) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  ImFont* small = paint.fonts.secondary;
  const ImU32 words = packed(paint.theme.secondary);
  list->AddLine(plot.low, {plot.high.x, plot.low.y}, packed(paint.theme.line));
  list->AddText(small, small->FontSize, {plot.low.x, plot.high.y - paint.px(20.0F)}, words,
                "error of the force");
  const char* slower = "slower";
  const float width = small->CalcTextSizeA(small->FontSize, 1e6F, 0.0F, slower).x;
  list->AddText(small, small->FontSize, {plot.high.x - width, plot.low.y + paint.px(4.0F)}, words,
                slower);
  std::optional<ImVec2> before;  // rows are sorted by time, so is the front
  for (const TradeRowModel& row : trade.rows) {
    if (!row.onFront) continue;
    if (before) list->AddLine(*before, plot.at(row), packed(paint.theme.accent), paint.px(2.0F));
    before = plot.at(row);
  }
  for (const TradeRowModel& row : trade.rows) {
    list->AddCircleFilled(plot.at(row), paint.px(row.onFront ? 4.0F : 3.0F),
                          packed(row.onFront ? paint.theme.accent : paint.theme.secondary));
  }
  list->AddCircle(plot.at(trade.rows[marked]), paint.px(8.0F), packed(paint.theme.text), 0,
                  paint.px(2.0F));
}

void drawFront(const Painter& paint, const TradeModel& trade) {
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::InvisibleButton("Speed and accuracy", {width, paint.px(kHeight)});
  paint.note("Speed and accuracy");
  const ImVec2 a = ImGui::GetItemRectMin(), b = ImGui::GetItemRectMax();
  ImGui::GetWindowDrawList()->AddRectFilled(a, b, packed(paint.theme.raised),
                                            paint.px(Measures::kCorner));
  const Plot plot(paint, trade, a, b);
  std::size_t marked = std::min(trade.chosen, trade.rows.size() - 1);
  const bool held = ImGui::IsItemActive(), let = ImGui::IsItemDeactivated();
  if (held || let || ImGui::IsItemHovered()) {
    const auto nearest = nearestOnFront(plot, trade, ImGui::GetIO().MousePos);
    if (nearest && !held && !let) {
      ImGui::SetTooltip("%s\n%s", settingWords(trade.rows[*nearest].name).c_str(),
                        numbersText(trade.rows[*nearest]).c_str());
    }
    if (nearest && (held || let)) marked = *nearest;
    if (nearest && let && *nearest != trade.chosen) {
      paint.actions.push_back(act::ChooseTrade{trade.rows[*nearest].name});
    }
  }
  drawDots(paint, plot, trade, marked);
  space(paint, 6.0F);
  keyValue(paint, "Setting", settingWords(trade.rows[marked].name));
  keyValue(paint, "Error, time", numbersText(trade.rows[marked]));
}

}  // namespace

void drawTrade(const Painter& paint, const SimulateModel& simulate, const Snapshot* snapshot,
               bool busy) {
  const TradeModel& trade = simulate.trade;
  if (trade.rows.empty()) {
    keyValue(paint, "Error", "not measured");
  } else {
    drawFront(paint, trade);
  }
  if (simulate.running && snapshot != nullptr && snapshot->levels > 0) {
    keyValue(
        paint, "Governor",
        snapshot->level == 0 ? std::string("as chosen") : settingWords(snapshot->levelName.data()));
  }
  if (button(
          paint, icon::kCrosshair, trade.rows.empty() ? "Measure" : "Measure again",
          Emphasis::Normal, -1.0F, simulate.ready && !simulate.running && !busy,
          "Runs settings over an approach, a slide, a cavity and random approaches, and compares "
          "what is felt with an exact solution. Takes some seconds; the simulation has to be "
          "stopped.")) {
    paint.actions.push_back(act::MeasureTrade{});
  }
}

}  // namespace palpate::ui
