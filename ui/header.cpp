#include "ui/header.h"

#include <algorithm>
#include <cmath>

#include "ui/icons.h"

namespace palpate::ui {
namespace {

float textWidth(ImFont* font, const std::string& text) {
  return font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, text.c_str()).x;
}

void textAt(ImDrawList* list, ImFont* font, float x, const Rect& area, ImU32 colour,
            const std::string& text) {
  list->AddText(font, font->FontSize,
                {std::round(x), std::round(area.y + 0.5F * (area.h - font->FontSize))}, colour,
                text.c_str());
}

/// Returns the x where the tabs end.
float drawTabs(const Painter& paint, const Rect& area, float x, const Model& model) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < kTasks; ++i) {
    const auto task = static_cast<Task>(i);
    const std::string name = taskName(task);
    const bool on = model.task == task;
    ImFont* font = on ? paint.fonts.strong : paint.fonts.body;
    // The strong width always: a tab does not move when it is chosen.
    const float width = textWidth(paint.fonts.strong, name) + paint.px(24.0F);
    ImGui::SetCursorScreenPos({x, area.y});
    if (ImGui::InvisibleButton(name.c_str(), {width, area.h})) {
      paint.actions.push_back(act::ShowTask{task});
    }
    paint.note(name);
    const bool hot = ImGui::IsItemHovered();
    const ImVec4& colour = on || hot ? paint.theme.text : paint.theme.secondary;
    textAt(list, font, x + 0.5F * (width - textWidth(font, name)), area, packed(colour), name);
    if (on) {
      list->AddRectFilled({x + paint.px(12.0F), area.bottom() - paint.px(3.0F)},
                          {x + width - paint.px(12.0F), area.bottom()}, packed(paint.theme.accent),
                          paint.px(2.0F), ImDrawFlags_RoundCornersTop);
    }
    x += width;
  }
  return x;
}

/// Returns the x where the chip begins.
float drawChip(const Painter& paint, const Rect& area, const Model& model, float leftLimit) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const Theme& t = paint.theme;
  ImFont* font = paint.fonts.secondary;
  const ImVec4& dot = model.health == DeviceHealth::Good   ? t.accent
                      : model.health == DeviceHealth::Late ? t.attention
                                                           : t.danger;
  std::string text = model.simulate.info.name.empty() ? std::string("No device")
                                                      : model.simulate.info.name + " \xc2\xb7 " +
                                                            feltSentence(model.simulate.info);
  if (model.health != DeviceHealth::Good && !model.healthSentence.empty()) {
    text = model.healthSentence;
  }
  const float room = area.right() - leftLimit - paint.px(140.0F);
  text = shortened(text, font, std::max(paint.px(80.0F), room));
  const float width = textWidth(font, text) + paint.px(38.0F);
  const float height = paint.px(30.0F);
  const float x = area.right() - paint.px(Measures::kPadding) - width;
  const float y = std::round(area.y + 0.5F * (area.h - height));
  ImGui::SetCursorScreenPos({x, y});
  if (ImGui::InvisibleButton("Device", {width, height})) {
    paint.actions.push_back(act::ShowTask{Task::Simulate});
  }
  paint.note("Device");
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s\nOpens its set-up.", model.healthSentence.c_str());
  }
  list->AddRectFilled({x, y}, {x + width, y + height},
                      packed(ImGui::IsItemHovered() ? t.hover : t.raised), 0.5F * height);
  list->AddCircleFilled({x + paint.px(16.0F), y + 0.5F * height}, paint.px(4.5F), packed(dot), 24);
  textAt(list, font, x + paint.px(27.0F), {0, y, 0, height}, packed(t.text), text);
  return x;
}

}  // namespace

const char* taskName(Task task) {
  switch (task) {
    case Task::Library:
      return "Library";
    case Task::Segment:
      return "Segment";
    case Task::Simulate:
      return "Simulate";
    case Task::Review:
      return "Review";
  }
  return "";
}

std::string feltSentence(const DeviceInfo& info) {
  return info.feelsTorque ? "force and torque felt" : "force felt, torque drawn";
}

void drawHeader(const Painter& paint, const Rect& area, const Model& model) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const Theme& t = paint.theme;
  list->AddRectFilled({area.x, area.y}, {area.right(), area.bottom()}, packed(t.panel));
  float x = area.x + paint.px(Measures::kPadding + 2.0F);
  // The mark: a burr touching a surface.
  const float cy = area.y + 0.5F * area.h;
  const float r = paint.px(8.0F);
  list->AddCircleFilled({x + r, cy}, r, packed(t.accent), 32);
  list->AddCircleFilled({x + r + 0.55F * r, cy + 0.5F * r}, 0.42F * r, packed(t.panel), 24);
  x += 2.0F * r + paint.px(9.0F);
  textAt(list, paint.fonts.heading, x, area, packed(t.text), "Palpate");
  x = std::max(x + textWidth(paint.fonts.heading, "Palpate") + paint.px(20.0F), 0.0F);
  const float tabsEnd = drawTabs(paint, area, x, model);
  const float chip = drawChip(paint, area, model, tabsEnd);

  ImFont* font = paint.fonts.secondary;
  std::string title = "No case open";
  if (model.openCase.open) {
    title = model.openCase.title + " \xc2\xb7 ";
    if (!model.openCase.modality.empty()) title += model.openCase.modality + " ";
    title += model.openCase.geometry;
  }
  const float room = chip - tabsEnd - paint.px(48.0F);
  title = shortened(title, font, std::max(0.0F, room));
  const float at = chip - paint.px(20.0F) - textWidth(font, title);
  if (room > paint.px(40.0F)) textAt(list, font, at, area, packed(t.secondary), title);
  if (model.openCase.lossy && room > paint.px(60.0F)) {
    list->AddText(font, font->FontSize,
                  {at - paint.px(20.0F), std::round(cy - 0.5F * font->FontSize)},
                  packed(t.attention), icon::kWarning);
  }
}

}  // namespace palpate::ui
