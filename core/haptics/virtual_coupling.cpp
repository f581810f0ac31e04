#include "core/haptics/virtual_coupling.h"

#include <algorithm>

namespace palpate {

CouplingGains recommendedGains(const DeviceInfo& device, double stepPeriod) noexcept {
  constexpr double kAddedMass = 0.016;  // kg; measured with the lightest arm (35 g), margin 2
  const double most = kAddedMass / (stepPeriod * stepPeriod);
  const double scale = std::min(1.0, most / device.couplingStiffness);
  return {scale * device.couplingStiffness, device.couplingDamping,
          scale * device.couplingStiffnessR, device.couplingDampingR};
}

Wrench couplingWrench(const CouplingGains& gains, const PlainPose& tool, const double (&toolV)[3],
                      const double (&toolW)[3], const DeviceSample& device) noexcept {
  const Eigen::Vector3d turn =
      logMap(orientation(tool) * orientation(device.pose).conjugate());  // device to tool, in W
  Wrench out;
  for (int i = 0; i < 3; ++i) {
    out.force[i] =
        gains.stiffness * (tool.p[i] - device.pose.p[i]) + gains.damping * (toolV[i] - device.v[i]);
    out.torque[i] = gains.stiffnessR * turn[i] + gains.dampingR * (toolW[i] - device.w[i]);
  }
  return out;
}

}  // namespace palpate
