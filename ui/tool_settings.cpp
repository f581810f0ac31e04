/// The settings of each segmentation tool.

#include <imgui.h>

#include <imgui_stdlib.h>  // after imgui.h: it does not include it itself

#include <algorithm>
#include <cmath>

#include "core/base/counted.h"
#include "imaging/segment/apply.h"
#include "imaging/segment/recipe.h"
#include "ui/colours.h"
#include "ui/format.h"
#include "ui/icons.h"
#include "ui/panels.h"
#include "ui/view_edit.h"

namespace palpate::ui {
namespace {

/// A number with its unit over the panel's width.
bool drag(const Painter& paint, const char* label, float& value, float speed, float low, float high,
          const char* format) {
  ImGui::PushID(label);
  ImGui::SetNextItemWidth(-1.0F);
  const bool changed =
      ImGui::DragFloat("##value", &value, speed, low, high, format, ImGuiSliderFlags_AlwaysClamp);
  ImGui::PopID();
  paint.note(label);
  return changed;
}

/// As fine as the scan's values: whole numbers, unless all of them lie close together.
float rounded(float value, float span) {
  return span >= 100.0F ? std::round(value) : value;
}

/// The histogram with the chosen range lit; a drag moves the end that was nearer when it began.
void drawHistogram(const Painter& paint, const CaseModel& open, SegmentPanelState& state) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = paint.px(40.0F);
  ImGui::InvisibleButton("histogram", {width, height});
  paint.note("Histogram");
  const ImVec2 a = ImGui::GetItemRectMin();
  const auto low = static_cast<float>(open.valueRange[0]);
  const float span = std::max(1e-6F, static_cast<float>(open.valueRange[1]) - low);
  const bool held = ImGui::IsItemActive();
  const bool hot = held || ImGui::IsItemHovered();
  const float under =
      low + span * std::clamp((ImGui::GetIO().MousePos.x - a.x) / width, 0.0F, 1.0F);
  const std::size_t nearer = std::abs(under - state.low) < std::abs(under - state.high) ||
                                     (state.low == state.high && under < state.low)
                                 ? 0
                                 : 1;
  if (hot) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (!held) state.dragged.reset();
  if (held && !state.dragged) state.dragged = nearer;
  if (held && *state.dragged == 0) state.low = std::min(rounded(under, span), state.high);
  if (held && *state.dragged == 1) state.high = std::max(rounded(under, span), state.low);
  const std::size_t lit = state.dragged.value_or(nearer);
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
  for (std::size_t end = 0; end < 2; ++end) {
    const float edge = end == 0 ? state.low : state.high;
    const float half = paint.px(3.0F);
    const float x =
        std::round(std::clamp(a.x + width * (edge - low) / span, a.x + half, a.x + width - half));
    const ImU32 colour =
        hot && lit == end ? packed(paint.theme.text) : packed(paint.theme.text, 0.7F);
    list->AddLine({x, a.y}, {x, a.y + height}, colour, paint.px(1.0F));
    list->AddRectFilled({x - half, a.y + 0.5F * height - paint.px(8.0F)},
                        {x + half, a.y + 0.5F * height + paint.px(8.0F)}, colour, half);
  }
}

void drawRange(const Painter& paint, const CaseModel& open, SegmentPanelState& state) {
  drawHistogram(paint, open, state);
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  const char* format = open.modality == "CT" ? "%.0f HU" : "%.4g";
  const auto speed = static_cast<float>((open.valueRange[1] - open.valueRange[0]) / 600.0);
  const auto least = static_cast<float>(open.valueRange[0]);
  const auto most = static_cast<float>(open.valueRange[1]);
  ImGui::SetNextItemWidth(half);
  // An end that passes the other takes it along.
  if (ImGui::DragFloat("##low", &state.low, speed, least, most, format)) {
    state.high = std::max(state.high, state.low);
  }
  paint.note("Lower limit");
  ImGui::SameLine();
  ImGui::SetNextItemWidth(half);
  if (ImGui::DragFloat("##high", &state.high, speed, least, most, format)) {
    state.low = std::min(state.low, state.high);
  }
  paint.note("Upper limit");
}

/// Only what fits the scan: a CT's numbers mean nothing in an MR.
std::vector<const Preset*> presetsFor(const CaseModel& open) {
  std::vector<const Preset*> presets;
  for (const Preset& preset : segmentationPresets()) {
    if (preset.modality == open.presetModality) presets.push_back(&preset);
  }
  return presets;
}

std::optional<ThresholdRange> rangeOf(const Model& model, const Preset& preset, std::size_t i) {
  if (preset.range) return preset.range;
  if (i < model.presetRanges.size()) return model.presetRanges[i];
  return {};
}

void choosePreset(const Model& model, const Preset& preset, std::size_t i,
                  SegmentPanelState& state) {
  state.preset = i;
  state.name = preset.label;
  if (const auto range = rangeOf(model, preset, i)) {
    state.low = static_cast<float>(range->low);
    state.high = static_cast<float>(range->high);
  }
}

/// Until the range is another.
bool isPreset(const Model& model, const Preset& preset, std::size_t i,
              const SegmentPanelState& state) {
  const auto range = rangeOf(model, preset, i);
  return i == state.preset && range && static_cast<float>(range->low) == state.low &&
         static_cast<float>(range->high) == state.high;
}

void drawThreshold(const Painter& paint, const Model& model, SegmentPanelState& state) {
  const auto presets = presetsFor(model.openCase);
  if (state.initialisedFor != model.openCase.folder && !presets.empty()) {
    state.initialisedFor = model.openCase.folder;
    choosePreset(model, *presets[0], 0, state);
    if (const auto step = stepOf(state)) state.applied = recipeText({*step});  // nothing asked yet
  }
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  for (std::size_t i = 0; i < presets.size(); ++i) {
    if (i % 2 == 1) ImGui::SameLine();
    // "Bone (CT)" and "Skin and all within": the first words are enough on a button.
    std::string title = presets[i]->title.substr(0, presets[i]->title.find(" ("));
    title = title.substr(0, title.find(" and "));
    const bool on = isPreset(model, *presets[i], i, state);
    if (button(paint, on ? icon::kCheck : nullptr, title, Emphasis::Normal, half)) {
      choosePreset(model, *presets[i], i, state);
      state.applied.clear();
    }
  }
  drawRange(paint, model.openCase, state);
  toggle(paint, "Largest part only", state.largest);
  drag(paint, "Smallest part", state.minMm3, 5.0F, 0.0F, 1e6F,
       state.minMm3 > 0 ? "Drop parts under %.0f mm\xc2\xb3" : "Keep small parts");
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - paint.px(40.0F));
  ImGui::InputTextWithHint("##name", "Name of the label", &state.name);
  paint.note("Name of the label");
  ImGui::SameLine();
  if (const AnatomyRow* anatomy = chooseAnatomy(paint, model.segment)) state.name = anatomy->name;
}

