#include "core/haptics/servo_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// A device that says what it is told to and remembers what it got.
class ScriptedDevice final : public HapticDevice {
 public:
  const DeviceInfo& info() const noexcept override { return info_; }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  DeviceSample read(std::uint64_t) noexcept override { return next; }
  void write(const Wrench& w) noexcept override { got = w; }

  DeviceSample next;
  Wrench got;

 private:
  DeviceInfo info_;
};

ToolState toolAt(std::uint64_t step, std::uint64_t due, const Eigen::Vector3d& p,
                 const Eigen::Vector3d& v = Eigen::Vector3d::Zero()) {
  ToolState t;
  t.step = step;
  t.dueTick = due;
  t.pose = plain(p, Eigen::Quaterniond::Identity());
  for (int i = 0; i < 3; ++i) t.v[i] = v[i];
  return t;
}

/// The same with the tool on the anatomy: only then a force leaves the program.
ToolState touchingAt(std::uint64_t step, std::uint64_t due, const Eigen::Vector3d& p,
                     const Eigen::Vector3d& v = Eigen::Vector3d::Zero()) {
  ToolState t = toolAt(step, due, p, v);
  t.contacts = 1;
  return t;
}

ServoSettings plainSettings() {
  ServoSettings s;
  s.gains = {500.0, 0.0, 0.0, 0.0};
  s.limits.peakTorque = 0.1;
  return s;
}

/// Ticks with a tool state each, until armed.
std::uint64_t arm(ServoLoop& servo, const Eigen::Vector3d& tool) {
  servo.setEnabled(true);
  ServoSample s;
  std::uint64_t tick = 0;
  while (s.state != SafetyState::Armed && tick < 1000) {
    servo.publishTool(toolAt(tick + 1, tick, tool));
    s = servo.tick();
    ++tick;
  }
  EXPECT_EQ(s.state, SafetyState::Armed);
  return tick;
}

TEST(ServoLoop, MapsThePoseToTheWorldAndTheForceBack) {
  ScriptedDevice device;
  device.next.pose = plain(Eigen::Vector3d(0.01, 0.02, 0.03), expMap({0.1, 0.2, 0.3}));
  ServoSettings settings = plainSettings();
  settings.X_WD =
      Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ());
  ServoLoop servo(device, settings);
  const Eigen::Vector3d p_W = settings.X_WD * Eigen::Vector3d(0.01, 0.02, 0.03);
  arm(servo, p_W + Eigen::Vector3d(0.0001, 0, 0));  // pulled along +x of W: -y of D
  servo.publishTool(touchingAt(2000, 2000, p_W + Eigen::Vector3d(0.0001, 0, 0)));
  const ServoSample s = servo.tick();
  EXPECT_LT((position(s.device.pose) - p_W).norm(), 1e-15);
  EXPECT_NEAR(s.wrench.force[0], 0.05, 1e-9);
  EXPECT_NEAR(device.got.force[1], -0.05, 1e-9);
  EXPECT_NEAR(device.got.force[0], 0.0, 1e-12);
}

TEST(ServoLoop, ExtrapolatesTheToolToThePresentTick) {
  ScriptedDevice device;
  ServoSettings settings = plainSettings();
  settings.declaredStepTicks = 10;
  ServoLoop servo(device, settings);
  const std::uint64_t now = arm(servo, Eigen::Vector3d::Zero());
  servo.publishTool(touchingAt(5000, now, {0, 0, 0}, {0.01, 0, 0}));
  for (int i = 0; i < 10; ++i) {
    const ServoSample s = servo.tick();
    EXPECT_NEAR(s.wrench.force[0], 500.0 * 0.01 * 1e-3 * i, 1e-9) << i;
  }
}

TEST(ServoLoop, FreeSpaceIsWithoutForceAndAContactIsLetGoOverTwentyTicks) {
  ScriptedDevice device;
  ServoLoop servo(device, plainSettings());
  std::uint64_t now = arm(servo, {0.001, 0, 0});
  EXPECT_EQ(device.got.force[0], 0.0) << "a tool that lags in free space is no drag";
  for (int i = 0; i < 50; ++i, ++now) {
    device.next.pose.p[0] -= 1e-5;  // pressed in, so that the energy balance allows the force
    servo.publishTool(touchingAt(5000 + now, now, {0.001, 0, 0}));
    (void)servo.tick();
  }
  const double held = device.got.force[0];
  EXPECT_GT(held, 0.05);
  for (int i = 1; i <= 20; ++i, ++now) {
    servo.publishTool(toolAt(6000 + now, now, {0.001, 0, 0}));
    (void)servo.tick();
    EXPECT_LT(device.got.force[0], i < 20 ? 1.0 : 1e-12) << i;
  }
  EXPECT_EQ(device.got.force[0], 0.0);
}

