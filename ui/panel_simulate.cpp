#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/geometry/units.h"
#include "core/haptics/safety.h"
#include "ui/format.h"
#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

/// The instrument from the side, its working end to the left, to scale with its neighbours.
void drawProfile(const Painter& paint, const InstrumentRow& row, ImVec2 a, float width,
                 float height) {
  if (row.outline.size() < 2) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  float length = 1.0F;
  float thick = 0.5F;
  for (const auto& p : row.outline) {
    length = std::max(length, p[0]);
    thick = std::max(thick, p[1]);
  }
  const float s = std::min(width / length, 0.46F * height / thick);
  const float cy = a.y + 0.5F * height;
  for (std::size_t i = 0; i + 1 < row.outline.size(); ++i) {
    const auto& p = row.outline[i];
    const auto& q = row.outline[i + 1];
    const float x0 = a.x + s * p[0];
    const float x1 = a.x + s * q[0];
    const float r0 = std::max(0.6F, s * p[1]);
    const float r1 = std::max(0.6F, s * q[1]);
    list->AddQuadFilled({x0, cy - r0}, {x1, cy - r1}, {x1, cy}, {x0, cy},
                        packed(paint.theme.text, 0.80F));
    list->AddQuadFilled({x0, cy}, {x1, cy}, {x1, cy + r1}, {x0, cy + r0},
                        packed(paint.theme.secondary, 0.75F));
  }
}

void drawInstruments(const Painter& paint, const SimulateModel& simulate) {
  section(paint, "INSTRUMENT");
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (std::size_t i = 0; i < simulate.instruments.size(); ++i) {
    const InstrumentRow& row = simulate.instruments[i];
    const bool on = i == simulate.instrument;
    const float width = ImGui::GetContentRegionAvail().x;
    const float height = paint.px(50.0F);
    ImGui::BeginDisabled(simulate.running);
    if (ImGui::InvisibleButton(row.title.c_str(), {width, height}) && !on) {
      paint.actions.push_back(act::ChooseInstrument{i});
    }
    ImGui::EndDisabled();
    paint.note(row.title);
    const ImVec2 a = ImGui::GetItemRectMin();
    const ImVec2 b = ImGui::GetItemRectMax();
    if (on || ImGui::IsItemHovered()) {
      list->AddRectFilled(a, b, packed(on ? paint.theme.raised : paint.theme.hover),
                          paint.px(Measures::kCorner));
    }
    if (on) {
      list->AddRectFilled(a, {a.x + paint.px(3.0F), b.y}, packed(paint.theme.accent),
                          paint.px(2.0F));
    }
    if (ImGui::IsItemHovered() && !row.description.empty()) {
      ImGui::SetTooltip("%s", row.description.c_str());
    }
    drawProfile(paint, row, {a.x + paint.px(12.0F), a.y}, paint.px(78.0F), height);
    const float left = a.x + paint.px(102.0F);
    ImFont* small = paint.fonts.secondary;
    list->AddText({left, a.y + paint.px(7.0F)}, packed(paint.theme.text),
                  shortened(row.title.substr(0, row.title.find(',')), paint.fonts.body,
                            b.x - left - paint.px(6.0F))
                      .c_str());
    char size[96];
    std::snprintf(size, sizeof size, "%.0f \xc3\x97 %.1f mm \xc2\xb7 %.0f g", row.length_mm,
                  row.width_mm, row.mass_g);
    list->AddText(small, small->FontSize, {left, a.y + paint.px(27.0F)},
                  packed(paint.theme.secondary), size);
  }
}