void drawPicks(const Painter& paint, SegmentPanelState& state, const char* what) {
  if (state.missed) {
    notice(paint, MessageModel::Kind::Warning,
           "There is nothing of " + state.label + " where you clicked.");
  }
  if (state.picks.empty()) {
    sentence(paint, what);
    return;
  }
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  if (button(paint, icon::kUndo, "Last click", Emphasis::Normal, half)) state.picks.pop_back();
  ImGui::SameLine();
  if (button(paint, icon::kClose, "All clicks", Emphasis::Normal, half)) state.picks.clear();
}

void drawGrow(const Painter& paint, const Model& model, SegmentPanelState& state) {
  drawRange(paint, model.openCase, state);
  drag(paint, "Reach", state.reachMm, 0.5F, 0.0F, 500.0F,
       state.reachMm > 0 ? "Within %.0f mm of a click" : "However far");
  drawPicks(paint, state, "Click on the tissue in a slice.");
}

void drawIslands(const Painter& paint, SegmentPanelState& state) {
  state.islands = static_cast<int>(segmented(paint, "islands", {"Largest", "Size", "Keep", "Drop"},
                                             static_cast<std::size_t>(state.islands)));
  if (state.islands == 0) {
    int count = state.islandCount;
    slider(paint, "Parts to keep", count, 1, 12);
    state.islandCount = count;
  } else if (state.islands == 1) {
    drag(paint, "Smallest part to keep", state.islandMm3, 5.0F, 0.0F, 1e6F,
         "Keep from %.0f mm\xc2\xb3");
  } else {
    drawPicks(paint, state,
              state.islands == 2 ? "Click on the parts to keep, in a slice or in 3D."
                                 : "Click on the parts to drop, in a slice or in 3D.");
  }
}

