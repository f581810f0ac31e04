/// A stand-in for the vendor's HDAPI library: the same C functions and error behaviour
/// (haptics_facts.md §1), a scheduler with its own thread, and faults on request. Prototypes and
/// values are written here again, so that a slip in the driver's would show.

#include "tests/core/devices/fake_hd/fake_hd.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/geometry/pose.h"
#include "core/haptics/device.h"

namespace fake_hd {
namespace {

constexpr unsigned kNoDevice = 0xFFFFFFFFu;
constexpr std::size_t kErrorStack = 32, kRecords = 20000;

struct ErrorInfo {
  unsigned code;
  int internalCode;
  unsigned device;
};

struct Injection {
  Fault fault;
  int code;
  std::uint64_t begin, end;  // ticks
};

struct Device {
  DeviceSetup setup;
  std::string name, model, serial;
  bool named = true, initialised = false, forceOutput = false;
  bool inFrame = false, framed = false;  // framed: had its frame this tick
  double transform[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  int buttons = 0, inkwellRaw = 1;
  unsigned calibration = 0x5000, lastStyle = 0;
  double temperature[6] = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
  double force[3] = {0, 0, 0}, torque[3] = {0, 0, 0};         // what the motors hold
  double wanted[3] = {0, 0, 0}, wantedTorque[3] = {0, 0, 0};  // set in this frame
  bool forceSet = false, torqueSet = false, faulty = false;
  palpate::HapticDevice* arm = nullptr;
  std::uint64_t armTick = 0;
  std::vector<Injection> injections;
  unsigned initError = 0;
  int initFailures = 0;
  unsigned calibrationError = 0;
  int calibrationFailures = 0;
  std::vector<unsigned> errorsInTick;
  std::deque<TickRecord> records;
  double forceWhenDisabled[3] = {0, 0, 0};
  bool stoppedWhenDisabled = false;
};

struct Callback {
  unsigned (*function)(void*);
  void* data;
  unsigned short priority;
  unsigned long handle;
};

struct Machine {
  std::mutex mutex;  // of everything below; never held while a callback runs
  std::vector<Device> devices;
  std::vector<ErrorInfo> errors;  // newest last
  std::vector<Callback> callbacks;
  unsigned long nextHandle = 1;
  unsigned current = kNoDevice;
  std::map<std::string, int> calls;
  int period = 1000, priority = -1, violations = 0;
  std::uint64_t tick = 0;
  unsigned startError = 0, scheduleError = 0;
  int startFailures = 0, scheduleFailures = 0;
  bool running = false, frozen = false;
  std::thread thread;
  std::thread::id servo;
};

Machine& machine() {
  static Machine* const one = new Machine;
  return *one;
}

using Lock = std::lock_guard<std::mutex>;

void push(unsigned code, unsigned device, int internalCode = 0) {
  auto& errors = machine().errors;
  if (errors.size() == kErrorStack) errors.erase(errors.begin());
  errors.push_back({code, internalCode, device});
}

/// A call that a correct driver never makes.
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

/// A getter's way in: the current device, or nothing and an error.
Device* reading(const char* function) {
  called(function);
  return currentDevice();
}

void giveTransform(Device& device, double* out) {
  if (injected(device, Fault::SilentPose) != nullptr) return;
  std::copy_n(device.transform, 16, out);
  if (const Injection* nan = injected(device, Fault::NanPose))
    out[nan->code] = std::numeric_limits<double>::quiet_NaN();
  if (injected(device, Fault::Lost) != nullptr)
    std::fill_n(out, 16, std::numeric_limits<double>::quiet_NaN());
  if (injected(device, Fault::ZeroPose) != nullptr) std::fill_n(out, 16, 0.0);
  if (injected(device, Fault::MirroredPose) != nullptr)
    for (int i = 0; i < 3; ++i) out[i] = -out[i];
}

}  // namespace
}  // namespace fake_hd

using namespace fake_hd;

// ---------------------------------------------------------------------------- the vendor's side
extern "C" {

unsigned hdInitDevice(const char* name) {
  const Lock lock(machine().mutex);
  called("hdInitDevice");
  auto& devices = machine().devices;
  for (unsigned i = 0; i < devices.size(); ++i) {
    Device& device = devices[i];
    const bool meant = name == nullptr ? i == 0 : device.named && device.name == name;
    if (!meant) continue;
    if (machine().running) forbidden(0x102, i);
    if (device.initFailures > 0) {
      --device.initFailures;
      push(device.initError, i, 77);
      return kNoDevice;
    }
    if (device.initialised) {
      push(0x301, i);
      return kNoDevice;
    }
    device.initialised = true;
    std::fill_n(device.force, 3, 0.0);
    std::fill_n(device.torque, 3, 0.0);
    machine().current = i;
    return i;
  }
  push(0x300, kNoDevice, 5);
  return kNoDevice;
}

void hdDisableDevice(unsigned handle) {
  const Lock lock(machine().mutex);
  called("hdDisableDevice");
  Device* device = deviceOf(handle);
  if (device == nullptr) return;
  std::copy_n(device->force, 3, device->forceWhenDisabled);
  device->stoppedWhenDisabled = !machine().running;
  device->initialised = false;
}

void hdMakeCurrentDevice(unsigned handle) {
  const Lock lock(machine().mutex);
  called("hdMakeCurrentDevice");
  if (deviceOf(handle) != nullptr) machine().current = handle;
}

unsigned hdGetCurrentDevice() {
  const Lock lock(machine().mutex);
  return machine().current;
}

void hdBeginFrame(unsigned handle) {
  const Lock lock(machine().mutex);
  called("hdBeginFrame");
  Device* device = deviceOf(handle);
  if (device == nullptr) return;
  if (injected(*device, Fault::Lost) != nullptr) {
    push(0x302, handle, 11);
    return;
  }
  if (injected(*device, Fault::NestedBegin) != nullptr) {
    push(0x400, handle);
    device->inFrame = true;
    return;
  }
  if (device->inFrame || device->framed) {
    forbidden(0x400, handle);
    return;
  }
  device->inFrame = true;
  std::copy_n(device->force, 3, device->wanted);  // the last force persists
  std::copy_n(device->torque, 3, device->wantedTorque);
  for (const unsigned code : device->errorsInTick) push(code, handle);
  device->errorsInTick.clear();
  if (const Injection* one = injected(*device, Fault::ErrorAtBegin))
    push(static_cast<unsigned>(one->code), handle);
}

void hdEndFrame(unsigned handle) {
  const Lock lock(machine().mutex);
  called("hdEndFrame");
  Device* device = deviceOf(handle);
  if (device == nullptr) return;
  if (injected(*device, Fault::Lost) != nullptr) {
    push(0x302, handle, 11);
    return;
  }
  if (!device->inFrame) {
    forbidden(0x401, handle);
    return;
  }
  device->inFrame = false;
  device->framed = true;
  if (const Injection* one = injected(*device, Fault::ErrorAtEnd))
    push(static_cast<unsigned>(one->code), handle);
  if (!device->forceOutput) return;
  const double* w = device->wanted;
  if (std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]) > device->setup.maxForce * 1.001) {
    push(0x201, handle);
    std::fill_n(device->force, 3, 0.0);
    return;
  }
  std::copy_n(device->wanted, 3, device->force);
  std::copy_n(device->wantedTorque, 3, device->torque);
}

