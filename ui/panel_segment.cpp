#include <imgui.h>

#include <imgui_stdlib.h>  // after imgui.h: it does not include it itself

#include <algorithm>
#include <cmath>

#include "ui/colours.h"
#include "ui/format.h"
#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

/// The histogram with the chosen range lit; a drag moves the nearer end.
void drawHistogram(const Painter& paint, const CaseModel& open, SegmentPanelState& state) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = paint.px(64.0F);
  ImGui::InvisibleButton("histogram", {width, height});
  paint.note("Histogram");
  const ImVec2 a = ImGui::GetItemRectMin();
  const auto low = static_cast<float>(open.valueRange[0]);
  const float span = std::max(1e-6F, static_cast<float>(open.valueRange[1]) - low);
  if (ImGui::IsItemActive()) {
    const float value =
        low + span * std::clamp((ImGui::GetIO().MousePos.x - a.x) / width, 0.0F, 1.0F);
    float& nearer =
        std::abs(value - state.low) < std::abs(value - state.high) ? state.low : state.high;
    nearer = std::round(value);
    state.previewing = true;
  }
  ImDrawList* list = ImGui::GetWindowDrawList();
  const std::size_t bins = open.histogram.size();
  for (std::size_t i = 0; i < bins; ++i) {
    const float f0 = static_cast<float>(i) / static_cast<float>(bins);
    const float value = low + span * (f0 + 0.5F / static_cast<float>(bins));
    const bool in = value >= state.low && value <= state.high;
    const float x0 = a.x + width * f0;
    const float x1 = a.x + width * static_cast<float>(i + 1) / static_cast<float>(bins);
    const float h = std::max(paint.px(1.0F), height * open.histogram[i]);
    list->AddRectFilled({x0, a.y + height - h}, {std::max(x0 + 1.0F, x1 - 0.5F), a.y + height},
                        packed(in ? paint.theme.accent : paint.theme.hover));
  }
  for (const float edge : {state.low, state.high}) {
    const float x = std::round(a.x + width * std::clamp((edge - low) / span, 0.0F, 1.0F));
    list->AddLine({x, a.y}, {x, a.y + height}, packed(paint.theme.text, 0.7F), paint.px(1.0F));
  }
}

void drawRange(const Painter& paint, const CaseModel& open, SegmentPanelState& state) {
  section(paint, "RANGE");
  drawHistogram(paint, open, state);
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  const char* format = open.modality == "CT" ? "%.0f HU" : "%.4g";
  const auto speed = static_cast<float>((open.valueRange[1] - open.valueRange[0]) / 600.0);
  const auto least = static_cast<float>(open.valueRange[0]);
  const auto most = static_cast<float>(open.valueRange[1]);
  ImGui::SetNextItemWidth(half);
  bool changed = ImGui::DragFloat("##low", &state.low, speed, least, most, format);
  paint.note("Lower limit");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(half);
  changed = ImGui::DragFloat("##high", &state.high, speed, least, most, format) || changed;
  paint.note("Upper limit");
  if (changed) state.previewing = true;
  if (state.low > state.high) std::swap(state.low, state.high);
  toggle(paint, "Preview on the slices", state.previewing);
}

void drawLabels(const Painter& paint, const Model& model) {
  section(paint, "LABELS");
  if (model.segment.labels.empty()) {
    sentence(paint, "Nothing is labelled yet. Choose a preset above and press Segment tissue.");
  }
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (const LabelRow& label : model.segment.labels) {
    ImGui::PushID(label.value);
    const ImVec2 a = ImGui::GetCursorScreenPos();
    const float width = ImGui::GetContentRegionAvail().x;
    const float side = paint.px(14.0F);
    list->AddRectFilled({a.x, a.y + paint.px(7.0F)}, {a.x + side, a.y + paint.px(7.0F) + side},
                        IM_COL32(label.colour[0], label.colour[1], label.colour[2], 255),
                        paint.px(3.0F));
    const float left = a.x + side + paint.px(10.0F);
    list->AddText({left, a.y + paint.px(1.0F)}, packed(paint.theme.text),
                  shortened(label.name, paint.fonts.body, width - paint.px(100.0F)).c_str());
    ImFont* small = paint.fonts.secondary;
    const std::string detail = grouped(label.voxels) + " voxels \xc2\xb7 " +
                               grouped(static_cast<std::uint64_t>(label.mm3 + 0.5)) + " mm\xc2\xb3";
    list->AddText(small, small->FontSize, {left, a.y + paint.px(20.0F)},
                  packed(paint.theme.secondary), detail.c_str());
    ImGui::SetCursorScreenPos({a.x + width - paint.px(62.0F), a.y + paint.px(4.0F)});
    if (iconButton(paint, label.visible ? icon::kEye : icon::kEyeOff,
                   label.visible ? "Hide " + label.name : "Show " + label.name, label.visible)) {
      paint.actions.push_back(act::ShowLabel{label.value, !label.visible});
    }
    ImGui::SetCursorScreenPos({a.x + width - paint.px(30.0F), a.y + paint.px(4.0F)});
    if (iconButton(paint, icon::kClose, "Remove " + label.name, false, !model.job.active)) {
      paint.actions.push_back(act::DeleteLabel{label.value});
    }
    ImGui::SetCursorScreenPos({a.x, a.y + paint.px(42.0F)});
    ImGui::PopID();
  }
}

