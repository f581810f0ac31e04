#pragma once
/// The vendor's HDAPI as Palpate sees it: our own prototypes, and the library found at run time.
///
/// No vendor header or library is used to build; every build can drive a Phantom, and finds out at
/// run time whether the vendor's library is there. Values and types: haptics_facts.md §1. Only
/// 64-bit builds: there the vendor's calling convention is the platform's.
///
/// A library once loaded is never unloaded: the vendor's driver does not survive being loaded twice
/// in one process. HD.dll on Windows and libHD.dylib on macOS are looked for as well
/// (shared_library.h); there it was never run.

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace palpate::hd {

static_assert(sizeof(void*) == 8, "32-bit HDAPI uses another calling convention");

using Handle = std::uint32_t;
using Enum = std::uint32_t;
using Boolean = unsigned char;
using CallbackCode = std::uint32_t;
using ULong = unsigned long;  // 64 bits on Linux, 32 on Windows, as the vendor's
using SchedulerHandle = unsigned long;
using Callback = CallbackCode (*)(void*);

/// Returned by value; its layout decides in which registers.
struct ErrorInfo {
  std::uint32_t code;
  int internalCode;
  Handle device;
};
static_assert(sizeof(ErrorInfo) == 12);

inline constexpr Handle kInvalidHandle = 0xFFFFFFFF;
inline constexpr CallbackCode kDone = 0, kContinue = 1;
inline constexpr std::uint16_t kHighestPriority = 0xFFFF;

inline constexpr Enum kButtons = 0x2000, kInkwellSwitch = 0x2002, kTransform = 0x2052;
inline constexpr Enum kVersion = 0x2500, kModelType = 0x2501, kDriverVersion = 0x2502,
                      kVendor = 0x2503, kSerialNumber = 0x2504, kFirmwareVersion = 0x2505;
inline constexpr Enum kUsableWorkspace = 0x2551, kOutputDof = 0x2554, kCalibrationStyle = 0x2555;
inline constexpr Enum kUpdateRate = 0x2600, kMaxForce = 0x2603, kMaxContinuousForce = 0x2604,
                      kMotorTemperature = 0x2605, kMaxTorque = 0x2622,
                      kMaxContinuousTorque = 0x2623;
inline constexpr Enum kForce = 0x2700, kTorque = 0x2701;
inline constexpr Enum kForceOutput = 0x4000;
inline constexpr Enum kCalibrationOk = 0x5000, kCalibrationNeedsUpdate = 0x5001,
                      kCalibrationNeedsManualInput = 0x5002;
inline constexpr std::uint32_t kStyleEncoderReset = 1, kStyleAuto = 2, kStyleInkwell = 4;

inline constexpr std::uint32_t kSuccess = 0, kInvalidEnum = 0x100, kInvalidValue = 0x101,
                               kInvalidOperation = 0x102, kInvalidInputType = 0x103,
                               kBadHandle = 0x104, kWarmMotors = 0x200, kExceededMaxForce = 0x201,
                               kExceededMaxForceImpulse = 0x202, kExceededMaxVelocity = 0x203,
                               kForceError = 0x204, kDeviceFaultCode = 0x300,
                               kDeviceAlreadyInitiated = 0x301, kCommError = 0x302,
                               kCommConfigError = 0x303, kTimerError = 0x304, kIllegalBegin = 0x400,
                               kIllegalEnd = 0x401, kFrameError = 0x402, kInvalidPriority = 0x500,
                               kSchedulerFull = 0x501, kInvalidLicense = 0x600;

/// The functions Palpate calls; all of them present, or the library is refused.
struct Api {
  Handle (*initDevice)(const char* name) = nullptr;  ///< nullptr: the vendor's default device
  void (*disableDevice)(Handle) = nullptr;
  void (*makeCurrentDevice)(Handle) = nullptr;
  void (*beginFrame)(Handle) = nullptr;
  void (*endFrame)(Handle) = nullptr;
  ErrorInfo (*getError)() = nullptr;  ///< Pops the newest; kSuccess when there is none.
  const char* (*getErrorString)(std::uint32_t code) = nullptr;
  void (*enable)(Enum) = nullptr;
  void (*disable)(Enum) = nullptr;
  void (*getBooleanv)(Enum, Boolean*) = nullptr;
  void (*getIntegerv)(Enum, std::int32_t*) = nullptr;
  void (*getDoublev)(Enum, double*) = nullptr;
  void (*setDoublev)(Enum, const double*) = nullptr;
  const char* (*getString)(Enum) = nullptr;
  Enum (*checkCalibration)() = nullptr;
  void (*updateCalibration)(Enum style) = nullptr;
  void (*startScheduler)() = nullptr;
  void (*stopScheduler)() = nullptr;
  void (*setSchedulerRate)(ULong) = nullptr;
  SchedulerHandle (*scheduleAsynchronous)(Callback, void*, std::uint16_t priority) = nullptr;
  void (*unschedule)(SchedulerHandle) = nullptr;
};

struct Library {
  std::string path;  ///< As the loader resolved it.
  Api api;
};

/// One name that was tried; `problem` is empty for the one that was taken.
struct LibraryAttempt {
  std::string name;
  std::string problem;  ///< A sentence.
  std::string advice;   ///< A sentence; may be empty.
};

struct LibrarySearch {
  std::vector<LibraryAttempt> attempts;
  const Library* library = nullptr;  ///< Lives as long as the process.
};

/// PALPATE_HD_LIBRARY where set, then the system's names: libHD.so, libHD.so.3.4.0, libHD.so.3.0.0.
[[nodiscard]] std::vector<std::string> libraryCandidates();

/// Takes the first candidate that loads with every function. Any thread but the servo's.
[[nodiscard]] LibrarySearch findLibrary(const std::vector<std::string>& candidates);

/// For a search that took none: Machine, what was tried and what to do.
[[nodiscard]] Error libraryError(const LibrarySearch& search);

}  // namespace palpate::hd