ErrorInfo hdGetError() {
  const Lock lock(machine().mutex);
  auto& errors = machine().errors;
  if (errors.empty()) return {0, 0, machine().current};
  const ErrorInfo newest = errors.back();
  errors.pop_back();
  return newest;
}

const char* hdGetErrorString(unsigned) {
  return "an error";
}

void hdEnable(unsigned what) {
  const Lock lock(machine().mutex);
  called("hdEnable");
  Device* device = currentDevice();
  if (device == nullptr) return;
  if (what < 0x4000 || what > 0x4004) return forbidden(0x100, machine().current);
  if (what == 0x4000) device->forceOutput = true;
}

void hdDisable(unsigned what) {
  const Lock lock(machine().mutex);
  called("hdDisable");
  Device* device = currentDevice();
  if (device == nullptr) return;
  if (what < 0x4000 || what > 0x4004) return forbidden(0x100, machine().current);
  if (what == 0x4000) device->forceOutput = false;
}

unsigned char hdIsEnabled(unsigned what) {
  const Lock lock(machine().mutex);
  const Device* device = currentDevice();
  return device != nullptr && what == 0x4000 && device->forceOutput ? 1 : 0;
}

void hdGetBooleanv(unsigned what, unsigned char* out) {
  const Lock lock(machine().mutex);
  Device* device = reading("hdGetBooleanv");
  if (device == nullptr) return;
  if (what == 0x2002 && device->setup.inkwell)
    *out = static_cast<unsigned char>(device->inkwellRaw);
  else
    push(0x100, machine().current);
}

