/// A stand-in for the vendor's HDAPI library: the same C functions and error behaviour
/// (haptics_facts.md §1). Prototypes and values are written here again, so that a slip in the
/// driver's would show.

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <limits>

#include "tests/core/devices/fake_hd/fake_machine_state.h"

using namespace fake_hd;

namespace {

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
    // The motors keep their last force, and nobody is left to take it back.
    for (unsigned i = 0; i < m.devices.size(); ++i) {
      const Device& device = m.devices[i];
      const bool pushes =
          device.force[0] != 0.0 || device.force[1] != 0.0 || device.force[2] != 0.0;
      if (m.running && device.initialised && pushes && device.injections.empty()) ++m.violations;
    }
    m.running = false;
    thread = std::move(m.thread);
  }
  if (thread.joinable()) thread.join();
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
