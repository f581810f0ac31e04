#include "app/command.h"
#include "app/commands.h"
#include "app/text_table.h"
#include "core/devices/device_list.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

ordered_json textOrNull(const std::string& text) {
  return text.empty() ? ordered_json(nullptr) : ordered_json(text);
}

ordered_json workspaceJson(const DeviceInfo& info) {
  ordered_json size = ordered_json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    size.push_back(millimetres(info.workspaceMax[i] - info.workspaceMin[i]));
  }
  return size;
}

ordered_json deviceJson(const ListedDevice& device) {
  ordered_json json;
  json["name"] = device.name;
  json["title"] = device.info.name;
  json["model"] = device.info.model;
  json["simulated"] = device.info.simulated;
  json["available"] = device.there;
  json["reason"] = device.there ? ordered_json(nullptr) : ordered_json(device.note);
  json["advice"] = textOrNull(device.advice);
  if (!device.there) return json;
  json["feels_torque"] = device.info.feelsTorque;
  json["peak_force_N"] = device.info.peakForce;
  json["continuous_force_N"] = device.info.continuousForce;
  json["peak_torque_Nm"] = device.info.peakTorque;
  json["workspace_mm"] = workspaceJson(device.info);
  json["firmware"] = textOrNull(device.firmware);
  json["driver"] = textOrNull(device.driverVersion);
  json["calibration"] = textOrNull(device.calibration);
  return json;
}

std::vector<std::string> deviceRow(const ListedDevice& device) {
  const DeviceInfo& info = device.info;
  if (!device.there) return {device.name, info.name, "no", "-", "-", "-"};
  return {device.name,
          info.name,
          "yes",
          decimal(info.peakForce, 2),
          decimal(info.continuousForce, 2),
          info.feelsTorque ? "felt" : "drawn"};
}

Result<CommandOutput> runDevices() {
  const DeviceList list = listDevices();
  CommandOutput output;
  output.json["devices"] = ordered_json::array();
  TextTable table({"name", "device", "there", "peak N", "continuous N", "torque"});
  std::string notes;
  for (const ListedDevice& device : list.devices) {
    output.json["devices"].push_back(deviceJson(device));
    table.add(deviceRow(device));
    if (!device.there) notes += device.name + ": " + device.note + " " + device.advice + "\n";
  }
  output.json["tried"] = ordered_json::array();
  for (const hd::LibraryAttempt& attempt : list.libraries) {
    output.json["tried"].push_back({{"library", attempt.name},
                                    {"problem", textOrNull(attempt.problem)},
                                    {"advice", textOrNull(attempt.advice)}});
  }
  output.json["mouse_library"] = textOrNull(list.mouseLibrary);
  output.json["library"] = textOrNull(list.library);
  output.json["library_note"] = librarySentence(list);
  output.text = table.text() + "\n" + notes + librarySentence(list) + "\n";
  return output;
}

}  // namespace

void addDevicesCommand(CommandSet& commands) {
  commands.add("devices", "The devices that are there, and why others are not",
               [](const CommandContext&) { return runDevices(); });
}

}  // namespace palpate
