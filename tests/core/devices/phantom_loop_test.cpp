/// The closed loop: simulated arm and hand behind the vendor's library, the driver, and the servo
/// loop as shipped, on the vendor's thread.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "core/devices/hand.h"
#include "core/devices/simulated_phantom.h"
#include "core/haptics/servo_loop.h"
#include "tests/core/devices/fake_hd/fake_machine.h"

namespace palpate::test {
namespace {

constexpr double kWall = 0.0;  // y of D; the anatomy is below

/// Goes down 30 mm in a second, through the wall by 8 mm, stays a second, and comes back.
class PressingHand final : public Hand {
 public:
  HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
    HandTarget wanted;
    const double down = std::min(std::max(t - 0.3, 0.0), 1.0);
    const double up = std::min(std::max(t - 2.3, 0.0), 1.0);
    wanted.pose_D.p[1] = kWall + 0.022 - 0.030 * (down - up);
    wanted.buttons = 1;
    return wanted;
  }
};

/// The servo loop, with a tool that a plane stops: what the simulation would publish.
class WallServo {
 public:
  WallServo(Phantom& phantom) : loop_(phantom, settings(phantom)), record_(4000) {}
  static void tick(void* self) noexcept { static_cast<WallServo*>(self)->tick(); }

  std::size_t ticks() const { return ticks_.load(std::memory_order_acquire); }
  const std::vector<ServoSample>& record() const { return record_; }

