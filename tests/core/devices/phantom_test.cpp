/// The Phantom's driver against the fake vendor library, through dlopen.

#include <gmock/gmock.h>

#include "tests/core/devices/fake_hd/fake_machine.h"

namespace palpate::test {
namespace {

using hd::DriverState;
using ::testing::HasSubstr;
using ::testing::Not;

class PhantomTest : public FakeMachine {};

TEST_F(PhantomTest, OpensInTheVendorsSequenceAndTellsWhatTheDeviceIs) {
  configure({});
  Phantom phantom(options());
  const auto opened = phantom.open();
  ASSERT_TRUE(opened) << sentence(opened.error());
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  EXPECT_EQ(phantom.facts().model, "Touch");
  EXPECT_EQ(phantom.facts().serial, "SERIAL-0001");
  EXPECT_EQ(phantom.facts().firmware, "2.040");
  EXPECT_EQ(phantom.facts().driverVersion, "1.0 fake");
  EXPECT_EQ(phantom.facts().updateRate, 1000);
  EXPECT_EQ(phantom.info().model, "touch");
  EXPECT_EQ(phantom.info().name, "Touch (Default PHANToM)");
  EXPECT_FALSE(phantom.info().simulated);
  EXPECT_FALSE(phantom.info().feelsTorque);
  EXPECT_DOUBLE_EQ(phantom.info().peakForce, 3.3);
  EXPECT_DOUBLE_EQ(phantom.info().workspaceMin[2], -0.035);
  EXPECT_DOUBLE_EQ(phantom.info().workspaceMax[0], 0.080);
  EXPECT_THAT(phantom.libraryPath(), HasSubstr("fake_hd"));
  EXPECT_EQ(fake().calls("hdStartScheduler"), 1);
  EXPECT_EQ(fake().calls("hdEnable"), 1);
  EXPECT_EQ(fake().priority(), 0xFFFF);
  phantom.close();
  EXPECT_EQ(phantom.read(9).status, kDeviceLost);
  EXPECT_EQ(fake().calls("hdUnschedule"), 1);
  EXPECT_EQ(fake().calls("hdDisable"), 1);
  EXPECT_EQ(fake().calls("hdDisableDevice"), 1);
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomTest, ConvertsLengthsAndTorquesOnceAndKeepsAxes) {
  fake_hd::DeviceSetup premium;
  premium.model = "PHANTOM Premium 1.5 6DOF";
  premium.outputDof = 6;
  premium.maxForce = 8.5;
  premium.motors = 6;
  const int device = configure(premium);
  Eigen::Isometry3d X = at(0.010, -0.020, 0.030);
  X.linear() = expMap(Eigen::Vector3d(0.3, -0.7, 1.1)).toRotationMatrix();
  fake().setTransform(device, transform(X).data());
  fake().setButtons(device, 5);
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  EXPECT_TRUE(phantom.info().feelsTorque);
  EXPECT_DOUBLE_EQ(phantom.info().peakTorque, 0.170);
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  Owner owner(phantom);
  Wrench wrench;
  for (int i = 0; i < 3; ++i) {
    wrench.force[i] = 0.5 * (i + 1);
    wrench.torque[i] = 0.010 * (i + 1);
  }
  owner.push(wrench);
  owner.start();
  fake().waitTicks(20);
  const DeviceSample sample = owner.sample();
  EXPECT_EQ(sample.status, kDeviceOk);
  EXPECT_EQ(sample.buttons, 5u);
  EXPECT_DOUBLE_EQ(sample.t, 1e-3 * static_cast<double>(sample.index));
  EXPECT_LT((position(sample.pose) - X.translation()).norm(), 1e-12);
  EXPECT_LT(logMap(orientation(sample.pose) * Eigen::Quaterniond(X.linear()).conjugate()).norm(),
            1e-12);
  const auto record = records(device).back();
  for (int i = 0; i < 3; ++i) {
    EXPECT_DOUBLE_EQ(record.force[i], 0.5 * (i + 1));
    EXPECT_DOUBLE_EQ(record.torque[i], 10.0 * (i + 1));  // mN·m
  }
}

TEST_F(PhantomTest, SendsNoTorqueToADeviceWithoutItsMotors) {
  const int device = configure({});
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  Owner owner(phantom);
  Wrench wrench;
  wrench.force[1] = 1.0;
  wrench.torque[1] = 0.1;
  owner.push(wrench);
  owner.start();
  fake().waitTicks(20);
  EXPECT_DOUBLE_EQ(records(device).back().force[1], 1.0);
  for (const auto& record : records(device)) EXPECT_FALSE(record.torqueSet);
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomTest, TriesTheUsualNamesAndThenTheDefault) {
  fake_hd::DeviceSetup other;
  other.name = "Default Device";
  configure(other);
  Phantom second(options());
  ASSERT_TRUE(second.open());
  EXPECT_EQ(second.facts().configuredName, "Default Device");
  second.close();
  fake().reset();
  other.name = nullptr;
  configure(other);
  Phantom nameless(options());
  ASSERT_TRUE(nameless.open());
  EXPECT_EQ(nameless.facts().configuredName, "");
  EXPECT_EQ(nameless.info().name, "Touch");
}

TEST_F(PhantomTest, NamesEveryNameThatWasTriedAndWhatToDo) {
  Phantom phantom(options());
  const auto opened = phantom.open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().kind, ErrorKind::Machine);
  EXPECT_EQ(sentence(opened.error()),
            "No Phantom answered. Field: device. Found: \"Default PHANToM\": DEVICE_FAULT (0x300, "
            "internal 5); \"Default Device\": DEVICE_FAULT (0x300, internal 5); the default "
            "device: DEVICE_FAULT (0x300, internal 5). Check that the device is switched on and "
            "plugged in, that the vendor's set-up tool lists it under this name (its folder is "
            "named by GTDD_HOME), and that you may use its port.");
}

TEST_F(PhantomTest, OpensAtTheSecondAttemptWhereTheFirstFailed) {
  const int device = configure({});
  fake().failInit(device, 0x302, 2);  // by name, and as the default device
  Phantom phantom(options());
  const auto failed = phantom.open();
  ASSERT_FALSE(failed);
  EXPECT_THAT(*failed.error().found, HasSubstr("COMM_ERROR (0x302, internal 77)"));
  EXPECT_THAT(*failed.error().advice, HasSubstr("does not answer"));
  EXPECT_EQ(phantom.status().state, DriverState::Closed);
  ASSERT_TRUE(phantom.open());
  EXPECT_TRUE(reaches(phantom, DriverState::Ready));
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomTest, LeavesNothingHalfOpenWhereTheSchedulerFails) {
  configure({});
  for (const bool start : {true, false}) {
    if (start)
      fake().failStart(0x304, 1);
    else
      fake().failSchedule(0x501, 1);
    Phantom phantom(options());
    const auto failed = phantom.open();
    ASSERT_FALSE(failed);
    EXPECT_THAT(*failed.error().found, HasSubstr(start ? "TIMER_ERROR" : "SCHEDULER_FULL"));
    EXPECT_EQ(phantom.status().state, DriverState::Closed);
    const auto again = phantom.open();
    ASSERT_TRUE(again) << sentence(again.error());
    EXPECT_TRUE(reaches(phantom, DriverState::Ready));
  }
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomTest, RefusesADeviceAtAnotherRate) {
  fake_hd::DeviceSetup slow;
  slow.updateRate = 500;
  configure(slow);
  Phantom phantom(options());
  const auto opened = phantom.open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(sentence(opened.error()),
            "The device does not run at the servo's rate. Field: device. Found: 500 Hz. Expected: "
            "1000 Hz. Set the device's rate to 1000 Hz in the vendor's set-up tool.");
  EXPECT_EQ(fake().calls("hdDisableDevice"), 1);
}

TEST_F(PhantomTest, DrivesTwoDevicesByTheirNames) {
  fake_hd::DeviceSetup left, right;
  left.name = "Left";
  right.name = "Right";
  right.model = "Touch X";
  right.maxForce = 7.9;
  const int l = configure(left), r = configure(right);
  fake().setTransform(l, transform(at(-0.05, 0, 0)).data());
  fake().setTransform(r, transform(at(0.05, 0, 0)).data());
  Phantom a(options({"Left"})), b(options({"Right"}));
  ASSERT_TRUE(a.open());
  Owner ownerA(a), ownerB(b);
  ownerA.pushForce(1, 0, 0);
  ownerA.start();
  ASSERT_TRUE(eventually([&] { return appliedForce(l) > 0.5; }));
  // Taking the second pauses the first, and never under force.
  ASSERT_TRUE(b.open());
  ownerB.pushForce(0, 2, 0);
  ownerB.start();
  ASSERT_TRUE(eventually([&] { return appliedForce(l) == 1.0 && appliedForce(r) == 2.0; }));
  EXPECT_DOUBLE_EQ(ownerA.sample().pose.p[0], -0.05);
  EXPECT_DOUBLE_EQ(ownerB.sample().pose.p[0], 0.05);
  EXPECT_EQ(b.info().model, "touch-x");

  // A fault of one leaves the other at work.
  fake().inject(l, fake_hd::Fault::Lost, 0, 0, 1000000);
  ASSERT_TRUE(reaches(a, DriverState::Lost));
  fake().waitTicks(20);
  EXPECT_EQ(b.status().state, DriverState::Ready);
  EXPECT_DOUBLE_EQ(appliedForce(r), 2.0);
  ownerA.sample();
  EXPECT_EQ(ownerA.sample().status, kDeviceLost | kDeviceInvalidSample);

  // So does closing one.
  a.close();
  ASSERT_TRUE(eventually([&] { return appliedForce(r) == 2.0; }));
  EXPECT_EQ(a.status().state, DriverState::Closed);

  Phantom again(options({"Right"}));
  const auto busy = again.open();
  ASSERT_FALSE(busy);
  EXPECT_EQ(*busy.error().advice,
            "The device is already in use: close the other program or view that holds it.");
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomTest, ErrorsGoToTheDeviceTheyName) {
  fake_hd::DeviceSetup left, right;
  left.name = "Left";
  right.name = "Right";
  configure(left);
  const int r = configure(right);
  Phantom a(options({"Left"})), b(options({"Right"}));
  ASSERT_TRUE(a.open());
  ASSERT_TRUE(b.open());
  ASSERT_TRUE(reaches(a, DriverState::Ready));
  ASSERT_TRUE(reaches(b, DriverState::Ready));
  for (int i = 0; i < 20; ++i) fake().pushError(r, 0x300, 3);
  ASSERT_TRUE(reaches(b, DriverState::Fault));
  EXPECT_EQ(b.status().internalError, 3);
  fake().waitTicks(5);
  EXPECT_EQ(a.status().errors, 0u);
  EXPECT_EQ(a.status().state, DriverState::Ready);
}

TEST_F(PhantomTest, TheForceThatPersistsIsTakenBackBeforeTheDeviceIs) {
  const int device = configure({});
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  {
    Owner owner(phantom);
    owner.pushForce(0, 0, 2);
    owner.start();
    ASSERT_TRUE(eventually([&] { return appliedForce(device) == 2.0; }));
    // The machine itself holds a force that nobody takes back.
    fake().freezeScheduler(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_DOUBLE_EQ(appliedForce(device), 2.0);
    fake().freezeScheduler(0);
    phantom.close();
  }
  double force[3];
  fake().forceWhenDisabled(device, force);
  EXPECT_DOUBLE_EQ(norm(force), 0.0);
  EXPECT_EQ(fake().wasStoppedWhenDisabled(device), 1);
  const auto last = records(device, kQuietTicks);
  ASSERT_EQ(last.size(), kQuietTicks);
  for (const auto& record : last) {
    EXPECT_TRUE(record.forceSet);
    EXPECT_DOUBLE_EQ(norm(record.force), 0.0);
  }
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomTest, WithoutAnOwnersWordOrWithANonsensicalOneTheForceIsZero) {
  const int device = configure({});
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  Owner owner(phantom);
  owner.pushForce(1, 0, 0);
  owner.start();
  ASSERT_TRUE(eventually([&] { return appliedForce(device) == 1.0; }));
  owner.pauseWriting(true);
  EXPECT_TRUE(eventually([&] { return appliedForce(device) == 0.0; }));
  owner.pauseWriting(false);
  ASSERT_TRUE(eventually([&] { return appliedForce(device) == 1.0; }));
  owner.pushForce(1, std::numeric_limits<double>::quiet_NaN(), 0);
  EXPECT_TRUE(eventually([&] { return appliedForce(device) == 0.0; }));
  owner.pushForce(1, 0, std::numeric_limits<double>::infinity());
  fake().waitTicks(10);
  EXPECT_DOUBLE_EQ(appliedForce(device), 0.0);
  owner.pushForce(1, 0, 0);
  ASSERT_TRUE(eventually([&] { return appliedForce(device) == 1.0; }));
  phantom.stopServo();
  const std::uint64_t ticks = owner.ticks();
  EXPECT_DOUBLE_EQ(appliedForce(device), 0.0);
  fake().waitTicks(10);
  EXPECT_EQ(owner.ticks(), ticks);
}

TEST_F(PhantomTest, TellsButtonsInkwellAndWarmth) {
  fake_hd::DeviceSetup setup;
  setup.motors = 6;
  const int device = configure(setup);
  const double warmth[6] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  fake().setMotorTemperature(device, warmth);
  fake().setButtons(device, 2);
  fake().setInkwellRaw(device, 0);  // inverted: the stylus is in
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  ASSERT_TRUE(eventually([&] { return phantom.status().docked; }));
  EXPECT_EQ(phantom.status().buttons, 2u);
  EXPECT_EQ(phantom.status().motors, 6);
  EXPECT_DOUBLE_EQ(phantom.status().motorTemperature[5], 0.6);
  fake().setInkwellRaw(device, 1);
  EXPECT_TRUE(eventually([&] { return !phantom.status().docked; }));
}

TEST_F(PhantomTest, ItsConditionIsWhatAPersonNeeds) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 1;
  setup.calibration = 0x5002;  // needs the person
  const int device = configure(setup);
  const double warmth[3] = {0.1, 0.2, 0.3};
  fake().setMotorTemperature(device, warmth);
  fake().setButtons(device, 1);
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  using State = DeviceCondition::State;
  ASSERT_TRUE(eventually([&] { return phantom.condition().motorTemperature.size() == 3; }));
  DeviceCondition now = phantom.condition();
  EXPECT_EQ(now.state, State::Calibrating);
  EXPECT_TRUE(now.asksToConfirm);
  EXPECT_THAT(now.sentence, HasSubstr("reset"));
  EXPECT_EQ(now.serial, "SERIAL-0001");
  EXPECT_TRUE(now.hasInkwell);
  EXPECT_EQ(now.buttons, 1u);
  EXPECT_DOUBLE_EQ(now.motorTemperature[2], 0.3);
  phantom.confirm();
  ASSERT_TRUE(eventually([&] { return phantom.condition().state == State::Ready; }));
  EXPECT_FALSE(phantom.condition().asksToConfirm);
  fake().inject(device, fake_hd::Fault::Lost, 0, 2, 1 << 30);
  ASSERT_TRUE(eventually([&] { return phantom.condition().state == State::Gone; }));
  EXPECT_TRUE(phantom.condition().canReconnect);
  fake().clearFaults(device);
  HapticDevice& plainly = phantom;
  ASSERT_TRUE(plainly.reconnect());
  phantom.confirm();
  ASSERT_TRUE(eventually([&] { return phantom.condition().state == State::Ready; }));
  fake().pushError(device, 0x200, 0);  // WARM_MOTORS
  ASSERT_TRUE(eventually([&] { return phantom.condition().state == State::Problem; }));
  EXPECT_THAT(phantom.condition().sentence, HasSubstr("warm"));
  EXPECT_FALSE(phantom.condition().canReconnect);
}

TEST_F(PhantomTest, ADeviceWithoutInkwellOrThermometerIsNoFault) {
  fake_hd::DeviceSetup bare;
  bare.inkwell = false;
  bare.motors = 0;
  bare.calibrationStyles = 1;
  configure(bare);
  Phantom phantom(options());
  ASSERT_TRUE(phantom.open());
  ASSERT_TRUE(reaches(phantom, DriverState::Ready));
  fake().waitTicks(120);
  EXPECT_EQ(phantom.status().errors, 0u);
  EXPECT_EQ(phantom.status().motors, 0);
  EXPECT_FALSE(phantom.status().docked);
}

}  // namespace
}  // namespace palpate::test
