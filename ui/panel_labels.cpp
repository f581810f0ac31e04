/// The table of labels: which one the tools work on, what it is called, looks like and is made of.

#include <imgui.h>

#include <imgui_stdlib.h>  // after imgui.h: it does not include it itself

#include <algorithm>
#include <cmath>
#include <iterator>

#include "ui/colours.h"
#include "ui/format.h"
#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

constexpr float kRow = 34.0F;
constexpr std::size_t kRowsShown = 5;

void drawRow(const Painter& paint, const LabelRow& label, SegmentPanelState& state) {
  ImGui::PushID(label.value);
  const bool chosen = state.label == label.name;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 a = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const float buttons = paint.px(60.0F);
  if (ImGui::InvisibleButton("row", {width - buttons, paint.px(kRow)})) state.label = label.name;
  paint.note("Label " + label.name);
  const bool hot = ImGui::IsItemHovered();
  if (chosen || hot) {
    list->AddRectFilled(a, {a.x + width, a.y + paint.px(kRow)},
                        chosen ? packed(paint.theme.raised) : packed(paint.theme.hover, 0.5F),
                        paint.px(6.0F));
  }
  if (chosen) {
    list->AddRectFilled(a, {a.x + paint.px(3.0F), a.y + paint.px(kRow)}, packed(paint.theme.accent),
                        paint.px(2.0F));
  }
  const float side = paint.px(12.0F);
  const ImVec2 swatch(a.x + paint.px(10.0F), a.y + 0.5F * (paint.px(kRow) - side));
  list->AddRectFilled(swatch, {swatch.x + side, swatch.y + side},
                      IM_COL32(label.colour[0], label.colour[1], label.colour[2], 255),
                      paint.px(3.0F));
  const float left = swatch.x + side + paint.px(8.0F);
  ImFont* small = paint.fonts.secondary;
  const std::string volume =
      grouped(static_cast<std::uint64_t>(label.mm3 / 1000.0 + 0.5)) + " cm\xc2\xb3";
  const float wide = small->CalcTextSizeA(small->FontSize, 1e6F, 0.0F, volume.c_str()).x;
  const float right = a.x + width - buttons - paint.px(6.0F);
  list->AddText(small, small->FontSize, {right - wide, a.y + paint.px(10.0F)},
                packed(paint.theme.secondary), volume.c_str());
  const std::string name =
      shortened(label.name, paint.fonts.body, right - wide - left - paint.px(8.0F));
  list->AddText({left, a.y + paint.px(8.0F)}, packed(paint.theme.text), name.c_str());
  if (hot && name != label.name) ImGui::SetTooltip("%s", label.name.c_str());
  ImGui::SetCursorScreenPos({a.x + width - paint.px(60.0F), a.y + paint.px(3.0F)});
  if (iconButton(paint, label.visible ? icon::kEye : icon::kEyeOff,
                 label.visible ? "Hide " + label.name : "Show " + label.name, label.visible)) {
    paint.actions.push_back(act::ShowLabel{label.value, !label.visible});
  }
  ImGui::SetCursorScreenPos({a.x + width - paint.px(30.0F), a.y + paint.px(3.0F)});
  if (iconButton(paint, icon::kPencil, "Name, colour, material of " + label.name,
                 state.editing == label.value)) {
    state.editing = state.editing == label.value ? 0 : label.value;
    state.editName = label.name;
    state.label = label.name;
  }
  ImGui::SetCursorScreenPos({a.x, a.y + paint.px(kRow + 2.0F)});
  ImGui::PopID();
}

std::string describe(const MaterialRow& material) {
  char text[96];
  std::snprintf(text, sizeof text, "%.3g N/mm \xc2\xb7 friction %.2g \xc2\xb7 %.0f kg/m\xc2\xb3",
                material.stiffness_N_per_mm, material.friction, material.density_kg_per_m3);
  return text;
}

