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

/// Of tools that draw, the step is made when the button is let go: there is nothing to apply.
bool applies(ToolKind kind) {
  return kind != ToolKind::Brush && kind != ToolKind::Eraser && kind != ToolKind::Scissors;
}

/// Whether there is a preview, and what it says: one line, so that nothing below it moves.
void drawPreview(const Painter& paint, const SegmentModel& segment, SegmentPanelState& state) {
  const bool refused = segment.previewRefused && !segment.previewing;
  if (refused && !segment.previewText.empty()) {
    notice(paint, MessageModel::Kind::Warning, segment.previewText);
  }
  const std::string said = segment.previewing ? "Making the preview\xe2\x80\xa6"
                           : refused          ? std::string()
                                              : segment.previewText;
  toggle(paint, "Preview", state.preview, true, state.preview ? said : std::string());
}

void drawApply(const Painter& paint, const Model& model, SegmentPanelState& state) {
  drawPreview(paint, model.segment, state);
  const auto step = stepOf(state);
  const std::string word = state.kind == ToolKind::Threshold
                               ? std::string("Segment tissue")
                               : std::string("Apply ") + toolWords(state.kind).title;
  if (button(paint, icon::kCheck, word, Emphasis::Primary, -1.0F, step.has_value())) {
    paint.actions.push_back(act::ApplyStep{*step});
    state.applied = recipeText({*step});
    if (state.kind == ToolKind::Threshold) state.label = state.name;
  }
}

void drawHistory(const Painter& paint, const SegmentModel& segment) {
  const auto words = [](const char* what, const std::string& step, const char* key) {
    return step.empty() ? std::string(what) : what + (": " + step) + key;
  };
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
                      ExchangePanelState& exchange, ViewState& views, double now) {
  heading(paint, "Segment");
  views.preview.reset();
  if (!model.openCase.open) {
    drawEmptyCase(paint, model);
    return;
  }
  const bool labelled = !model.segment.labels.empty();
  if (!labelled) state.kind = ToolKind::Threshold;
  // What applies and takes back is always in reach: only what lies above it scrolls.
  const float spacing = ImGui::GetStyle().ItemSpacing.y;
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() - paint.px(12.0F));  // a section brings its own
  ImGui::BeginChild("tools", {0.0F, -(state.footer + spacing)}, false,
                    ImGuiWindowFlags_NoBackground);
  drawLabelTable(paint, model.segment, state, exchange);
  drawTools(paint, state, labelled);
  section(paint, toolWords(state.kind).title);
  drawToolSettings(paint, model, state);
  const bool scrolls = ImGui::GetScrollMaxY() > 0.0F;
  ImGui::EndChild();
  if (scrolls) {
    const ImVec2 at = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
    ImGui::GetWindowDrawList()->AddLine({at.x, to.y}, to, packed(paint.theme.line),
                                        paint.px(Measures::kHairline));
  }
  const float top = ImGui::GetCursorPosY();
  if (applies(state.kind)) drawApply(paint, model, state);
  drawHistory(paint, model.segment);
  state.footer = ImGui::GetCursorPosY() - spacing - top;  // of the next frame: notices wrap
  requestPreview(paint, model, state, now);
  // While it is dragged, and until the true preview is there, the range shows on the slices.
  const bool ranged = state.kind == ToolKind::Threshold || state.kind == ToolKind::Grow;
  if (ranged && state.preview && !model.segment.previewShown && !state.wantedKey.empty() &&
      state.wantedKey != state.applied) {
    views.preview = ThresholdRange{static_cast<double>(state.low), static_cast<double>(state.high)};
  }
}

}  // namespace palpate::ui
