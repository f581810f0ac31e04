#pragma once
/// What crosses between the servo and the simulation. Plain data, so that a triple buffer or a
/// recording can hold it. World axes, SI, unless a field says otherwise.

#include <cstdint>
#include <type_traits>

#include "core/geometry/pose.h"

namespace palpate {

/// Force N and torque N·m about the tool's origin.
struct Wrench {
  double force[3] = {0, 0, 0};
  double torque[3] = {0, 0, 0};
};

/// One reading of the device, numbered. From HapticDevice::read() it is in the device's frame D;
/// the servo maps it to the world before it publishes or records it.
struct DeviceSample {
  std::uint64_t index = 0;    ///< Servo tick, from 0.
  double t = 0.0;             ///< Seconds since start: index times the servo period.
  PlainPose pose;             ///< Of the stylus; the tool's frame T coincides with it.
  double v[3] = {0, 0, 0};    ///< m/s, filtered.
  double w[3] = {0, 0, 0};    ///< rad/s, filtered.
  std::uint32_t buttons = 0;  ///< Bit 0: the stylus' main button.
  std::uint32_t status = 0;   ///< DeviceStatus bits.
};
static_assert(std::is_trivially_copyable_v<DeviceSample>);

enum DeviceStatus : std::uint32_t {
  kDeviceOk = 0,
  kDeviceInvalidSample = 1,  ///< Not finite or not rigid: the last good pose is repeated.
  kDeviceLost = 2,           ///< The device no longer answers.
  kDeviceFault = 4,          ///< The vendor's library reports a fault.
  kDeviceNotReady = 8,       ///< Calibrating: no pose to trust, so no force; not a fault.
};

/// What the simulation publishes after each step; the servo extrapolates it. The wrench is
/// F = K (x_tool - x_device) + B (v_tool - v_device), so its derivatives are here as well: -K and
/// -B by the device's pose and velocity, which the servo knows at every tick, and K v_tool by time.
struct ToolState {
  std::uint64_t step = 0;          ///< Simulation step, from 1; 0 = nothing yet.
  std::uint64_t deviceSample = 0;  ///< The sample it used.
  std::uint64_t dueTick = 0;       ///< The servo tick at which the state holds.
  /// Servo ticks from one state to the next, lately: how long the servo waits for news.
  std::uint32_t paceTicks = 1;
  double stiffnessShare = 1.0;  ///< K and K_R in force, of ServoSettings::gains.
  PlainPose pose;               ///< Of T in W.
  double v[3] = {0, 0, 0};      ///< Of the origin of T, m/s.
  double w[3] = {0, 0, 0};      ///< rad/s.
  Wrench coupling;              ///< On the device, as the step saw it.
  std::uint32_t contacts = 0;
  double depth = 0.0;  ///< Deepest contact, m.
};
static_assert(std::is_trivially_copyable_v<ToolState>);

}  // namespace palpate
