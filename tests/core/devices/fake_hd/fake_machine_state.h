#pragma once
/// The state of the fake machine, shared by the vendor's functions, the scheduler and the controls.

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/core/devices/fake_hd/fake_hd.h"

namespace fake_hd {

constexpr unsigned kNoDevice = 0xFFFFFFFFu;

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

/// The one of this library.
Machine& machine();
using Lock = std::lock_guard<std::mutex>;

// With the machine locked.
void push(unsigned code, unsigned device, int internalCode = 0);
/// A call that a correct driver never makes.
void forbidden(unsigned code, unsigned device);
Device* deviceOf(unsigned handle);
Device* currentDevice();
/// The fault that is at work now, if it is.
const Injection* injected(Device& device, Fault fault);
void called(const char* function);

/// The scheduler's thread.
void servo();

}  // namespace fake_hd