 private:
  static ServoSettings settings(const Phantom& phantom) {
    ServoSettings settings;
    settings.gains = recommendedGains(phantom.info());
    settings.limits = recommendedLimits(phantom.info());
    return settings;
  }
  void tick() noexcept {
    const std::size_t now = ticks_.load(std::memory_order_relaxed);
    const ServoSample done = loop_.tick();
    if (now < record_.size()) record_[now] = done;
    ToolState tool;
    tool.step = now + 1;
    tool.dueTick = done.device.index + 1;
    tool.pose = done.device.pose;
    std::copy_n(done.device.v, 3, tool.v);
    if (tool.pose.p[1] < kWall) {
      tool.contacts = 1;
      tool.pose.p[1] = kWall;
      tool.v[1] = 0.0;
    }
    loop_.publishTool(tool);
    ticks_.store(now + 1, std::memory_order_release);
  }
  ServoLoop loop_;
  std::vector<ServoSample> record_;
  std::atomic<std::size_t> ticks_{0};
};

class PhantomLoopTest : public FakeMachine, public ::testing::WithParamInterface<const char*> {};

TEST_P(PhantomLoopTest, AHandPressesOnAWallThroughTheVendorsLibraryAndNoEnergyIsMade) {
  const std::string model = GetParam();
  fake_hd::DeviceSetup setup;
  setup.model = model == "touch"     ? "Touch"
                : model == "touch-x" ? "Touch X"
                                     : "PHANTOM Premium 1.5 6DOF";
  setup.outputDof = model == "premium-6dof" ? 6 : 3;
  auto arm = makeSimulatedPhantom(model, std::make_shared<PressingHand>(), 7);
  ASSERT_TRUE(arm);
  setup.maxForce = (*arm)->info().peakForce;
  const int device = configure(setup);
  fake().attachArm(device, arm->get());
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  WallServo servo(phantom);
  ASSERT_TRUE(phantom.startServo(&WallServo::tick, &servo));
  ASSERT_TRUE(eventually([&] { return servo.ticks() >= 3500; }));
  phantom.close();

  const auto& all = servo.record();
  double deepest = 0.0, strongest = 0.0, energy = 0.0, steady = 0.0;
  for (std::size_t i = 1; i < 3500; ++i) {
    const double y = all[i].device.pose.p[1];
    deepest = std::max(deepest, kWall - y);
    strongest = std::max(strongest, norm(all[i].wrench.force));
    for (int k = 0; k < 3; ++k)
      energy -=
          all[i - 1].wrench.force[k] * (all[i].device.pose.p[k] - all[i - 1].device.pose.p[k]);
    EXPECT_EQ(all[i].fault, SafetyFault::None) << i;
    for (int k = 0; k < 3; ++k)
      EXPECT_LE(std::abs(all[i].wrench.force[k] - all[i - 1].wrench.force[k]), 1.0 + 1e-9) << i;
    EXPECT_GT(energy, -20e-6) << i;  // design: "Force and safety"
    if (i >= 1800 && i < 2200) steady += all[i].wrench.force[1] / 400.0;
  }
  EXPECT_GT(steady, 0.2);  // N, up against the hand
  EXPECT_LT(deepest, 0.009);
  EXPECT_LE(strongest, recommendedLimits(phantom.info()).peakForce + 1e-9);
  // In the end nothing pushes, and the machine was left without force.
  EXPECT_LT(norm(all[3499].wrench.force), 1e-12);
  EXPECT_DOUBLE_EQ(appliedForce(device), 0.0);
  EXPECT_EQ(fake().violations(), 0);
  std::printf("%s: deepest %.2f mm, strongest %.2f N, steady %.2f N, hand energy %.1f µJ\n",
              model.c_str(), 1e3 * deepest, strongest, steady, 1e6 * energy);
}

INSTANTIATE_TEST_SUITE_P(Arms, PhantomLoopTest,
                         ::testing::Values("touch", "touch-x", "premium-6dof"), [](const auto& i) {
                           std::string name = i.param;
                           std::erase(name, '-');
                           return name;
                         });

class PhantomServoFaultTest : public FakeMachine {};

TEST_F(PhantomServoFaultTest, TheServosSafetySeesEachOfTheDriversStates) {
  fake_hd::DeviceSetup setup;
  setup.calibration = 0x5002;
  const int device = configure(setup);
  fake().setTransform(device, transform(at(0, 0.02, 0)).data());
  fake().setButtons(device, 1);
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  struct Loop {
    explicit Loop(Phantom& phantom) : loop(phantom, ServoSettings{}) {}
    ServoLoop loop;
    LatestValue<ServoSample> samples;
    std::uint64_t step = 0;
    static void tick(void* p) noexcept {
      Loop& self = *static_cast<Loop*>(p);
      const ServoSample done = self.loop.tick();
      self.samples.publish(done);
      ToolState tool;
      tool.step = ++self.step;
      tool.dueTick = done.device.index + 1;
      tool.pose = done.device.pose;
      self.loop.publishTool(tool);
    }
    const ServoSample& newest() {
      samples.refresh();
      return samples.value();
    }
  } loop(phantom);
  ASSERT_TRUE(phantom.startServo(&Loop::tick, &loop));
  fake().waitTicks(100);
  EXPECT_EQ(loop.newest().state, SafetyState::Disarmed);  // not calibrated: no fault, no force
  EXPECT_EQ(loop.newest().fault, SafetyFault::None);
  fake().setCalibration(device, 0x5000);
  ASSERT_TRUE(eventually([&] { return loop.newest().state == SafetyState::Armed; }));
  const auto fault = [&](SafetyFault wanted) {
    EXPECT_TRUE(eventually([&] { return loop.newest().fault == wanted; }))
        << describe(wanted) << " but " << describe(loop.newest().fault);
    EXPECT_TRUE(reaches(phantom, hd::DriverState::Ready));
    fake().setButtons(device, 0);
    fake().waitTicks(10);
    loop.loop.clearFault();
    fake().waitTicks(10);
    fake().setButtons(device, 1);
    EXPECT_TRUE(eventually([&] { return loop.newest().state == SafetyState::Armed; }));
  };
  fake().inject(device, fake_hd::Fault::ErrorAtEnd, 0x201, 2, 1);
  fault(SafetyFault::DeviceFault);
  fake().inject(device, fake_hd::Fault::Lost, 0, 2, 10);
  fault(SafetyFault::DeviceLost);
  fake().inject(device, fake_hd::Fault::NanPose, 12, 2, 10);
  fault(SafetyFault::InvalidSample);
  phantom.stopServo();
}

}  // namespace
}  // namespace palpate::test
