#include "core/haptics/virtual_coupling.h"

#include <algorithm>

namespace palpate {

double stiffestFor(double stepPeriod) noexcept {
  constexpr double kAddedMass = 0.016;  // kg; measured with the lightest arm (35 g), margin 2
  return kAddedMass / (stepPeriod * stepPeriod);
}

CouplingGains softened(const CouplingGains& gains, double share) noexcept {
  return {share * gains.stiffness, gains.damping, share * gains.stiffnessR, gains.dampingR};
}

CouplingGains recommendedGains(const DeviceInfo& device, double stepPeriod) noexcept {
  const double scale = std::min(1.0, stiffestFor(stepPeriod) / device.couplingStiffness);
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
