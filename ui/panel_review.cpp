#include <algorithm>
#include <cmath>

#include "ui/format.h"
#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

/// Force over the session; a click or drag goes to that time.
void drawForceGraph(const Painter& paint, const ReviewModel& review) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = paint.px(96.0F);
  ImGui::InvisibleButton("force graph", {width, height});
  paint.note("Force graph");
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(a, b, packed(paint.theme.raised), paint.px(Measures::kCorner));
  if (ImGui::IsItemActive() && review.duration_s > 0.0) {
    const float f = std::clamp((ImGui::GetIO().MousePos.x - a.x) / width, 0.0F, 1.0F);
    paint.actions.push_back(act::Scrub{static_cast<double>(f) * review.duration_s});
  }
  float most = 1.0F;
  for (const float force : review.force_N) most = std::max(most, force);
  const std::size_t n = review.force_N.size();
  const auto duration = static_cast<float>(std::max(1e-6, review.duration_s));
  const float in = paint.px(6.0F);
  std::vector<ImVec2> line;
  for (std::size_t i = 0; i < n; ++i) {
    line.emplace_back(a.x + width * review.time_s[i] / duration,
                      b.y - in - (height - 2.0F * in) * review.force_N[i] / most);
  }
  if (line.size() > 1) {
    list->AddPolyline(line.data(), static_cast<int>(line.size()), packed(paint.theme.accent), 0,
                      paint.px(1.4F));
  }
  const float x = a.x + width * static_cast<float>(review.at_s) / duration;
  list->AddLine({x, a.y}, {x, b.y}, packed(paint.theme.text, 0.8F), paint.px(1.0F));
  ImFont* small = paint.fonts.secondary;
  list->AddText(small, small->FontSize, {a.x + in, a.y + paint.px(3.0F)},
                packed(paint.theme.secondary), fixed(static_cast<double>(most), 1, 1, "N").c_str());
}

void drawSessions(const Painter& paint, const ReviewModel& review) {
  section(paint, "SESSIONS");
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < review.sessions.size(); ++i) {
    const SessionRow& session = review.sessions[i];
    const bool on = review.chosen == i;
    const float width = ImGui::GetContentRegionAvail().x;
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::InvisibleButton("session", {width, paint.px(44.0F)}) && !on) {
      paint.actions.push_back(act::ChooseSession{i});
    }
    ImGui::PopID();
    paint.note("Session " + std::to_string(i + 1));
    const ImVec2 a = ImGui::GetItemRectMin();
    const ImVec2 b = ImGui::GetItemRectMax();
    if (on || ImGui::IsItemHovered()) {
      list->AddRectFilled(a, b, packed(on ? paint.theme.raised : paint.theme.hover),
                          paint.px(Measures::kCorner));
    }
    const float left = a.x + paint.px(32.0F);
    const float room = b.x - left - paint.px(6.0F);
    ImFont* small = paint.fonts.secondary;
    const bool whole = session.exact && session.finished;
    list->AddText({a.x + paint.px(8.0F), a.y + paint.px(6.0F)},
                  packed(whole ? paint.theme.secondary : paint.theme.attention),
                  whole ? icon::kFilm : icon::kWarning);
    list->AddText({left, a.y + paint.px(6.0F)}, packed(paint.theme.text),
                  shortened(session.title, paint.fonts.body, room).c_str());
    list->AddText(small, small->FontSize, {left, a.y + paint.px(24.0F)},
                  packed(paint.theme.secondary), shortened(session.detail, small, room).c_str());
  }
}

}  // namespace

void drawReviewPanel(const Painter& paint, const Model& model) {
  const ReviewModel& review = model.review;
  heading(paint, "Review");
  if (review.sessions.empty()) {
    sentence(paint, model.openCase.open
                        ? "No session is recorded for this case yet. Start a simulation and press "
                          "Record; the session then stands here."
                        : "No case is open, so there is nothing to review.");
    if (!model.openCase.open) {
      drawEmptyCase(paint, model);
    } else if (button(paint, icon::kRecord, "Go to Simulate", Emphasis::Primary)) {
      paint.actions.push_back(act::ShowTask{Task::Simulate});
    }
    return;
  }
  if (button(paint, icon::kHistory, "Replay and compare", Emphasis::Primary, -1.0F,
             review.chosen.has_value() && !model.job.active,
             "Computes every step again from the recorded motion and compares the states bit for "
             "bit.")) {
    paint.actions.push_back(act::Replay{});
  }
  if (review.verdict != ReviewModel::Verdict::None) {
    notice(paint,
           review.verdict == ReviewModel::Verdict::Identical ? MessageModel::Kind::Information
                                                             : MessageModel::Kind::Warning,
           review.verdictText);
  }
  if (review.chosen && !review.force_N.empty()) {
    section(paint, "FORCE ON THE HAND");
    drawForceGraph(paint, review);
    if (iconButton(paint, review.playing ? icon::kStop : icon::kPlay,
                   review.playing ? "Pause" : "Play")) {
      paint.actions.push_back(act::PlayPause{});
    }
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1.0F);
    auto at = static_cast<float>(review.at_s);
    const std::string shown = clockText(review.at_s) + " / " + clockText(review.duration_s);
    if (ImGui::SliderFloat("##at", &at, 0.0F, static_cast<float>(review.duration_s),
                           shown.c_str())) {
      paint.actions.push_back(act::Scrub{static_cast<double>(at)});
    }
    paint.note("Time");
  }
  drawSessions(paint, review);
}

}  // namespace palpate::ui
