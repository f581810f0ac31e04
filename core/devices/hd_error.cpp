#include "core/devices/hd_error.h"

#include "core/devices/hdapi.h"

namespace palpate::hd {
namespace {

using enum DriverState;

// Ticks of 1 ms. A refusal heals quickly, because the servo's own safety has latched the fault
// anyway; a device that went away has to behave for half a second before it is believed.
constexpr std::uint32_t kSoon = 100, kCool = 2000, kProven = 500, kNever = 0;

constexpr ErrorMeaning kErrors[] = {
    {kSuccess, "SUCCESS", Ready, kSoon, "The device works."},
    {kInvalidEnum, "INVALID_ENUM", Fault, kProven,
     "The vendor's library does not know a request of Palpate: install OpenHaptics 3.0 or later."},
    {kInvalidValue, "INVALID_VALUE", Fault, kProven,
     "The vendor's library refused a value: the force is off; if it comes again, reconnect the "
     "device."},
    {kInvalidOperation, "INVALID_OPERATION", Fault, kProven,
     "The vendor's library refused an action in its present state: the force is off; if it comes "
     "again, reconnect the device."},
    {kInvalidInputType, "INVALID_INPUT_TYPE", Fault, kProven,
     "The vendor's library expects another kind of number: install OpenHaptics 3.0 or later."},
    {kBadHandle, "BAD_HANDLE", Lost, kNever,
     "The vendor's library has dropped the device: reconnect it."},
    {kWarmMotors, "WARM_MOTORS", Warm, kCool,
     "The motors are too warm: the force is off; let the arm rest for a few minutes."},
    {kExceededMaxForce, "EXCEEDED_MAX_FORCE", Refused, kSoon,
     "The device dropped a force above its maximum: let go of the anatomy and enable again."},
    {kExceededMaxForceImpulse, "EXCEEDED_MAX_FORCE_IMPULSE", Refused, kSoon,
     "The device dropped a force that rose too quickly: let go of the anatomy and enable again."},
    {kExceededMaxVelocity, "EXCEEDED_MAX_VELOCITY", Refused, kSoon,
     "The stylus moved faster than the device allows: hold it still and enable again."},
    {kForceError, "FORCE_ERROR", Refused, kSoon,
     "The device could not give the force that was asked for: enable again; if it comes again, "
     "reconnect the device."},
    {kDeviceFaultCode, "DEVICE_FAULT", Fault, kProven,
     "The device reports a fault: check its power and its cable, then reconnect it."},
    {kDeviceAlreadyInitiated, "DEVICE_ALREADY_INITIATED", Fault, kNever,
     "The device is already in use: close the other program or view that holds it."},
    {kCommError, "COMM_ERROR", Lost, kProven,
     "The device does not answer: check its cable and its power; it comes back by itself, or "
     "reconnect it."},
    {kCommConfigError, "COMM_CONFIG_ERROR", Lost, kProven,
     "The device's connection is set up wrongly: choose the port again in the vendor's set-up "
     "tool."},
    {kTimerError, "TIMER_ERROR", Fault, kNever,
     "The vendor's library could not keep its clock: close other heavy programs, then reconnect "
     "the device."},
    {kIllegalBegin, "ILLEGAL_BEGIN", Fault, kProven,
     "A frame of the device was begun twice: another part of the program uses it; close that, then "
     "clear the fault."},
    {kIllegalEnd, "ILLEGAL_END", Fault, kProven,
     "A frame of the device was ended without being begun: another part of the program uses it; "
     "close that, then clear the fault."},
    {kFrameError, "FRAME_ERROR", Fault, kProven,
     "A frame of the device failed: clear the fault; if it comes again, reconnect the device."},
    {kInvalidPriority, "INVALID_PRIORITY", Fault, kNever,
     "The vendor's scheduler refused the servo's priority: install OpenHaptics 3.0 or later."},
    {kSchedulerFull, "SCHEDULER_FULL", Fault, kNever,
     "The vendor's scheduler takes no more callbacks: close other views that use the device, then "
     "reconnect it."},
    {kInvalidLicense, "INVALID_LICENSE", Fault, kNever,
     "The vendor's library has no valid licence: install its licence, then reconnect the device."},
};

constexpr ErrorMeaning kUnknown{
    0xFFFFFFFF, "unknown", Fault, kNever,
    "The vendor's library reports an error that Palpate does not know: reconnect the device."};

}  // namespace

const char* name(DriverState state) noexcept {
  switch (state) {
    case Ready:
      return "ready";
    case Calibrating:
      return "calibrating";
    case Refused:
      return "force refused";
    case Warm:
      return "warm";
    case Fault:
      return "fault";
    case Lost:
      return "lost";
    case Closed:
      return "closed";
  }
  return "unknown";
}

const ErrorMeaning& meaningOf(std::uint32_t code) noexcept {
  for (const ErrorMeaning& meaning : kErrors)
    if (meaning.code == code) return meaning;
  return kUnknown;
}

std::span<const ErrorMeaning> allErrors() noexcept {
  return kErrors;
}

}  // namespace palpate::hd
