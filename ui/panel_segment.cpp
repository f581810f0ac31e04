/// The Segment panel: labels, tools, settings, preview and apply.

#include <imgui.h>

#include "imaging/segment/recipe.h"
#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

constexpr double kSettled_s = 0.15;  // a setting that moves is not previewed yet

void drawTools(const Painter& paint, SegmentPanelState& state, bool labelled) {
  section(paint, "TOOL");
  constexpr std::size_t kColumns = 6;
  const float gap = paint.px(4.0F);
  const float width = ImGui::GetContentRegionAvail().x;
  const float w = std::floor((width - gap * (kColumns - 1)) / kColumns);
  const float h = paint.px(32.0F);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  for (std::size_t i = 0; i < kTools; ++i) {
    const auto kind = static_cast<ToolKind>(i);
    const ToolWords& words = toolWords(kind);
    const bool enabled = labelled || kind == ToolKind::Threshold;
    const ImVec2 a(origin.x + static_cast<float>(i % kColumns) * (w + gap),
                   origin.y + static_cast<float>(i / kColumns) * (h + gap));
    ImGui::SetCursorScreenPos(a);
    ImGui::BeginDisabled(!enabled);
    if (ImGui::InvisibleButton(words.title, {w, h}) && enabled && state.kind != kind) {
      state.kind = kind;
      state.forget();
      state.applied.clear();  // the same setting again is wanted again
    }
    ImGui::EndDisabled();
    paint.note(words.title);
    const bool on = state.kind == kind;
    const bool hot = enabled && ImGui::IsItemHovered();
    list->AddRectFilled(a, {a.x + w, a.y + h},
                        on    ? packed(paint.theme.accent, 0.22F)
                        : hot ? packed(paint.theme.hover)
                              : packed(paint.theme.raised),
                        paint.px(6.0F));
    const ImVec2 size = ImGui::CalcTextSize(words.icon);
    list->AddText({std::round(a.x + 0.5F * (w - size.x)), std::round(a.y + 0.5F * (h - size.y))},
                  packed(on ? paint.theme.accent : paint.theme.text, enabled ? 1.0F : 0.35F),
                  words.icon);
    if (ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
      ImGui::SetTooltip("%s", enabled ? words.tooltip : "Make a label first.");
    }
  }
  ImGui::SetCursorScreenPos({origin.x, origin.y + 2.0F * (h + gap)});
}

/// Asks for the preview of what is set now, once it has settled; or for none.
void requestPreview(const Painter& paint, const Model& model, SegmentPanelState& state,
                    double now) {
  const auto step = state.preview ? stepOf(state) : std::nullopt;
  const std::string key = step ? recipeText({*step}) : std::string();
  if (key != state.wantedKey) {
    state.wantedKey = key;
    state.changedAt = now;
    if (!state.sentKey.empty()) paint.actions.push_back(act::DropPreview{});
    state.sentKey.clear();
  }
  const bool due = !key.empty() && state.sentKey != key && state.applied != key &&
                   now - state.changedAt >= kSettled_s;
  if (!due || ImGui::IsAnyItemActive() || model.job.active) return;
  paint.actions.push_back(act::PreviewStep{*step});
  state.sentKey = key;
}

void drawApply(const Painter& paint, const Model& model, SegmentPanelState& state) {
  const auto step = stepOf(state);
  const bool draws = state.kind == ToolKind::Brush || state.kind == ToolKind::Eraser ||
                     state.kind == ToolKind::Scissors;
  if (!draws) {
    toggle(paint, "Preview", state.preview);
    const std::string word = state.kind == ToolKind::Threshold
                                 ? std::string("Segment tissue")
                                 : std::string("Apply ") + toolWords(state.kind).title;
    if (button(paint, icon::kCheck, word, Emphasis::Primary, -1.0F, step.has_value())) {
      paint.actions.push_back(act::ApplyStep{*step});
      state.applied = recipeText({*step});
      if (state.kind == ToolKind::Threshold) state.label = state.name;
    }
    if (model.segment.previewing) {
      sentence(paint, "Making the preview\xe2\x80\xa6");
    } else if (!model.segment.previewText.empty()) {
      if (model.segment.previewRefused) {
        notice(paint, MessageModel::Kind::Warning, model.segment.previewText);
      } else {
        sentence(paint, model.segment.previewText);
      }
    }
  }
}

/// Always in reach, however long the settings are.
void drawFooter(const Painter& paint, const SegmentModel& segment) {
  const auto words = [](const char* what, const std::string& step, const char* key) {
    return step.empty() ? std::string(what) : what + (": " + step) + key;
  };
  ImGui::Dummy({1.0F, paint.px(2.0F)});
  const float side = paint.px(44.0F);
  const std::string undo = words("Undo", segment.undo, " (Ctrl Z)");
  const std::string redo = words("Redo", segment.redo, " (Ctrl Y)");
  if (button(paint, nullptr, icon::kUndo, Emphasis::Normal, side, !segment.undo.empty(),
             undo.c_str())) {
    paint.actions.push_back(act::Undo{});
  }
  paint.note("Undo");
  ImGui::SameLine();
  if (button(paint, nullptr, icon::kRedo, Emphasis::Normal, side, !segment.redo.empty(),
             redo.c_str())) {
    paint.actions.push_back(act::Redo{});
  }
  paint.note("Redo");
  ImGui::SameLine();
  if (button(paint, icon::kHand, "Touch it", Emphasis::Normal, -1.0F, !segment.labels.empty(),
             "Feel these labels: the simulation starts as soon as they are ready")) {
    paint.actions.push_back(act::TouchIt{});
  }
}

}  // namespace

void drawSegmentPanel(const Painter& paint, const Model& model, SegmentPanelState& state,
                      ViewState& views, double now) {
  heading(paint, "Segment");
  views.preview.reset();
  if (!model.openCase.open) {
    drawEmptyCase(paint, model);
    return;
  }
  const bool labelled = !model.segment.labels.empty();
  if (!labelled) state.kind = ToolKind::Threshold;
  const float footer = paint.px(Measures::kControl + 4.0F) + 2.0F * ImGui::GetStyle().ItemSpacing.y;
  ImGui::BeginChild("tools", {0.0F, -footer}, false, ImGuiWindowFlags_NoBackground);
  drawLabelTable(paint, model.segment, state);
  drawTools(paint, state, labelled);
  section(paint, toolWords(state.kind).title);
  drawToolSettings(paint, model, state);
  drawApply(paint, model, state);
  ImGui::EndChild();
  drawFooter(paint, model.segment);
  requestPreview(paint, model, state, now);
  // While it is dragged, and until the true preview is there, the range shows on the slices.
  const bool ranged = state.kind == ToolKind::Threshold || state.kind == ToolKind::Grow;
  if (ranged && state.preview && !model.segment.previewShown && !state.wantedKey.empty() &&
      state.wantedKey != state.applied) {
    views.preview = ThresholdRange{static_cast<double>(state.low), static_cast<double>(state.high)};
  }
}

}  // namespace palpate::ui