void hdGetIntegerv(unsigned what, int* out) {
  const Lock lock(machine().mutex);
  Device* device = reading("hdGetIntegerv");
  if (device == nullptr) return;
  switch (what) {
    case 0x2000:
      *out = device->buttons;
      break;
    case 0x2554:
      *out = device->setup.outputDof;
      break;
    case 0x2555:
      *out = static_cast<int>(device->setup.calibrationStyles);
      break;
    case 0x2600:
      *out = device->setup.updateRate;
      break;
    case 0x2050:
    case 0x2052:
      forbidden(0x103, machine().current);
      break;
    default:
      push(0x100, machine().current);
  }
}

void hdGetFloatv(unsigned, float*) {
  const Lock lock(machine().mutex);
  forbidden(0x103, machine().current);
}

void hdGetDoublev(unsigned what, double* out) {
  const Lock lock(machine().mutex);
  Device* device = reading("hdGetDoublev");
  if (device == nullptr) return;
  const double box[6] = {-80, -60, -35, 80, 60, 35};
  switch (what) {
    case 0x2050:
      std::copy_n(device->transform + 12, 3, out);
      break;
    case 0x2052:
      giveTransform(*device, out);
      break;
    case 0x2051:
    case 0x2053:  // reported to be unreliable: here they are
      std::fill_n(out, 3, std::numeric_limits<double>::quiet_NaN());
      break;
    case 0x2505:
      *out = 2.04;
      break;
    case 0x2550:
    case 0x2551:
      std::copy_n(box, 6, out);
      break;
    case 0x2603:
      *out = device->setup.maxForce;
      break;
    case 0x2604:
      *out = device->setup.maxContinuousForce;
      break;
    case 0x2605:
      if (device->setup.motors == 0) return push(0x100, machine().current);
      std::copy_n(device->temperature, device->setup.motors, out);
      break;
    case 0x2622:
    case 0x2623:
      if (device->setup.outputDof != 6) return push(0x100, machine().current);
      *out = what == 0x2622 ? device->setup.maxTorque : device->setup.maxContinuousTorque;
      break;
    case 0x2000:
      forbidden(0x103, machine().current);
      break;
    default:
      push(0x100, machine().current);
  }
}

void hdSetDoublev(unsigned what, const double* values) {
  const Lock lock(machine().mutex);
  called("hdSetDoublev");
  Device* device = currentDevice();
  if (device == nullptr) return;
  if (injected(*device, Fault::Lost) != nullptr) return push(0x302, machine().current, 11);
  if (!device->inFrame || std::this_thread::get_id() != machine().servo)
    return forbidden(0x102, machine().current);
  if (what == 0x2700) {
    std::copy_n(values, 3, device->wanted);
    device->forceSet = true;
    if (const Injection* one = injected(*device, Fault::ErrorAtSet))
      push(static_cast<unsigned>(one->code), machine().current);
  } else if (what == 0x2701) {
    if (device->setup.outputDof != 6) return forbidden(0x102, machine().current);
    std::copy_n(values, 3, device->wantedTorque);
    device->torqueSet = true;
  } else {
    forbidden(0x100, machine().current);
  }
}

const char* hdGetString(unsigned what) {
  const Lock lock(machine().mutex);
  Device* device = reading("hdGetString");
  if (device == nullptr) return nullptr;
  switch (what) {
    case 0x2500:
      return "3.4.0 fake";
    case 0x2501:
      return device->model.c_str();
    case 0x2502:
      return "1.0 fake";
    case 0x2503:
      return "Fake Haptics";
    case 0x2504:
      return device->serial.c_str();
    default:
      push(0x100, machine().current);
      return nullptr;
  }
}

