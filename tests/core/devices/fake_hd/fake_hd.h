#pragma once
/// The controls of the fake vendor library, beside the HDAPI functions that it exports.
///
/// The library is loaded with dlopen like the vendor's; a test finds fake_controls() in it and
/// calls through this table. Everything here may be called from any thread. Devices are numbered
/// by configure(). Nothing of this file is shared with the driver under test.

#include <cstddef>
#include <cstdint>

namespace palpate {
class HapticDevice;
}

namespace fake_hd {

struct DeviceSetup {
  const char* name = "Default PHANToM";  ///< As configured; nullptr: only the NULL name finds it.
  const char* model = "Touch";
  const char* serial = "SERIAL-0001";
  int outputDof = 3;
  int motors = 3;                  ///< Temperatures told; 0: the property is unknown.
  bool inkwell = true;             ///< Else the switch is unknown.
  unsigned calibrationStyles = 4;  ///< 1 encoder reset, 2 automatic, 4 inkwell
  unsigned calibration = 0x5000;   ///< The status to begin with.
  double maxForce = 3.3, maxContinuousForce = 0.88;      ///< N
  double maxTorque = 515.0, maxContinuousTorque = 48.0;  ///< mN·m
  int updateRate = 1000;
};

/// Where an injected error is pushed, or what an injected fault does.
enum class Fault : int {
  ErrorAtBegin,  ///< code pushed in hdBeginFrame
  ErrorAtSet,    ///< code pushed by the force's hdSetDoublev
  ErrorAtEnd,    ///< code pushed in hdEndFrame
  NanPose,       ///< the transform has a NaN (element = code, 0 to 15)
  ZeroPose,      ///< all sixteen numbers are zero
  SilentPose,    ///< the getter writes nothing and reports nothing
  MirroredPose,  ///< a reflection
  Lost,          ///< every call reports COMM_ERROR; the pose is NaN
  NestedBegin,   ///< another part has begun the frame already: ILLEGAL_BEGIN
  Stall,         ///< the scheduler sleeps `code` ms before the tick
};

/// One tick of one device as the motors saw it.
struct TickRecord {
  std::uint64_t tick = 0;
  double force[3] = {0, 0, 0};               ///< N, applied from the end of this tick's frame on
  double torque[3] = {0, 0, 0};              ///< mN·m
  double position[3] = {0, 0, 0};            ///< mm
  bool forceSet = false, torqueSet = false;  ///< in this tick
  bool faulty = false;                       ///< an injected fault was at work in it
};

struct Controls {
  /// Back to an empty machine with a 1 ms scheduler. Only while no device is initialised.
  void (*reset)();
  int (*configure)(const DeviceSetup* setup);
  void (*setPeriodMicroseconds)(int period);

  // The state of a device.
  void (*setTransform)(int device, const double* transform);  ///< 16 numbers, HDAPI's layout
  void (*setButtons)(int device, int buttons);
  void (*setInkwellRaw)(int device, int value);  ///< what the switch reads
  void (*setCalibration)(int device, unsigned status);
  void (*setMotorTemperature)(int device, const double* values);
  /// The pose, the buttons and the motors' effect come from this arm, in frame D and SI. It must
  /// outlive the device; nullptr detaches.
  void (*attachArm)(int device, palpate::HapticDevice* arm);

  // Faults.
  void (*inject)(int device, Fault fault, int code, int ticksFromNow, int ticks);
  void (*clearFaults)(int device);
  void (*failInit)(int device, unsigned code, int times);
  void (*failStart)(unsigned code, int times);
  void (*failSchedule)(unsigned code, int times);
  void (*failUpdateCalibration)(int device, unsigned code, int times);
  /// Pushed in this order, so they pop in the reverse one.
  void (*pushError)(int device, unsigned code, int internalCode);
  void (*pushErrorsInTick)(int device, const unsigned* codes, int count);
  void (*freezeScheduler)(int frozen);  ///< No tick, no word.

  // What happened.
  std::uint64_t (*ticks)();
  void (*waitTicks)(int ticks);
  std::size_t (*records)(int device, TickRecord* out, std::size_t capacity);  ///< newest last
  int (*calls)(const char* function);
  unsigned (*lastCalibrationStyle)(int device);
  void (*appliedForce)(int device, double* force);       ///< N, what the motors hold now
  void (*forceWhenDisabled)(int device, double* force);  ///< when hdDisableDevice came
  int (*wasStoppedWhenDisabled)(int device);
  int (*priority)();
  int (*violations)();  ///< calls that the API forbids: outside a frame, without a device, ...
};

}  // namespace fake_hd

extern "C" const fake_hd::Controls* fake_controls();
