/// The test's side of the fake library.

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "tests/core/devices/fake_hd/fake_machine_state.h"

extern "C" void hdStopScheduler();

namespace fake_hd {
namespace {

void reset() {
  hdStopScheduler();
  Machine& m = machine();
  const Lock lock(m.mutex);
  m.devices.clear();
  m.errors.clear();
  m.callbacks.clear();
  m.calls.clear();
  m.current = kNoDevice;
  m.period = 1000;
  m.priority = -1;
  m.violations = 0;
  m.startFailures = m.scheduleFailures = 0;
  m.frozen = false;
}

int configure(const DeviceSetup* setup) {
  const Lock lock(machine().mutex);
  Device device;
  device.setup = *setup;
  device.named = setup->name != nullptr;
  if (device.named) device.name = setup->name;
  device.model = setup->model;
  device.serial = setup->serial;
  device.calibration = setup->calibration;
  machine().devices.push_back(std::move(device));
  return static_cast<int>(machine().devices.size()) - 1;
}

Device& at(int device) {
  return machine().devices.at(static_cast<std::size_t>(device));
}

void inject(int device, Fault fault, int code, int ticksFromNow, int ticks) {
  const Lock lock(machine().mutex);
  const std::uint64_t begin = machine().tick + 1 + static_cast<std::uint64_t>(ticksFromNow);
  at(device).injections.push_back({fault, code, begin, begin + static_cast<std::uint64_t>(ticks)});
}

std::uint64_t ticks() {
  const Lock lock(machine().mutex);
  return machine().tick;
}

/// Gives up after ten seconds; what the test then checks fails.
void waitTicks(int count) {
  const std::uint64_t end = ticks() + static_cast<std::uint64_t>(count);
  for (int i = 0; i < 100000 && ticks() < end; ++i)
    std::this_thread::sleep_for(std::chrono::microseconds(100));
}

std::size_t records(int device, TickRecord* out, std::size_t capacity) {
  const Lock lock(machine().mutex);
  const auto& all = at(device).records;
  const std::size_t count = std::min(capacity, all.size());
  std::copy(all.end() - static_cast<std::ptrdiff_t>(count), all.end(), out);
  return count;
}

/// FAKE_HD_CALIBRATION=0x5002: one device from the start, with that calibration status, for looking
/// at the program's window with this library in the vendor's place (PALPATE_HD_LIBRARY).
[[maybe_unused]] const bool fromEnvironment = [] {
  const char* status = std::getenv("FAKE_HD_CALIBRATION");
  if (status == nullptr) return false;
  DeviceSetup setup;
  setup.calibration = static_cast<unsigned>(std::strtoul(status, nullptr, 0));
  configure(&setup);
  return true;
}();

const Controls kControls = {
    .reset = reset,
    .configure = configure,
    .setPeriodMicroseconds =
        [](int period) {
          const Lock lock(machine().mutex);
          machine().period = period;
        },
    .setTransform =
        [](int device, const double* transform) {
          const Lock lock(machine().mutex);
          std::copy_n(transform, 16, at(device).transform);
        },
    .setButtons =
        [](int device, int buttons) {
          const Lock lock(machine().mutex);
          at(device).buttons = buttons;
        },
    .setInkwellRaw =
        [](int device, int value) {
          const Lock lock(machine().mutex);
          at(device).inkwellRaw = value;
        },
    .setCalibration =
        [](int device, unsigned status) {
          const Lock lock(machine().mutex);
          at(device).calibration = status;
        },
    .setMotorTemperature =
        [](int device, const double* values) {
          const Lock lock(machine().mutex);
          std::copy_n(values, at(device).setup.motors, at(device).temperature);
        },
    .attachArm =
        [](int device, palpate::HapticDevice* arm) {
          const Lock lock(machine().mutex);
          at(device).arm = arm;
          at(device).armTick = 0;
        },
    .inject = inject,
    .clearFaults =
        [](int device) {
          const Lock lock(machine().mutex);
          at(device).injections.clear();
        },
    .failInit =
        [](int device, unsigned code, int times) {
          const Lock lock(machine().mutex);
          at(device).initError = code;
          at(device).initFailures = times;
        },
    .failStart =
        [](unsigned code, int times) {
          const Lock lock(machine().mutex);
          machine().startError = code;
          machine().startFailures = times;
        },
    .failSchedule =
        [](unsigned code, int times) {
          const Lock lock(machine().mutex);
          machine().scheduleError = code;
          machine().scheduleFailures = times;
        },
    .failUpdateCalibration =
        [](int device, unsigned code, int times) {
          const Lock lock(machine().mutex);
          at(device).calibrationError = code;
          at(device).calibrationFailures = times;
        },
    .pushError =
        [](int device, unsigned code, int internalCode) {
          const Lock lock(machine().mutex);
          push(code, static_cast<unsigned>(device), internalCode);
        },
    .pushErrorsInTick =
        [](int device, const unsigned* codes, int count) {
          const Lock lock(machine().mutex);
          at(device).errorsInTick.assign(codes, codes + count);
        },
    .freezeScheduler =
        [](int frozen) {
          const Lock lock(machine().mutex);
          machine().frozen = frozen != 0;
        },
    .ticks = ticks,
    .waitTicks = waitTicks,
    .records = records,
    .calls =
        [](const char* function) {
          const Lock lock(machine().mutex);
          return machine().calls[function];
        },
    .lastCalibrationStyle =
        [](int device) {
          const Lock lock(machine().mutex);
          return at(device).lastStyle;
        },
    .appliedForce =
        [](int device, double* force) {
          const Lock lock(machine().mutex);
          std::copy_n(at(device).force, 3, force);
        },
    .forceWhenDisabled =
        [](int device, double* force) {
          const Lock lock(machine().mutex);
          std::copy_n(at(device).forceWhenDisabled, 3, force);
        },
    .wasStoppedWhenDisabled =
        [](int device) {
          const Lock lock(machine().mutex);
          return at(device).stoppedWhenDisabled ? 1 : 0;
        },
    .priority =
        [] {
          const Lock lock(machine().mutex);
          return machine().priority;
        },
    .violations =
        [] {
          const Lock lock(machine().mutex);
          return machine().violations;
        },
};

}  // namespace
}  // namespace fake_hd

extern "C" const fake_hd::Controls* fake_controls() {
  return &fake_hd::kControls;
}