void choosePreset(const Preset& preset, SegmentPanelState& state) {
  state.name = preset.label;
  if (preset.range) {
    state.low = static_cast<float>(preset.range->low);
    state.high = static_cast<float>(preset.range->high);
  }
}

}  // namespace

void drawSegmentPanel(const Painter& paint, const Model& model, SegmentPanelState& state,
                      ViewState& views) {
  heading(paint, "Segment");
  if (!model.openCase.open) {
    views.preview.reset();
    drawEmptyCase(paint, model);
    return;
  }
  // Only what fits the scan: a CT's numbers mean nothing in an MR.
  std::vector<const Preset*> presets;
  for (const Preset& preset : segmentationPresets()) {
    if (preset.modality == model.openCase.presetModality) {
      presets.push_back(&preset);
    }
  }
  const auto choose = [&](std::size_t i) {
    state.preset = i;
    choosePreset(*presets[i], state);
    if (!presets[i]->range && i < model.presetRanges.size()) {
      state.low = static_cast<float>(model.presetRanges[i].low);
      state.high = static_cast<float>(model.presetRanges[i].high);
    }
  };
  if (state.initialisedFor != model.openCase.folder && !presets.empty()) {
    state.initialisedFor = model.openCase.folder;
    state.previewing = false;
    choose(0);
  }
  section(paint, "TISSUE");
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  for (std::size_t i = 0; i < presets.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine();
    // "Bone (CT)" and "Skin and all within": the first words are enough on a button.
    std::string title = presets[i]->title.substr(0, presets[i]->title.find(" ("));
    title = title.substr(0, title.find(" and "));
    if (button(paint, i == state.preset ? icon::kCheck : nullptr, title, Emphasis::Normal, half)) {
      choose(i);
      state.previewing = true;
    }
  }
  drawRange(paint, model.openCase, state);
  section(paint, "CLEAN UP");
  toggle(paint, "Largest part only", state.largest);
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::DragFloat("##islands", &state.minMm3, 5.0F, 0.0F, 1e6F,
                   state.minMm3 > 0 ? "Drop parts under %.0f mm\xc2\xb3" : "Keep small parts");
  paint.note("Smallest part");
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputTextWithHint("##name", "Name of the label", &state.name);
  paint.note("Name of the label");
  const bool pressed = button(paint, icon::kMagic, "Segment tissue", Emphasis::Primary, -1.0F,
                              !model.job.active && !state.name.empty());
  if (pressed) {
    const bool preset = state.preset < presets.size();
    act::Segment action;
    action.request.range = {static_cast<double>(state.low), static_cast<double>(state.high)};
    action.request.largestOnly = state.largest;
    action.request.minMm3 = static_cast<double>(state.minMm3);
    action.label = state.name;
    action.colour = preset && presets[state.preset]->label == state.name
                        ? presets[state.preset]->colour
                        : labelColour(model.segment.labels.size());
    action.material = preset ? presets[state.preset]->material : "bone";
    paint.actions.push_back(action);
    state.previewing = false;
  }
  if (!model.segment.undo.empty() && button(paint, icon::kUndo, "Undo: " + model.segment.undo,
                                            Emphasis::Quiet, -1.0F, !model.job.active)) {
    paint.actions.push_back(act::Undo{});
  }
  drawLabels(paint, model);
  views.preview.reset();
  if (state.previewing) {
    views.preview = ThresholdRange{static_cast<double>(state.low), static_cast<double>(state.high)};
  }
}

}  // namespace palpate::ui
