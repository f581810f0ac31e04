#include "core/devices/device_list.h"

#include <chrono>
#include <memory>
#include <thread>

#include "core/devices/arm_model.h"
#include "core/devices/space_mouse.h"

namespace palpate {
namespace {

constexpr const char* kPhantom = "phantom";

std::vector<ListedDevice> simulated() {
  std::vector<ListedDevice> devices;
  for (const ArmParameters& arm : armModels()) {
    ListedDevice& one = devices.emplace_back();
    one.name = arm.info.model;
    one.info = arm.info;
    one.there = true;
    one.note = "Simulated: nothing is felt.";
  }
  return devices;
}

void tellStatus(Phantom& phantom, ListedDevice& one) {
  // The servo asks for calibration and temperature in its first tick.
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  PhantomStatus status = phantom.status();
  while (status.ticks < 2 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    status = phantom.status();
  }
  one.note = describe(status);
  one.calibration = status.state == hd::DriverState::Calibrating
                        ? calibrationStyleName(status.calibrationStyle)
                        : "done";
  one.motorTemperature.assign(status.motorTemperature, status.motorTemperature + status.motors);
}

ListedDevice look(const std::string& configuredName, const PhantomOptions& options) {
  ListedDevice one;
  one.name = configuredName.empty() ? kPhantom : std::string(kPhantom) + ":" + configuredName;
  PhantomOptions asked = options;
  asked.names = {configuredName};
  Phantom phantom(asked);
  if (const auto opened = phantom.open(); !opened) {
    one.note = opened.error().message;
    if (opened.error().found) one.note += " Found: " + *opened.error().found + ".";
    one.advice = opened.error().advice.value_or("");
    return one;
  }
  one.there = true;
  one.info = phantom.info();
  one.firmware = phantom.facts().firmware;
  one.driverVersion = phantom.facts().driverVersion;
  one.vendor = phantom.facts().vendor;
  tellStatus(phantom, one);
  return one;
}

/// The arm that it moves is simulated; what is felt is nothing.
ListedDevice spaceMouse(DeviceList& list) {
  const SpaceMouseSearch search = findSpaceMouse();
  list.mouseLibrary = search.library;
  ListedDevice one;
  one.name = kSpaceMouse;
  one.info = armModels()[1].info;
  one.info.name = "3D mouse on a simulated Touch X";
  one.there = search.there;
  one.note = search.note;
  one.advice = search.advice;
  return one;
}

}  // namespace

DeviceList listDevices(const PhantomOptions& options) {
  DeviceList list;
  list.devices = simulated();
  list.devices.push_back(spaceMouse(list));
  hd::LibrarySearch search = hd::findLibrary(options.libraries);
  list.libraries = std::move(search.attempts);
  if (search.library == nullptr) return list;
  list.library = search.library->path;
  for (const std::string& name : options.names) list.devices.push_back(look(name, options));
  return list;
}

Result<PhantomOptions> phantomOptions(const std::string& deviceName) {
  PhantomOptions options;
  const std::string prefix = std::string(kPhantom) + ":";
  if (deviceName == kPhantom) return options;
  if (deviceName.size() > prefix.size() && deviceName.compare(0, prefix.size(), prefix) == 0) {
    options.names = {deviceName.substr(prefix.size())};
    return options;
  }
  return fail(usageError("There is no Phantom of this name.")
                  .inField("device")
                  .butFound(deviceName)
                  .wants("phantom, or phantom:NAME with its name in the vendor's set-up tool")
                  .advise("`palpate devices` lists what is there."));
}

std::string librarySentence(const DeviceList& list) {
  if (!list.library.empty()) return "The Phantom's library was found: " + list.library + ".";
  hd::LibrarySearch search;
  search.attempts = list.libraries;
  return sentence(hd::libraryError(search));
}

}  // namespace palpate
