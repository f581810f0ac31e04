/// The fake machine's state and the scheduler that ticks it.

#include <algorithm>
#include <chrono>
#include <thread>

#include "core/geometry/pose.h"
#include "core/haptics/device.h"
#include "tests/core/devices/fake_hd/fake_machine_state.h"

namespace fake_hd {

namespace {
constexpr std::size_t kErrorStack = 32, kRecords = 20000;
}

Machine& machine() {
  static Machine* const one = new Machine;
  return *one;
}

void push(unsigned code, unsigned device, int internalCode) {
  auto& errors = machine().errors;
  if (errors.size() == kErrorStack) errors.erase(errors.begin());
  errors.push_back({code, internalCode, device});
}

void forbidden(unsigned code, unsigned device) {
  ++machine().violations;
  push(code, device);
}

Device* deviceOf(unsigned handle) {
  auto& devices = machine().devices;
  if (handle >= devices.size() || !devices[handle].initialised) {
    forbidden(0x104, handle);
    return nullptr;
  }
  return &devices[handle];
}
Device* currentDevice() {
  return deviceOf(machine().current);
}

const Injection* injected(Device& device, Fault fault) {
  for (const Injection& one : device.injections) {
    if (one.fault != fault || machine().tick < one.begin || machine().tick >= one.end) continue;
    device.faulty = true;
    return &one;
  }
  return nullptr;
}

void called(const char* function) {
  ++machine().calls[function];
}

namespace {

/// The arm's reading as HDAPI tells it: columns, millimetres.
void readArm(Device& device) {
  const palpate::DeviceSample sample = device.arm->read(device.armTick++);
  const Eigen::Matrix4d m = palpate::isometry(sample.pose).matrix();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      device.transform[4 * column + row] = m(row, column) * (column == 3 && row < 3 ? 1e3 : 1.0);
  device.buttons = static_cast<int>(sample.buttons);
}

void writeArm(Device& device) {
  palpate::Wrench wrench;
  for (int i = 0; i < 3; ++i) {
    wrench.force[i] = device.force[i];
    wrench.torque[i] = device.torque[i] * 1e-3;
  }
  device.arm->write(wrench);
}

void beginTick() {
  Machine& m = machine();
  for (Device& device : m.devices) {
    device.inFrame = device.framed = false;
    if (device.initialised && device.arm != nullptr) readArm(device);
  }
}

void endTick() {
  Machine& m = machine();
  for (std::size_t i = 0; i < m.devices.size(); ++i) {
    Device& device = m.devices[i];
    if (!device.initialised) continue;
    if (device.arm != nullptr) writeArm(device);
    TickRecord record;
    record.tick = m.tick;
    std::copy_n(device.force, 3, record.force);
    std::copy_n(device.torque, 3, record.torque);
    std::copy_n(device.transform + 12, 3, record.position);
    record.forceSet = device.forceSet;
    record.torqueSet = device.torqueSet;
    record.faulty = device.faulty;
    device.forceSet = device.torqueSet = device.faulty = false;
    device.records.push_back(record);
    if (device.records.size() > kRecords) device.records.pop_front();
  }
  ++m.tick;
}

/// Milliseconds that an injected stall asks for before this tick.
int stallNow() {
  for (Device& device : machine().devices)
    if (const Injection* one = injected(device, Fault::Stall)) return one->code;
  return 0;
}

void runCallbacks() {
  Machine& m = machine();
  std::vector<Callback> now;
  {
    const Lock lock(m.mutex);
    now = m.callbacks;
  }
  std::stable_sort(now.begin(), now.end(),
                   [](const Callback& a, const Callback& b) { return a.priority > b.priority; });
  for (const Callback& one : now) {
    if (one.function(one.data) != 0) continue;
    const Lock lock(m.mutex);
    std::erase_if(m.callbacks, [&](const Callback& c) { return c.handle == one.handle; });
  }
}

}  // namespace

void servo() {
  Machine& m = machine();
  auto due = std::chrono::steady_clock::now();
  for (;;) {
    int period = 0, stall = 0;
    bool frozen = false;
    {
      const Lock lock(m.mutex);
      if (!m.running) return;
      m.servo = std::this_thread::get_id();
      period = m.period;
      frozen = m.frozen;
      if (!frozen) stall = stallNow();
    }
    if (stall > 0) std::this_thread::sleep_for(std::chrono::milliseconds(stall));
    if (!frozen) {
      {
        const Lock lock(m.mutex);
        beginTick();
      }
      runCallbacks();
      const Lock lock(m.mutex);
      endTick();
    }
    due = std::max(due + std::chrono::microseconds(period),
                   std::chrono::steady_clock::now() - std::chrono::milliseconds(1));
    std::this_thread::sleep_until(due);
  }
}

}  // namespace fake_hd