void chooseMaterial(const Painter& paint, const SegmentModel& segment, act::EditLabel& edit,
                    bool& changed) {
  ImGui::SetNextItemWidth(-1.0F);
  if (ImGui::BeginCombo("##material", edit.material.c_str())) {
    for (const MaterialRow& material : segment.materials) {
      if (ImGui::Selectable(material.name.c_str(), material.name == edit.material)) {
        edit.material = material.name;
        changed = true;
      }
      paint.note("Material " + material.name);
      if (material.critical) {
        ImGui::SameLine();
        ImGui::TextColored(paint.theme.attention, "critical");
      }
    }
    ImGui::EndCombo();
  }
  paint.note("Material");
  for (const MaterialRow& material : segment.materials) {
    if (material.name != edit.material) continue;
    sentence(paint, describe(material));
    if (material.critical) {
      notice(paint, MessageModel::Kind::Warning, "Critical: must not be touched.");
    }
  }
}

bool chooseColour(const Painter& paint, std::array<std::uint8_t, 3>& colour) {
  static constexpr std::array<std::array<std::uint8_t, 3>, 2> kTissue{
      {{227, 211, 177}, {201, 112, 100}}};
  bool changed = false;
  const float side = paint.px(22.0F);
  for (std::size_t i = 0; i < 9; ++i) {
    const auto c = i < kTissue.size() ? kTissue[i] : labelColour(i - kTissue.size());
    if (i > 0) ImGui::SameLine(0.0F, paint.px(6.0F));
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::InvisibleButton("colour", {side, side})) {
      colour = c;
      changed = true;
    }
    paint.note("Colour " + std::to_string(i + 1));
    const ImVec2 a = ImGui::GetItemRectMin(), b = ImGui::GetItemRectMax();
    ImGui::GetWindowDrawList()->AddRectFilled(a, b, IM_COL32(c[0], c[1], c[2], 255),
                                              paint.px(4.0F));
    if (c == colour) {
      ImGui::GetWindowDrawList()->AddRect(a, b, packed(paint.theme.text), paint.px(4.0F), 0,
                                          paint.px(2.0F));
    }
    ImGui::PopID();
  }
  return changed;
}

void drawEditor(const Painter& paint, const SegmentModel& segment, const LabelRow& label,
                SegmentPanelState& state) {
  act::EditLabel edit{label.value, label.name, label.colour, label.material};
  bool changed = false;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - paint.px(76.0F));
  ImGui::InputTextWithHint("##labelname", "Name", &state.editName);
  paint.note("Name of " + label.name);
  const bool typed = ImGui::IsItemDeactivatedAfterEdit();
  const bool typing = ImGui::IsItemActive();
  ImGui::SameLine();
  if (const AnatomyRow* anatomy = chooseAnatomy(paint, segment)) {
    edit = {label.value, anatomy->name, anatomy->colour, anatomy->material};
    changed = true;
  }
  ImGui::SameLine();
  const bool remove = iconButton(paint, icon::kTrash, "Remove " + label.name);
  if (typed && !state.editName.empty() && state.editName != label.name) {
    edit.name = state.editName;
    changed = true;
  }
  if (!typing) state.editName = label.name;  // also after undo, or where a name was refused
  changed = chooseColour(paint, edit.colour) || changed;
  chooseMaterial(paint, segment, edit, changed);
  if (changed) paint.actions.push_back(edit);
  if (remove) {
    paint.actions.push_back(act::ApplyStep{{label.name, tool::Remove{}, {}, {}}});
    state.editing = 0;
  }
}

/// Words that can be clicked, at the right of a section's title; gives where they begin.
bool link(const Painter& paint, const char* words, const char* tooltip, float right, float& left) {
  ImFont* small = paint.fonts.secondary;
  const ImVec2 size = small->CalcTextSizeA(small->FontSize, 1e6F, 0.0F, words);
  const float in = paint.px(6.0F);
  left = right - size.x - 2.0F * in;
  const float y = ImGui::GetItemRectMin().y;
  const float height = ImGui::GetItemRectSize().y;
  ImGui::SetCursorScreenPos({left, y - in});
  const bool pressed = ImGui::InvisibleButton(words, {size.x + 2.0F * in, height + 2.0F * in});
  paint.note(words);
  const bool hot = ImGui::IsItemHovered();
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (hot) {
    list->AddRectFilled(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                        packed(paint.theme.raised), paint.px(Measures::kCorner));
    ImGui::SetTooltip("%s", tooltip);
  }
  list->AddText(small, small->FontSize, {left + in, y}, packed(paint.theme.accent), words);
  return pressed;
}