TEST(ServoLoop, NumbersThatAreNoPoseGiveZeroForceTheLastGoodPoseAndAFault) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(), 1e300};
  for (int field = 0; field < 13; ++field) {
    for (const double value : bad) {
      ScriptedDevice device;
      device.next.pose.p[1] = 0.01;
      ServoLoop servo(device, plainSettings());
      arm(servo, {0.001, 0.01, 0});
      const DeviceSample good = device.next;
      double* fields[] = {device.next.pose.p, device.next.pose.q, device.next.v, device.next.w};
      double& hit = field < 3    ? fields[0][field]
                    : field < 7  ? fields[1][field - 3]
                    : field < 10 ? fields[2][field - 7]
                                 : fields[3][field - 10];
      hit = value;
      const ServoSample s = servo.tick();
      EXPECT_EQ(s.state, SafetyState::Fault) << field << " " << value;
      EXPECT_NE(s.fault, SafetyFault::None);
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(device.got.force[i], 0.0);
        EXPECT_TRUE(std::isfinite(s.device.v[i]));
        EXPECT_TRUE(std::isfinite(s.handEnergy));
      }
      EXPECT_EQ(s.fault, SafetyFault::InvalidSample);
      EXPECT_EQ(s.device.pose.p[1], 0.01);
      // The way back: good numbers again, then cleared.
      device.next = good;
      servo.clearFault();
      servo.publishTool(toolAt(9000, 9000, {0, 0.01, 0}));
      EXPECT_EQ(servo.tick().fault, SafetyFault::None);
    }
  }
}

TEST(ServoLoop, AToolStateThatIsNotFiniteIsAnInvalidWrench) {
  ScriptedDevice device;
  ServoLoop servo(device, plainSettings());
  arm(servo, Eigen::Vector3d(0.001, 0, 0));
  servo.publishTool(toolAt(2000, 2000, {std::nan(""), 0, 0}));
  const ServoSample s = servo.tick();
  EXPECT_EQ(s.fault, SafetyFault::InvalidWrench);
  EXPECT_EQ(device.got.force[0], 0.0);
}

TEST(ServoLoop, ASilentSimulationFadesTheForceWithinItsTicks) {
  ScriptedDevice device;
  ServoLoop servo(device, plainSettings());
  const std::uint64_t now = arm(servo, Eigen::Vector3d(0.001, 0, 0));
  servo.publishTool(touchingAt(5000, now, {0.001, 0, 0}));
  int nonZero = 0;
  for (int i = 0; i < 100; ++i) {
    (void)servo.tick();
    if (std::abs(device.got.force[0]) > 1e-12) ++nonZero;
  }
  EXPECT_LE(nonZero, 15);  // 5 ticks of patience, 10 of fade
  EXPECT_GE(nonZero, 10);
}

TEST(ServoLoop, TheStylusButtonEnablesWhileItIsHeld) {
  ScriptedDevice device;
  device.next.buttons = 1;
  ServoLoop servo(device, plainSettings());
  ServoSample s;
  for (std::uint64_t i = 0; i < 400; ++i) {
    servo.publishTool(toolAt(i + 1, i, {0.001, 0, 0}));
    s = servo.tick();
  }
  EXPECT_EQ(s.state, SafetyState::Armed);
  device.next.buttons = 0;
  s = servo.tick();
  EXPECT_EQ(s.state, SafetyState::Disarmed);
  EXPECT_EQ(device.got.force[0], 0.0);
}

TEST(ServoLoop, ForceOffFromAnotherThreadIsHonouredAtTheNextTick) {
  ScriptedDevice device;
  ServoLoop servo(device, plainSettings());
  const std::uint64_t now = arm(servo, Eigen::Vector3d(0.001, 0, 0));
  servo.forceOff();
  servo.publishTool(toolAt(5000, now, {0.001, 0, 0}));
  EXPECT_EQ(servo.tick().state, SafetyState::Disarmed);
  EXPECT_EQ(device.got.force[0], 0.0);
}

TEST(ServoLoop, NumbersItsSamplesAndNamesTheToolStateItUsed) {
  ScriptedDevice device;
  ServoLoop servo(device, plainSettings());
  EXPECT_EQ(servo.tick().toolStep, 0u);
  servo.publishTool(toolAt(7, 1, {0, 0, 0}));
  const ServoSample s = servo.tick();
  EXPECT_EQ(s.toolStep, 7u);
  EXPECT_EQ(s.device.index, 1u);
  EXPECT_EQ(s.device.t, 1e-3);
  ASSERT_TRUE(servo.deviceSamples().refresh());
  EXPECT_EQ(servo.deviceSamples().value().index, 1u);
}

}  // namespace
}  // namespace palpate