void drawBrushSettings(const Painter& paint, SegmentPanelState& state) {
  drag(paint, "Brush size", state.brushMm, 0.1F, 0.2F, 100.0F, "%.1f mm across");
  state.sphere = segmented(paint, "shape", {"This slice", "Ball"}, state.sphere ? 1 : 0) == 1;
  sentence(paint, state.kind == ToolKind::Eraser ? "Drag over what is to go, in a slice."
                                                 : "Drag over the tissue in a slice.");
}

void drawScissors(const Painter& paint, SegmentPanelState& state) {
  state.keepInside =
      segmented(paint, "inside", {"Cut inside", "Cut outside"}, state.keepInside ? 1 : 0) == 1;
  state.throughAll =
      segmented(paint, "depth", {"All slices", "This slice"}, state.throughAll ? 0 : 1) == 0;
  sentence(paint,
           "Drag around it, in 3D or in a slice. In 3D the cut goes all the way through; Ctrl and "
           "drag turns the view.");
}

void drawBoxSettings(const Painter& paint, SegmentPanelState& state) {
  state.keepInside =
      segmented(paint, "box", {"Cut inside", "Keep inside"}, state.keepInside ? 1 : 0) == 1;
  toggle(paint, "All labels", state.allLabels);
  if (!state.box_mm) {
    sentence(paint, "Drag a rectangle in a slice. Its sides can be dragged, in all slices.");
  } else if (button(paint, icon::kClose, "Clear the box")) {
    state.box_mm.reset();
  }
}

/// Each part in the colour of its label, or in that which a new label of the name gets.
void colourParts(const SegmentModel& segment, SegmentPanelState& state) {
  LabelTable before;
  for (const LabelRow& row : segment.labels) {
    before.push_back({row.name, row.value, row.colour, row.material});
  }
  LabelTable table = before;
  state.partColours.clear();
  for (std::size_t p = 0; p < state.parts.size(); ++p) {
    const std::string& name = state.parts[p];
    const auto row = rowFor(name.empty() ? "part " + std::to_string(p) : name, table);
    auto colour = row ? row->colour : labelColour(p);
    const bool old = std::any_of(before.begin(), before.end(),
                                 [&name](const LabelInfo& l) { return l.name == name; });
    for (const AnatomyRow& anatomy : segment.anatomies) {
      if (!old && anatomy.name == name) colour = anatomy.colour;
    }
    state.partColours.push_back(IM_COL32(colour[0], colour[1], colour[2], 255));
  }
}

void drawSplit(const Painter& paint, const SegmentModel& segment, SegmentPanelState& state) {
  if (state.parts.empty() || state.parts[0] != state.label) {
    state.parts = {state.label, ""};
    state.part = 0;
    state.picks.clear();
  }
  colourParts(segment, state);
  for (std::size_t p = 0; p < state.parts.size(); ++p) {
    ImGui::PushID(static_cast<int>(p));
    const float side = paint.px(32.0F);
    const ImVec2 a = ImGui::GetCursorScreenPos();
    if (ImGui::InvisibleButton("part", {side, side})) state.part = p;
    paint.note("Seeds of part " + std::to_string(p + 1));
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 middle(a.x + 0.5F * side, a.y + 0.5F * side);
    if (p == state.part) {
      list->AddRectFilled(a, {a.x + side, a.y + side}, packed(paint.theme.raised), paint.px(6.0F));
      list->AddCircle(middle, paint.px(10.0F), packed(paint.theme.text), 24, paint.px(1.5F));
    }
    list->AddCircleFilled(middle, paint.px(6.0F), pickColour(state, p), 20);
    ImGui::SameLine();
    const auto clicks = std::count_if(state.picks.begin(), state.picks.end(),
                                      [p](const auto& pick) { return pick.part == p; });
    const std::string count = counted(static_cast<std::size_t>(clicks), "click", "clicks");
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - paint.px(102.0F));
    if (p == 0) {
      ImGui::AlignTextToFramePadding();
      ImGui::TextUnformatted(shortened(state.label, paint.fonts.body, paint.px(150.0F)).c_str());
    } else {
      ImGui::InputTextWithHint("##part", "Name", &state.parts[p]);
      if (ImGui::IsItemActivated()) state.part = p;
      paint.note("Name of part " + std::to_string(p + 1));
      ImGui::SameLine();
      if (const AnatomyRow* anatomy = chooseAnatomy(paint, segment)) {
        state.parts[p] = anatomy->name;
        state.part = p;
      }
    }
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - paint.px(54.0F));
    ImGui::PushFont(paint.fonts.secondary);
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(paint.theme.secondary, "%s", count.c_str());
    ImGui::PopFont();
    ImGui::PopID();
  }
  if (state.parts.size() < 8 && button(paint, icon::kPlus, "Another part", Emphasis::Quiet)) {
    state.parts.emplace_back();
    state.part = state.parts.size() - 1;
  }
  state.byEdges = segmented(paint, "by", {"Dark joint", "Edge"}, state.byEdges ? 1 : 0) == 1;
  drawPicks(paint, state, "Choose a part, then click on it.");
}

