#include <algorithm>
#include <cmath>

#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

constexpr ImGuiWindowFlags kCard = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                   ImGuiWindowFlags_NoSavedSettings |
                                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
                                   ImGuiWindowFlags_AlwaysAutoResize;

/// A card whose upper or lower middle stands at a point.
bool beginCard(const Painter& paint, const char* id, ImVec2 at, ImVec2 pivot, float width) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
  ImGui::SetNextWindowSizeConstraints({width, 0.0F}, {width, 1e6F});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, paint.theme.panel);
  ImGui::PushStyleColor(ImGuiCol_Border, paint.theme.line);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1.0F);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {paint.px(14.0F), paint.px(12.0F)});
  return ImGui::Begin(id, nullptr, kCard);
}

void endCard() {
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor(2);
}

}  // namespace

void drawJob(const Painter& paint, const Rect& area, const JobModel& job) {
  constexpr double kSoon_s = 0.4;
  if (!job.active || job.seconds < kSoon_s) return;
  const float width = std::min(paint.px(380.0F), area.w - paint.px(24.0F));
  const ImVec2 at(area.x + 0.5F * area.w, area.bottom() - paint.px(16.0F));
  if (beginCard(paint, "##job", at, {0.5F, 1.0F}, width)) {
    ImGui::PushFont(paint.fonts.strong);
    ImGui::TextUnformatted(job.title.c_str());
    ImGui::PopFont();
    if (job.fraction >= 0.0) {
      char percent[16];
      std::snprintf(percent, sizeof percent, "%3.0f %%",
                    100.0 * std::clamp(job.fraction, 0.0, 1.0));
      ImGui::SameLine(width - paint.px(14.0F) - ImGui::CalcTextSize(percent).x);
      ImGui::TextColored(paint.theme.secondary, "%s", percent);
    }
    progressBar(paint, job.fraction, 5.0F);
    ImGui::PushFont(paint.fonts.secondary);
    const float room = ImGui::GetContentRegionAvail().x - paint.px(96.0F);
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(
        paint.theme.secondary, "%s",
        shortened(job.what.empty() ? "Starting" : job.what, paint.fonts.secondary, room).c_str());
    ImGui::PopFont();
    if (job.cancellable) {
      ImGui::SameLine(width - paint.px(14.0F + 84.0F));
      if (button(paint, nullptr, "Cancel", Emphasis::Normal, paint.px(84.0F))) {
        paint.actions.push_back(act::CancelJob{});
      }
    }
  }
  endCard();
}

void drawMessages(const Painter& paint, const Rect& area,
                  const std::vector<MessageModel>& messages) {
  const float width = std::min(paint.px(420.0F), area.w - paint.px(24.0F));
  float y = area.y + paint.px(48.0F);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const MessageModel& message = messages[i];
    const std::string id = "##message" + std::to_string(i);
    if (beginCard(paint, id.c_str(), {area.x + 0.5F * area.w, y}, {0.5F, 0.0F}, width)) {
      const Theme& t = paint.theme;
      const bool problem = message.kind == MessageModel::Kind::Problem;
      const bool warning = message.kind == MessageModel::Kind::Warning;
      ImGui::TextColored(problem   ? t.danger
                         : warning ? t.attention
                                   : t.accent,
                         "%s", problem || warning ? icon::kWarning : icon::kInfo);
      ImGui::SameLine();
      const float left = ImGui::GetCursorPosX();
      ImGui::PushTextWrapPos(width - paint.px(48.0F));
      ImGui::PushFont(paint.fonts.strong);
      ImGui::TextWrapped("%s", message.happened.c_str());
      ImGui::PopFont();
      ImGui::PushFont(paint.fonts.secondary);
      for (const std::string* text : {&message.meaning, &message.advice}) {
        if (text->empty()) continue;
        ImGui::SetCursorPosX(left);
        ImGui::TextColored(text == &message.advice ? t.text : t.secondary, "%s", text->c_str());
      }
      ImGui::PopFont();
      ImGui::PopTextWrapPos();
      ImGui::SetCursorPos({width - paint.px(38.0F), paint.px(8.0F)});
      if (iconButton(paint, icon::kClose, "Dismiss")) {
        paint.actions.push_back(act::DismissMessage{i});
      }
      y += ImGui::GetWindowHeight() + paint.px(8.0F);
    }
    endCard();
  }
}

void drawShortcuts(const Painter& paint, const Rect& window, bool& help) {
  if (!help) return;
  ImGui::GetForegroundDrawList();
  static constexpr const char* kRows[][2] = {
      {"1  2  3  4", "Library, Segment, Simulate, Review"},
      {"Space", "Start and stop the simulation"},
      {"R", "Record"},
      {"G", "Take the instrument with the mouse, or let go"},
      {"Shift", "Hold: the mouse moves the instrument"},
      {"Arrows, PgUp, PgDn", "Move the instrument; with Ctrl finely"},
      {"A", "Hold: force on"},
      {"In the hand", "Left: force on; right: turn; wheel: in and out"},
      {"F", "Centre on the instrument"},
      {"V", "Surface or volume rendering"},
      {"Esc", "Force off, at once; drop what is drawn; smaller view"},
      {"Ctrl Z, Ctrl Y", "Undo and redo a change of the labels"},
      {"Tools, left", "Click, paint or draw around, as the tool says"},
      {"Scissors in 3D", "Drag around what goes; Ctrl and drag turns the view"},
      {"?", "This list"},
      {"Left drag", "Turn the view; in a slice: set the crosshair"},
      {"Right drag", "Zoom; in a slice: window and level"},
      {"Middle drag", "Move the view"},
      {"Wheel", "Zoom; in a slice: next slice (Ctrl: zoom)"},
      {"Double-click", "One view fills the window"}};
  const float width = paint.px(560.0F);
  ImGui::SetNextWindowFocus();
  if (beginCard(paint, "##shortcuts", {window.x + 0.5F * window.w, window.y + 0.5F * window.h},
                {0.5F, 0.5F}, width)) {
    heading(paint, "Shortcuts");
    for (const auto& row : kRows) {
      ImGui::TextColored(paint.theme.accent, "%s", row[0]);
      ImGui::SameLine(paint.px(180.0F));
      ImGui::TextUnformatted(row[1]);
    }
    space(paint, 4.0F);
    if (button(paint, nullptr, "Close the list", Emphasis::Normal)) help = false;
  }
  endCard();
}

void drawCloseQuestion(const Painter& paint, const Rect& window) {
  const float width = paint.px(420.0F);
  ImGui::SetNextWindowFocus();
  if (beginCard(paint, "##close", {window.x + 0.5F * window.w, window.y + 0.5F * window.h},
                {0.5F, 0.5F}, width)) {
    heading(paint, "A recording is running");
    ImGui::TextWrapped("Closing now ends the recording; what was recorded so far is kept.");
    space(paint, 4.0F);
    const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
    if (button(paint, nullptr, "Stay", Emphasis::Primary, half)) {
      paint.actions.push_back(act::StayOpen{});
    }
    ImGui::SameLine();
    if (button(paint, nullptr, "End it and close", Emphasis::Danger, half)) {
      paint.actions.push_back(act::CloseAnyway{});
    }
  }
  endCard();
}

}  // namespace palpate::ui