void drawSafety(const Painter& paint, const Model& model, bool& spaceHolds) {
  const SimulateModel& simulate = model.simulate;
  const Snapshot* s = model.snapshot;
  section(paint, "FORCE");
  if (simulate.running && s != nullptr) {
    if (s->fault != SafetyFault::None) {
      notice(paint, MessageModel::Kind::Problem, describe(s->fault));
      if (button(paint, icon::kCheck, "Clear the fault", Emphasis::Normal)) {
        paint.actions.push_back(act::ClearFault{});
      }
    } else {
      const bool mouseHolds = s->safety == SafetyState::Disarmed && !simulate.latch &&
                              simulate.hand == HandKind::Mouse && !simulate.hardware;
      notice(paint,
             s->safety == SafetyState::Armed ? MessageModel::Kind::Information
                                             : MessageModel::Kind::Warning,
             mouseHolds ? "Force is off. Take the instrument, then hold A or the left mouse button."
                        : describe(s->safety));
    }
  } else {
    sentence(paint, "Start the simulation, then arm: no force leaves the program before.");
  }
  if (simulate.running && simulate.hand == HandKind::Demo && !simulate.hardware) {
    sentence(paint, "The demo hand holds the stylus' button: it arms by itself.");
    return;
  }
  bool latch = simulate.latch;
  if (toggle(paint, "Arming stays on", latch, !simulate.hardware)) {
    paint.actions.push_back(act::Latch{latch});
  }
  if (simulate.latch) {
    if (button(paint, icon::kBolt, simulate.armed ? "Disarm" : "Arm",
               simulate.armed ? Emphasis::Danger : Emphasis::Normal, -1.0F, simulate.running)) {
      paint.actions.push_back(act::Arm{!simulate.armed});
    }
  } else {
    (void)button(paint, icon::kBolt, "Hold to arm",
                 simulate.armed ? Emphasis::Danger : Emphasis::Normal, -1.0F, simulate.running);
    const bool held = ImGui::IsItemActive();
    if (held != spaceHolds && simulate.running) paint.actions.push_back(act::Arm{held});
    spaceHolds = held;
  }
}

/// Gains in force, the user's share of them, and what the machine leaves of it.
void drawCoupling(const Painter& paint, const SimulateModel& simulate, const Snapshot* snapshot) {
  const DeviceInfo& d = simulate.info;
  const bool live = simulate.running && snapshot != nullptr && snapshot->coupling.stiffness > 0.0;
  const double K =
      live ? snapshot->coupling.stiffness : 0.01 * simulate.couplingPercent * d.couplingStiffness;
  char text[96];
  std::snprintf(text, sizeof text, "%.2f N/mm, %.1f N\xc2\xb7s/m", K / 1000.0, d.couplingDamping);
  keyValue(paint, "Coupling", text);
  std::snprintf(text, sizeof text, "%.2f N\xc2\xb7m/rad",
                d.couplingStiffnessR * K / d.couplingStiffness);
  keyValue(paint, "Turning", text);
  int percent = simulate.couplingPercent;
  if (slider(paint, "Stiffness, % of stable", percent, 10, 100)) {
    paint.actions.push_back(act::Coupling{percent});
  }
  if (live && 100.0 * K < (simulate.couplingPercent - 1) * d.couplingStiffness) {
    std::snprintf(text, sizeof text, "Softer for now: a step takes %.0f ms on this machine.",
                  1e3 * snapshot->stepPeriod);
    sentence(paint, text);
  }
}

void drawNumbers(const Painter& paint, const SimulateModel& simulate, const Snapshot* snapshot,
                 bool busy) {
  section(paint, "SPEED AND ACCURACY");
  if (simulate.ready) {
    keyValue(paint, "Sphere tree", simulate.tree);
    keyValue(paint, "Point shell", simulate.shell);
    if (simulate.loose > 0) keyValue(paint, "Loose bodies", std::to_string(simulate.loose));
  }
  const DeviceInfo& d = simulate.info;
  drawCoupling(paint, simulate, snapshot);
  char text[96];
  const SafetyLimits limits = recommendedLimits(d);
  std::snprintf(text, sizeof text, "%.1f N, %.2f N for long", limits.peakForce,
                limits.continuousForce);
  keyValue(paint, "Most force", text);
  int iterations = static_cast<int>(simulate.setting.solverIterations);
  if (slider(paint, "Impulses a step", iterations, 10, 500)) {
    paint.actions.push_back(act::SolverIterations{static_cast<std::uint32_t>(iterations)});
  }
  drawTrade(paint, simulate, snapshot, busy);
  if (!simulate.realTimeNote.empty() && !simulate.realTime) sentence(paint, simulate.realTimeNote);
}

