#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

std::string deviceTitle(const std::string& model) {
  if (model == "touch") return "Touch";
  if (model == "touch-x") return "Touch X";
  if (model == "premium-6dof") return "Premium";
  if (model == "3d-mouse") return "3D mouse";
  if (model == "phantom") return "Phantom";
  if (model.rfind("phantom:", 0) == 0) return "Phantom \xc2\xb7 " + model.substr(8);
  return model;
}

std::string motorText(const std::vector<double>& temperatures) {
  std::string text;
  for (const double t : temperatures) {
    char one[16];
    std::snprintf(one, sizeof one, "%s%.0f", text.empty() ? "" : " \xc2\xb7 ", 100.0 * t);
    text += one;
  }
  return text + " % of too hot";
}

/// What the device says of itself, and what the person can do about it.
void drawCondition(const Painter& paint, const SimulateModel& simulate) {
  if (!simulate.running) return;
  const DeviceCondition& now = simulate.condition;
  using State = DeviceCondition::State;
  if (now.state != State::Ready) {
    notice(
        paint,
        now.state == State::Calibrating ? MessageModel::Kind::Warning : MessageModel::Kind::Problem,
        simulate.reconnecting ? "Looking for the device\xe2\x80\xa6" : now.sentence);
  } else if (simulate.hardware) {
    sentence(paint, now.sentence);
  }
  if (now.asksToConfirm &&
      button(paint, icon::kCheck, "The arm is in place", Emphasis::Primary, -1.0F)) {
    paint.actions.push_back(act::ConfirmCalibration{});
  }
  if (now.canReconnect &&
      button(paint, icon::kReset, "Reconnect", Emphasis::Normal, -1.0F, !simulate.reconnecting)) {
    paint.actions.push_back(act::Reconnect{});
  }
  // Cold simulated motors are nobody's concern.
  const auto hottest = std::max_element(now.motorTemperature.begin(), now.motorTemperature.end());
  const bool tell = hottest != now.motorTemperature.end() && (simulate.hardware || *hottest > 0.5);
  if (tell) keyValue(paint, "Motors", motorText(now.motorTemperature));
  if (now.hasInkwell) keyValue(paint, "Stylus", now.docked ? "in the inkwell" : "in the hand");
  if (simulate.hardware) {
    keyValue(paint, "Button", (now.buttons & 1U) != 0 ? "held" : "not held");
    if (!now.firmware.empty()) keyValue(paint, "Firmware", now.firmware);
    if (!now.serial.empty()) keyValue(paint, "Serial", now.serial);
  }
}

/// A device of the machine's own: a row with its whole name.
bool deviceRow(const Painter& paint, const std::string& title, bool on, bool enabled) {
  const float height = paint.px(Measures::kControl);
  ImGui::BeginDisabled(!enabled);
  const bool pressed =
      ImGui::InvisibleButton(title.c_str(), {ImGui::GetContentRegionAvail().x, height});
  ImGui::EndDisabled();
  paint.note(title);
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const bool hot = enabled && ImGui::IsItemHovered();
  list->AddRectFilled(a, b, packed(hot ? paint.theme.hover : paint.theme.raised),
                      paint.px(Measures::kCorner));
  if (on) list->AddRectFilled(a, b, packed(paint.theme.accent, 0.22F), paint.px(Measures::kCorner));
  const float in = paint.px(10.0F);
  const float down = 0.5F * (height - ImGui::GetFontSize());
  list->AddText({a.x + in, std::round(a.y + down)},
                packed(on ? paint.theme.text : paint.theme.secondary, enabled || on ? 1.0F : 0.45F),
                shortened(title, ImGui::GetFont(), b.x - a.x - 2.0F * in).c_str());
  return pressed && enabled;
}

/// What is plugged in first, by its whole name; then the simulated arms side by side.
void chooseDevice(const Painter& paint, const SimulateModel& simulate) {
  std::vector<std::string> arms;
  std::vector<std::size_t> armIndex;
  std::size_t armChosen = simulate.devices.size();
  for (std::size_t i = 0; i < simulate.devices.size(); ++i) {
    const std::string& device = simulate.devices[i];
    if (device != "3d-mouse" && device.rfind("phantom", 0) != 0) {
      if (i == simulate.device) armChosen = arms.size();
      arms.push_back(deviceTitle(device));
      armIndex.push_back(i);
    } else if (deviceRow(paint, deviceTitle(device), i == simulate.device, !simulate.running) &&
               i != simulate.device) {
      paint.actions.push_back(act::ChooseDevice{i});
    }
  }
  if (arms.empty()) return;
  const std::size_t picked = segmented(paint, "device", arms, armChosen, !simulate.running);
  if (picked != armChosen) paint.actions.push_back(act::ChooseDevice{armIndex[picked]});
}

}  // namespace

void drawDevice(const Painter& paint, const SimulateModel& simulate) {
  section(paint, simulate.hardware ? "DEVICE" : "SIMULATED DEVICE");
  chooseDevice(paint, simulate);
  keyValue(paint, "Felt",
           simulate.info.feelsTorque ? "force and torque" : "force; torque is drawn");
  drawCondition(paint, simulate);
  if (simulate.hardware) return;
  const std::size_t hand = simulate.hand == HandKind::Mouse ? 0 : 1;
  const std::size_t picked =
      segmented(paint, "hand", {"Mouse moves it", "Demo hand"}, hand, !simulate.running);
  if (picked != hand) {
    paint.actions.push_back(act::ChooseHand{picked == 0 ? HandKind::Mouse : HandKind::Demo});
  }
}

}  // namespace palpate::ui