#ifndef FAKE_HD_WITHOUT_CALIBRATION
unsigned hdCheckCalibration() {
  const Lock lock(machine().mutex);
  called("hdCheckCalibration");
  const Device* device = currentDevice();
  return device != nullptr ? device->calibration : 0x5002;
}
#endif

unsigned hdCheckCalibrationStyle() {
  const Lock lock(machine().mutex);
  const Device* device = currentDevice();
  return device != nullptr ? device->setup.calibrationStyles : 0;
}

void hdUpdateCalibration(unsigned style) {
  const Lock lock(machine().mutex);
  called("hdUpdateCalibration");
  Device* device = currentDevice();
  if (device == nullptr) return;
  device->lastStyle = style;
  if (device->force[0] != 0.0 || device->force[1] != 0.0 || device->force[2] != 0.0)
    forbidden(0x102, machine().current);  // the pose would jump under force
  if ((device->setup.calibrationStyles & style) != style) return push(0x101, machine().current);
  if (device->calibrationFailures > 0) {
    --device->calibrationFailures;
    return push(device->calibrationError, machine().current);
  }
  if (style == 4 && device->inkwellRaw != 0) return push(0x300, machine().current);
  device->calibration = 0x5000;
}

void hdStartScheduler() {
  Machine& m = machine();
  const Lock lock(m.mutex);
  called("hdStartScheduler");
  if (m.running) return forbidden(0x102, kNoDevice);
  if (m.startFailures > 0) {
    --m.startFailures;
    return push(m.startError, kNoDevice);
  }
  m.running = true;
  m.thread = std::thread(servo);
}

void hdStopScheduler() {
  Machine& m = machine();
  std::thread thread;
  {
    const Lock lock(m.mutex);
    called("hdStopScheduler");
    m.running = false;
    thread = std::move(m.thread);
  }
  if (thread.joinable()) thread.join();  // the motors keep their last force
}

void hdSetSchedulerRate(unsigned long rate) {
  const Lock lock(machine().mutex);
  called("hdSetSchedulerRate");
  if (rate != 500 && rate != 1000 && rate != 2000) push(0x101, kNoDevice);
}

unsigned long hdScheduleAsynchronous(unsigned (*function)(void*), void* data,
                                     unsigned short priority) {
  Machine& m = machine();
  const Lock lock(m.mutex);
  called("hdScheduleAsynchronous");
  if (m.scheduleFailures > 0) {
    --m.scheduleFailures;
    push(m.scheduleError, kNoDevice);
    return 0;
  }
  m.priority = priority;
  m.callbacks.push_back({function, data, priority, m.nextHandle});
  return m.nextHandle++;
}

/// At once where the scheduler stands still, and from the servo's thread.
void hdScheduleSynchronous(unsigned (*function)(void*), void* data, unsigned short priority) {
  bool atOnce = false;
  {
    Machine& m = machine();
    const Lock lock(m.mutex);
    atOnce = !m.running || std::this_thread::get_id() == m.servo;
  }
  if (atOnce) {
    while (function(data) != 0) {
    }
    return;
  }
  struct Once {
    unsigned (*function)(void*);
    void* data;
    std::mutex mutex;
    std::condition_variable done;
    bool finished = false;
  } once{function, data, {}, {}, false};
  hdScheduleAsynchronous(
      [](void* p) -> unsigned {
        Once& o = *static_cast<Once*>(p);
        if (o.function(o.data) != 0) return 1;
        const Lock lock(o.mutex);
        o.finished = true;
        o.done.notify_one();
        return 0;
      },
      &once, priority);
  std::unique_lock lock(once.mutex);
  once.done.wait(lock, [&] { return once.finished; });
}

void hdUnschedule(unsigned long handle) {
  Machine& m = machine();
  const Lock lock(m.mutex);
  called("hdUnschedule");
  if (std::erase_if(m.callbacks, [&](const Callback& c) { return c.handle == handle; }) == 0)
    forbidden(0x101, kNoDevice);
}

}  // extern "C"

// ---------------------------------------------------------------------------- the test's side
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
  return &kControls;
}