/// What the scene models, and what it leaves out, each with its cost and, pointed at, the reason.
void drawPlan(const Painter& paint, const SimulateModel& simulate) {
  if (!simulate.ready || simulate.plan.empty()) return;
  for (const bool modelled : {true, false}) {
    section(paint, modelled ? "MODELLED" : "LEFT OUT");
    for (const PlanRow& row : simulate.plan) {
      if (row.modelled != modelled) continue;
      std::string cost;
      char text[48];
      if (row.us) {
        std::snprintf(text, sizeof text, "%.1f \xc2\xb5s", *row.us);
        cost = text;
      }
      if (row.bytes > 0) {
        std::snprintf(text, sizeof text, "%s%.2f MiB", row.us ? ", " : "",
                      static_cast<double>(row.bytes) / (1024.0 * 1024.0));
        cost += text;
      }
      const ImVec2 a = ImGui::GetCursorScreenPos();
      const float width = ImGui::GetContentRegionAvail().x;
      keyValue(paint, row.what, cost);
      const ImVec2 b(a.x + width, ImGui::GetCursorScreenPos().y);
      if (ImGui::IsWindowHovered() && ImGui::IsMouseHoveringRect(a, b)) {
        ImGui::SetTooltip("%s", row.why.c_str());
      }
    }
  }
}

}  // namespace

void drawSimulatePanel(const Painter& paint, const Model& model, bool& spaceHolds) {
  const SimulateModel& simulate = model.simulate;
  heading(paint, "Simulate");
  if (!model.openCase.open) {
    drawEmptyCase(paint, model);
    return;
  }
  const bool can = simulate.ready || simulate.running;
  if (button(paint, simulate.running ? icon::kStop : icon::kPlay,
             simulate.running ? "Stop" : "Start", Emphasis::Primary, -1.0F, can)) {
    paint.actions.push_back(act::StartStop{});
  }
  if (!can && !simulate.notReady.empty()) {
    notice(paint, MessageModel::Kind::Information, simulate.notReady);
    if (model.segment.labels.empty() && !model.job.active &&
        button(paint, icon::kMagic, "Go to Segment", Emphasis::Normal)) {
      paint.actions.push_back(act::ShowTask{Task::Segment});
    }
  }
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
  const std::string record =
      simulate.recording ? "Stop " + clockText(simulate.recordedSeconds) : std::string("Record");
  if (button(paint, icon::kRecord, record, simulate.recording ? Emphasis::Danger : Emphasis::Normal,
             half, can)) {
    paint.actions.push_back(act::Record{});
  }
  ImGui::SameLine();
  if (button(paint, icon::kReset, "Reset tool", Emphasis::Normal, half, simulate.running)) {
    paint.actions.push_back(act::ResetTool{});
  }
  if (simulate.hand == HandKind::Mouse && !simulate.hardware &&
      button(
          paint, icon::kHand, simulate.grabbed ? "Let go of the instrument" : "Take the instrument",
          Emphasis::Normal, -1.0F, simulate.running,
          "The mouse then moves the hand in the 3D view, the wheel pushes it in and out, a right "
          "drag turns it. G takes and lets go; holding Shift does it for a moment.")) {
    paint.actions.push_back(act::Grab{!simulate.grabbed});
  }
  drawSafety(paint, model, spaceHolds);
  drawInstruments(paint, simulate);
  drawDevice(paint, simulate);
  drawNumbers(paint, simulate, model.snapshot, model.job.active);
  drawPlan(paint, simulate);
}

}  // namespace palpate::ui
