#include "core/haptics/virtual_coupling.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(VirtualCoupling, IsASpringAndDamperTowardsTheTool) {
  const CouplingGains gains{600.0, 2.0, 0.24, 8e-4};
  const PlainPose tool = plain(Eigen::Vector3d(0.001, 0.002, -0.003), expMap({0, 0, 0.1}));
  DeviceSample device;
  device.v[0] = 0.05;
  device.w[2] = 2.0;
  const Wrench w = couplingWrench(gains, tool, {0.01, 0, 0}, {0, 0, 1.0}, device);
  EXPECT_NEAR(w.force[0], 600.0 * 0.001 + 2.0 * (0.01 - 0.05), 1e-12);
  EXPECT_NEAR(w.force[1], 600.0 * 0.002, 1e-12);
  EXPECT_NEAR(w.force[2], 600.0 * -0.003, 1e-12);
  EXPECT_NEAR(w.torque[2], 0.24 * 0.1 + 8e-4 * (1.0 - 2.0), 1e-12);
}

TEST(VirtualCoupling, TurnsTheShortWay) {
  const CouplingGains gains;
  DeviceSample device;  // identity
  Eigen::Quaterniond q = expMap({0, 0.2, 0});
  q.coeffs() = -q.coeffs();  // the same orientation
  const Wrench w =
      couplingWrench(gains, plain(Eigen::Vector3d::Zero(), q), {0, 0, 0}, {0, 0, 0}, device);
  EXPECT_NEAR(w.torque[1], gains.stiffnessR * 0.2, 1e-12);
}

TEST(VirtualCoupling, GainsAreTheDevicesAndLowerForSlowSteps) {
  DeviceInfo touchX;
  touchX.couplingStiffness = 600.0;
  touchX.couplingStiffnessR = 0.24;
  EXPECT_EQ(recommendedGains(touchX).stiffness, 600.0);
  EXPECT_EQ(recommendedGains(touchX, 5e-3).stiffness, 600.0);
  const CouplingGains slow = recommendedGains(touchX, 1e-2);
  EXPECT_NEAR(slow.stiffness, 160.0, 1e-9);
  EXPECT_NEAR(slow.stiffnessR, 0.24 * 160.0 / 600.0, 1e-12);
}

}  // namespace
}  // namespace palpate
