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

[[nodiscard]] CouplingGains recommendedGains(const DeviceInfo& device) noexcept;

/// Wrench on the device, about the origin of T, world axes:
/// F = K (x_tool - x_device) + B (v_tool - v_device), and likewise for rotation.
[[nodiscard]] Wrench couplingWrench(const CouplingGains& gains, const PlainPose& tool,
                                    const double (&toolV)[3], const double (&toolW)[3],
                                    const DeviceSample& device) noexcept;

}  // namespace palpate