/// Out to other programs and in from them, on the line of the section's title.
void drawExchangeLinks(const Painter& paint, bool labelled, ExchangePanelState& exchange) {
  using Dialog = ExchangePanelState::Dialog;
  const ImVec2 below = ImGui::GetCursorScreenPos();
  float right = below.x + ImGui::GetContentRegionAvail().x + paint.px(6.0F);
  const ImVec2 line = ImGui::GetItemRectMin();
  const float height = ImGui::GetItemRectSize().y;
  const auto sameLine = [&] {  // of the title, whatever was drawn since
    ImGui::SetCursorScreenPos(line);
    ImGui::Dummy({1.0F, height});
  };
  if (labelled) {
    sameLine();
    if (link(paint, "Export\xe2\x80\xa6", "Labels to a file for another program", right, right)) {
      exchange.wanted = Dialog::Export;
    }
  }
  sameLine();
  if (link(paint, "From file\xe2\x80\xa6", "Labels of another program into this case", right,
           right)) {
    exchange.wanted = Dialog::Join;
  }
  ImGui::SetCursorScreenPos(below);
}

}  // namespace

const AnatomyRow* chooseAnatomy(const Painter& paint, const SegmentModel& segment) {
  const AnatomyRow* chosen = nullptr;
  if (ImGui::BeginCombo("##anatomy", "",
                        ImGuiComboFlags_NoPreview | ImGuiComboFlags_PopupAlignLeft |
                            ImGuiComboFlags_HeightLargest)) {
    for (const AnatomyRow& anatomy : segment.anatomies) {
      if (ImGui::Selectable(anatomy.title.c_str())) chosen = &anatomy;
      paint.note("Anatomy " + anatomy.name);
    }
    ImGui::EndCombo();
  }
  paint.note("Usual names");
  return chosen;
}

void drawLabelTable(const Painter& paint, const SegmentModel& segment, SegmentPanelState& state,
                    ExchangePanelState& exchange) {
  section(paint, "LABELS");
  drawExchangeLinks(paint, !segment.labels.empty(), exchange);
  if (segment.labels.empty()) {
    sentence(paint, "Nothing is labelled yet. Choose a tissue below and press Segment tissue.");
    state.label.clear();
    return;
  }
  const auto chosen = [&](const LabelRow& row) { return row.name == state.label; };
  auto row = std::find_if(segment.labels.begin(), segment.labels.end(), chosen);
  if (row == segment.labels.end()) {  // renamed, or gone
    row = std::find_if(segment.labels.begin(), segment.labels.end(),
                       [&](const LabelRow& r) { return r.value == state.value; });
  }
  if (row == segment.labels.end()) row = std::prev(segment.labels.end());
  state.label = row->name;
  state.value = row->value;
  const std::size_t rows = std::min(segment.labels.size(), kRowsShown);
  const bool scrolls = segment.labels.size() > kRowsShown;
  if (scrolls) {
    ImGui::BeginChild("labels", {0.0F, static_cast<float>(rows) * paint.px(kRow + 2.0F)}, false,
                      ImGuiWindowFlags_NoBackground);
  }
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {paint.px(4.0F), 0.0F});
  for (const LabelRow& label : segment.labels) drawRow(paint, label, state);
  ImGui::PopStyleVar();
  if (scrolls) ImGui::EndChild();
  for (const LabelRow& label : segment.labels) {
    if (label.value == state.editing) drawEditor(paint, segment, label, state);
  }
}

}  // namespace palpate::ui
