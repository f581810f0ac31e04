#pragma once
/// The spring-damper between the device and the tool, in six degrees (Colgate 1995; paper 3.3).

#include "core/haptics/device.h"
#include "core/haptics/messages.h"

namespace palpate {

struct CouplingGains {
  double stiffness = 600.0;  ///< K_T, N/m
  double damping = 2.0;      ///< B_T, N·s/m
  double stiffnessR = 0.24;  ///< K_R, N·m/rad
  double dampingR = 8e-4;    ///< B_R, N·m·s/rad
};

/// The stiffest coupling, N/m, that steps of `stepPeriod` seconds allow (see recommendedGains).
[[nodiscard]] double stiffestFor(double stepPeriod) noexcept;

/// `share` (0..1) of K and K_R; the damping stays.
[[nodiscard]] CouplingGains softened(const CouplingGains& gains, double share) noexcept;

/// The device's own gains (half or less of what tests/stability measures to be stable with any
/// grip), lowered where the simulation's steps are long: the tool is then predicted up to two steps
/// ahead, which acts on the device as an added mass of about K·(1.5·step)²/2 and may not exceed the
/// arm's. K <= 0.016 kg / step²: 160 N/m at 10 ms, no limit up to 5 ms. Rotation alike.
[[nodiscard]] CouplingGains recommendedGains(const DeviceInfo& device,
                                             double stepPeriod = 1e-3) noexcept;

/// Wrench on the device, about the origin of T, world axes:
/// F = K (x_tool - x_device) + B (v_tool - v_device), and likewise for rotation.
[[nodiscard]] Wrench couplingWrench(const CouplingGains& gains, const PlainPose& tool,
                                    const double (&toolV)[3], const double (&toolW)[3],
                                    const DeviceSample& device) noexcept;

}  // namespace palpate