void drawCombine(const Painter& paint, const SegmentModel& segment, SegmentPanelState& state) {
  state.combine = static_cast<int>(segmented(paint, "combine", {"Add", "Subtract", "Intersect"},
                                             static_cast<std::size_t>(state.combine)));
  ImGui::SetNextItemWidth(-1.0F);
  if (ImGui::BeginCombo("##other", state.other.empty() ? "Another label" : state.other.c_str())) {
    for (const LabelRow& label : segment.labels) {
      if (label.name == state.label) continue;
      if (ImGui::Selectable(label.name.c_str(), label.name == state.other)) {
        state.other = label.name;
      }
    }
    ImGui::EndCombo();
  }
  paint.note("Other label");
  const auto other = [&](const LabelRow& row) {
    return row.name == state.other && row.name != state.label;
  };
  if (std::none_of(segment.labels.begin(), segment.labels.end(), other)) state.other.clear();
  drag(paint, "Grown by", state.grownMm, 0.1F, 0.0F, 50.0F,
       state.grownMm > 0 ? "grown by %.1f mm" : "as it is");
  if (segment.labels.size() < 2) sentence(paint, "There is only one label yet.");
}

void drawLimits(const Painter& paint, const Model& model, SegmentPanelState& state) {
  const bool onlyTakes = state.kind == ToolKind::Scissors || state.kind == ToolKind::Box ||
                         state.kind == ToolKind::Eraser;
  if (!onlyTakes) toggle(paint, "May take from other labels", state.overOthers);
  toggle(paint, "Only values in a range", state.onlyRange);
  if (state.onlyRange) drawRange(paint, model.openCase, state);
}

}  // namespace

void drawToolSettings(const Painter& paint, const Model& model, SegmentPanelState& state) {
  switch (state.kind) {
    case ToolKind::Threshold:
      return drawThreshold(paint, model, state);
    case ToolKind::Grow:
      return drawGrow(paint, model, state);
    case ToolKind::Islands:
      return drawIslands(paint, state);
    case ToolKind::FillHoles:
      drag(paint, "Largest hole", state.holeMm3, 10.0F, 0.0F, 1e7F,
           state.holeMm3 > 0 ? "Up to %.0f mm\xc2\xb3" : "Of any size");
      return;
    case ToolKind::Margin:
      state.margin =
          static_cast<int>(segmented(paint, "margin", {"Grow", "Shrink", "Open", "Close"},
                                     static_cast<std::size_t>(state.margin)));
      drag(paint, "By", state.marginMm, 0.05F, 0.1F, 50.0F, "%.1f mm");
      if (state.margin == 2) sentence(paint, "Open takes away what is thinner than twice this.");
      if (state.margin == 3) sentence(paint, "Close fills gaps narrower than twice this.");
      break;
    case ToolKind::Smooth:
      drag(paint, "Over", state.smoothMm, 0.05F, 0.1F, 20.0F, "%.1f mm");
      toggle(paint, "Keep thin bone", state.keepThin);
      break;
    case ToolKind::Brush:
    case ToolKind::Eraser:
      drawBrushSettings(paint, state);
      break;
    case ToolKind::Scissors:
      drawScissors(paint, state);
      break;
    case ToolKind::Box:
      drawBoxSettings(paint, state);
      break;
    case ToolKind::Split:
      return drawSplit(paint, model.segment, state);
    case ToolKind::Combine:
      drawCombine(paint, model.segment, state);
      break;
  }
  drawLimits(paint, model, state);
}

}  // namespace palpate::ui
