#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/text_table.h"
#include "core/devices/simulated_phantom.h"
#include "core/geometry/units.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

/// Drivers that this version has not got; the list says so instead of showing nothing.
struct MissingDriver {
  const char *name, *reason;
};
constexpr MissingDriver kMissingDrivers[] = {
    {"3D Systems Phantom, Touch, Touch X (OpenHaptics)",
     "This version has no driver for hardware; use a simulated model."},
};

ordered_json workspaceJson(const DeviceInfo& info) {
  ordered_json size = ordered_json::array();
  for (std::size_t i = 0; i < 3; ++i) {
    size.push_back(millimetres(info.workspaceMax[i] - info.workspaceMin[i]));
  }
  return size;
}

ordered_json deviceJson(const DeviceInfo& info) {
  ordered_json json;
  json["name"] = info.name;
  json["model"] = info.model;
  json["simulated"] = info.simulated;
  json["available"] = true;
  json["reason"] = nullptr;
  json["feels_torque"] = info.feelsTorque;
  json["peak_force_N"] = info.peakForce;
  json["continuous_force_N"] = info.continuousForce;
  json["peak_torque_Nm"] = info.peakTorque;
  json["workspace_mm"] = workspaceJson(info);
  return json;
}

Result<CommandOutput> runDevices() {
  CommandOutput output;
  output.json["devices"] = ordered_json::array();
  TextTable table({"model", "device", "there", "peak N", "continuous N", "torque"});
  for (const std::string& model : simulatedModels()) {
    const auto device = makeSimulatedPhantom(model, makeSearchingHand(1), 1);
    if (!device) return fail(device.error());
    const DeviceInfo& info = (*device)->info();
    output.json["devices"].push_back(deviceJson(info));
    table.add({info.model, info.name, "yes", decimal(info.peakForce, 2),
               decimal(info.continuousForce, 2), info.feelsTorque ? "felt" : "drawn"});
  }
  output.text = table.text();
  for (const MissingDriver& driver : kMissingDrivers) {
    output.json["devices"].push_back({{"name", driver.name},
                                      {"model", nullptr},
                                      {"simulated", false},
                                      {"available", false},
                                      {"reason", driver.reason}});
    output.text += std::string(driver.name) + ": " + driver.reason + "\n";
  }
  return output;
}

}  // namespace

void addDevicesCommand(CommandSet& commands) {
  commands.add("devices", "The devices that are there, and why others are not",
               [](const CommandContext&) { return runDevices(); });
}

}  // namespace palpate
