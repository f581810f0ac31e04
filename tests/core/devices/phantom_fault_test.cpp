/// What the Phantom's driver makes of calibration, errors, bad poses and lost devices.

#include <gmock/gmock.h>

#include "tests/core/devices/fake_hd/fake_machine.h"

namespace palpate::test {
namespace {

using fake_hd::Fault;
using hd::DriverState;
using ::testing::HasSubstr;

constexpr int kForGood = 1000000;  // ticks
constexpr unsigned kNeedsUpdate = 0x5001, kNeedsPerson = 0x5002;

/// A device that is open, with an owner who pushes 1 N along x.
class PhantomFaultTest : public FakeMachine {
 protected:
  void open(const fake_hd::DeviceSetup& setup = {}) {
    device_ = configure(setup);
    fake().setTransform(device_, transform(at(0.01, 0.02, 0.03)).data());
    ASSERT_TRUE(phantom_.open());
    owner_.pushForce(1, 0, 0);
    owner_.start();
  }
  void openReady(const fake_hd::DeviceSetup& setup = {}) {
    open(setup);
    ASSERT_TRUE(reaches(phantom_, DriverState::Ready));
    ASSERT_TRUE(forceReturns());
  }
  bool forceReturns() {
    return eventually([&] { return appliedForce(device_) == 1.0; });
  }
  std::string described() { return describe(phantom_.status()); }

  int device_ = -1;
  Phantom phantom_{options()};
  Owner owner_{phantom_};
};

// ------------------------------------------------------------------------------- calibration

TEST_F(PhantomFaultTest, AutomaticCalibrationIsDoneWhenTheDeviceAsksForIt) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 7;  // any: the automatic one asks least of the person
  setup.calibration = kNeedsPerson;
  open(setup);
  ASSERT_TRUE(reaches(phantom_, DriverState::Calibrating));
  fake().waitTicks(120);
  EXPECT_EQ(described(),
            "Move the stylus slowly through the whole of its range: the arm calibrates itself.");
  EXPECT_EQ(owner_.sample().status, kDeviceNotReady);
  EXPECT_DOUBLE_EQ(appliedForce(device_), 0.0);
  EXPECT_EQ(fake().calls("hdUpdateCalibration"), 0);
  fake().setCalibration(device_, kNeedsUpdate);
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_EQ(fake().lastCalibrationStyle(device_), 2u);
  EXPECT_TRUE(forceReturns());
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomFaultTest, TheInkwellCalibratesOnceTheStylusIsInIt) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 4;
  setup.calibration = kNeedsPerson;
  open(setup);
  ASSERT_TRUE(reaches(phantom_, DriverState::Calibrating));
  fake().waitTicks(120);
  EXPECT_EQ(described(), "Put the stylus into the inkwell and leave it there for a second.");
  EXPECT_EQ(fake().calls("hdUpdateCalibration"), 0);
  fake().setInkwellRaw(device_, 0);
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_EQ(fake().lastCalibrationStyle(device_), 4u);
  EXPECT_EQ(fake().violations(), 0);
}

TEST_F(PhantomFaultTest, TheEncodersAreResetOnlyWhenThePersonConfirms) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 1;
  setup.calibration = kNeedsUpdate;
  open(setup);
  ASSERT_TRUE(reaches(phantom_, DriverState::Calibrating));
  fake().waitTicks(120);
  EXPECT_EQ(described(),
            "Bring the arm into its reset position, all links at right angles and the stylus "
            "level, hold it still and confirm.");
  EXPECT_EQ(fake().calls("hdUpdateCalibration"), 0);
  phantom_.confirm();
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_EQ(fake().lastCalibrationStyle(device_), 1u);
}

TEST_F(PhantomFaultTest, ACalibrationThatFailsIsNoFaultAndIsTriedAgain) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 2;
  setup.calibration = kNeedsUpdate;
  const int device = configure(setup);
  fake().failUpdateCalibration(device, 0x300, 3);
  ASSERT_TRUE(phantom_.open());
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_EQ(fake().calls("hdUpdateCalibration"), 4);
  EXPECT_GE(phantom_.status().errors, 3u);
}

TEST_F(PhantomFaultTest, AnUnknownStyleIsLeftToTheVendorsTool) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 8;
  setup.calibration = kNeedsUpdate;
  open(setup);
  fake().waitTicks(120);
  EXPECT_EQ(described(),
            "Calibrate the device with the vendor's tool: it names no way that Palpate knows.");
  EXPECT_EQ(fake().calls("hdUpdateCalibration"), 0);
}

TEST_F(PhantomFaultTest, ACalibrationLostAtWorkTakesTheForceAwayFirst) {
  fake_hd::DeviceSetup setup;
  setup.calibrationStyles = 2;
  openReady(setup);
  fake().setCalibration(device_, kNeedsUpdate);
  ASSERT_TRUE(eventually([&] { return fake().calls("hdUpdateCalibration") == 1; }));
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_TRUE(forceReturns());
  EXPECT_EQ(fake().violations(), 0);  // an update under force is one
}

// ------------------------------------------------------------------------------------ errors

struct Expected {
  unsigned code;
  DriverState state;
  bool heals;
  const char* words;
};

// Typed in again from haptics_facts.md §1.
const Expected kErrors[] = {
    {0x100, DriverState::Fault, true, "does not know a request"},
    {0x101, DriverState::Fault, true, "refused a value"},
    {0x102, DriverState::Fault, true, "refused an action"},
    {0x103, DriverState::Fault, true, "another kind of number"},
    {0x104, DriverState::Lost, false, "dropped the device"},
    {0x200, DriverState::Warm, true, "too warm"},
    {0x201, DriverState::Refused, true, "above its maximum"},
    {0x202, DriverState::Refused, true, "rose too quickly"},
    {0x203, DriverState::Refused, true, "moved faster"},
    {0x204, DriverState::Refused, true, "could not give the force"},
    {0x300, DriverState::Fault, true, "reports a fault"},
    {0x301, DriverState::Fault, false, "already in use"},
    {0x302, DriverState::Lost, true, "does not answer"},
    {0x303, DriverState::Lost, true, "set up wrongly"},
    {0x304, DriverState::Fault, false, "keep its clock"},
    {0x400, DriverState::Fault, true, "begun twice"},
    {0x401, DriverState::Fault, true, "without being begun"},
    {0x402, DriverState::Fault, true, "frame of the device failed"},
    {0x500, DriverState::Fault, false, "servo's priority"},
    {0x501, DriverState::Fault, false, "no more callbacks"},
    {0x600, DriverState::Fault, false, "licence"},
    {0x7AB, DriverState::Fault, false, "does not know: reconnect"},
};

class EveryError : public PhantomFaultTest, public ::testing::WithParamInterface<Expected> {};

TEST_P(EveryError, HasAStateASentenceAndAWayBack) {
  const Expected& expected = GetParam();
  openReady();
  fake().inject(device_, Fault::ErrorAtBegin, static_cast<int>(expected.code), 3, kForGood);
  ASSERT_TRUE(reaches(phantom_, expected.state));
  const PhantomStatus status = phantom_.status();
  EXPECT_EQ(status.error, expected.code);
  EXPECT_THAT(std::string(describe(status)), HasSubstr(expected.words));
  const std::uint32_t bit = expected.state == DriverState::Lost ? kDeviceLost : kDeviceFault;
  EXPECT_EQ(owner_.sample().status & (kDeviceLost | kDeviceFault), bit);
  fake().clearFaults(device_);
  // The force went in the very tick of the first error, and stayed away.
  int faulty = 0;
  for (const auto& record : records(device_)) {
    if (!record.faulty) continue;
    ++faulty;
    EXPECT_DOUBLE_EQ(norm(record.force), 0.0);
  }
  EXPECT_GT(faulty, 0);
  if (expected.heals) {
    EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
    EXPECT_EQ(phantom_.status().error, 0u);
  } else {
    fake().waitTicks(600);
    EXPECT_EQ(phantom_.status().state, expected.state);
    ASSERT_TRUE(phantom_.reconnect());
    EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  }
  EXPECT_TRUE(forceReturns());
}

std::string codeName(const ::testing::TestParamInfo<Expected>& info) {
  char text[16];
  std::snprintf(text, sizeof text, "Code%03X", info.param.code);
  return text;
}
INSTANTIATE_TEST_SUITE_P(Hdapi, EveryError, ::testing::ValuesIn(kErrors), codeName);

TEST_F(PhantomFaultTest, TheTableOfErrorsIsWhole) {
  EXPECT_EQ(hd::allErrors().size(), std::size(kErrors));  // SUCCESS for the unknown one
  for (const hd::ErrorMeaning& meaning : hd::allErrors())
    EXPECT_GT(std::string(meaning.sentence).size(), 10u) << meaning.name;
}

TEST_F(PhantomFaultTest, OfErrorsOnTheStackTheOldestIsTheCause) {
  fake().setPeriodMicroseconds(1000);  // half a second to look before it heals
  openReady();
  const unsigned cause[] = {0x303, 0x302, 0x201, 0x302};  // pops: 302, 201, 302, 303
  fake().pushErrorsInTick(device_, cause, 4);
  ASSERT_TRUE(reaches(phantom_, DriverState::Lost));
  EXPECT_EQ(phantom_.status().error, 0x303u);
  EXPECT_EQ(phantom_.status().errors, 4u);
}

TEST_F(PhantomFaultTest, AWorseErrorWinsAndALaterEqualOneDoesNotHideTheCause) {
  fake().setPeriodMicroseconds(1000);  // half a second to look before it heals
  openReady();
  const unsigned fault[] = {0x402};
  fake().pushErrorsInTick(device_, fault, 1);
  ASSERT_TRUE(reaches(phantom_, DriverState::Fault));
  const unsigned equal[] = {0x300};
  fake().pushErrorsInTick(device_, equal, 1);
  fake().waitTicks(3);
  EXPECT_EQ(phantom_.status().error, 0x402u);
  const unsigned worse[] = {0x302};
  fake().pushErrorsInTick(device_, worse, 1);
  ASSERT_TRUE(reaches(phantom_, DriverState::Lost));
  EXPECT_EQ(phantom_.status().error, 0x302u);
}

TEST_F(PhantomFaultTest, AStormOfErrorsDoesNotHoldTheServo) {
  fake().setPeriodMicroseconds(1000);  // half a second to look before it heals
  openReady();
  const std::vector<unsigned> storm(1000, 0x402);
  fake().pushErrorsInTick(device_, storm.data(), 1000);
  ASSERT_TRUE(reaches(phantom_, DriverState::Fault));
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
}

TEST_F(PhantomFaultTest, ANestedFrameCutsTheForceAndPasses) {
  openReady();
  fake().inject(device_, Fault::NestedBegin, 0, 2, kForGood);
  ASSERT_TRUE(reaches(phantom_, DriverState::Fault));
  EXPECT_EQ(phantom_.status().error, 0x400u);
  fake().waitTicks(600);
  EXPECT_EQ(phantom_.status().state, DriverState::Fault);
  EXPECT_DOUBLE_EQ(appliedForce(device_), 0.0);
  fake().clearFaults(device_);
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_TRUE(forceReturns());
}

TEST_F(PhantomFaultTest, AForceAboveTheDevicesMaximumIsRefusedByTheDeviceAndCutByUs) {
  openReady();
  owner_.pushForce(20, 0, 0);
  ASSERT_TRUE(reaches(phantom_, DriverState::Refused));
  EXPECT_EQ(phantom_.status().error, 0x201u);
  owner_.pushForce(1, 0, 0);
  EXPECT_TRUE(forceReturns());
}

// ------------------------------------------------------------------------------------- poses

struct BadPose {
  Fault fault;
  int code;
  const char* name;
};
class EveryBadPose : public PhantomFaultTest, public ::testing::WithParamInterface<BadPose> {};

TEST_P(EveryBadPose, RepeatsTheLastGoodOneWithoutForce) {
  openReady();
  fake().inject(device_, GetParam().fault, GetParam().code, 2, kForGood);
  ASSERT_TRUE(eventually([&] { return phantom_.status().invalidSamples >= 40; }));
  const DeviceSample sample = owner_.sample();
  EXPECT_EQ(sample.status, kDeviceInvalidSample);
  EXPECT_EQ(described(),
            "The device gives numbers that are not a pose: the force is off; check its cable, then "
            "clear the fault.");
  EXPECT_TRUE(isRigid(sample.pose));
  EXPECT_DOUBLE_EQ(sample.pose.p[0], 0.01);
  EXPECT_DOUBLE_EQ(sample.pose.p[1], 0.02);
  EXPECT_DOUBLE_EQ(sample.pose.p[2], 0.03);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isfinite(sample.v[i]));
    EXPECT_TRUE(std::isfinite(sample.w[i]));
  }
  fake().clearFaults(device_);
  ASSERT_TRUE(eventually([&] { return owner_.sample().status == kDeviceOk; }));
  EXPECT_TRUE(forceReturns());
  // As many ticks without force as without a pose; no more, no fewer.
  bool begun = false;
  for (const auto& record : records(device_)) {
    begun = begun || norm(record.force) > 0.0;
    if (begun) {
      EXPECT_EQ(norm(record.force) == 0.0, record.faulty) << record.tick;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EveryBadPose,
                         ::testing::Values(BadPose{Fault::NanPose, 0, "NanRotation"},
                                           BadPose{Fault::NanPose, 13, "NanPosition"},
                                           BadPose{Fault::NanPose, 15, "NanCorner"},
                                           BadPose{Fault::ZeroPose, 0, "Zero"},
                                           BadPose{Fault::SilentPose, 0, "Silent"},
                                           BadPose{Fault::MirroredPose, 0, "Mirrored"}),
                         [](const auto& info) { return info.param.name; });

// ------------------------------------------------------------------------- lost and found again

TEST_F(PhantomFaultTest, ALostDeviceComesBackByItself) {
  openReady();
  fake().inject(device_, Fault::Lost, 0, 2, kForGood);
  ASSERT_TRUE(reaches(phantom_, DriverState::Lost));
  EXPECT_EQ(phantom_.status().internalError, 11);
  ASSERT_TRUE(
      eventually([&] { return owner_.sample().status == (kDeviceLost | kDeviceInvalidSample); }));
  EXPECT_DOUBLE_EQ(owner_.sample().pose.p[0], 0.01);
  const std::uint64_t ticks = owner_.ticks();
  fake().waitTicks(50);
  EXPECT_GE(owner_.ticks(), ticks + 49);  // the servo runs on
  // It lost its calibration while it was away.
  fake().setCalibration(device_, kNeedsPerson);
  fake().setInkwellRaw(device_, 1);
  fake().clearFaults(device_);
  ASSERT_TRUE(reaches(phantom_, DriverState::Calibrating));
  fake().setInkwellRaw(device_, 0);
  ASSERT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_TRUE(forceReturns());
}

TEST_F(PhantomFaultTest, ReconnectingTakesTheDeviceAgainWhileTheServoRuns) {
  openReady();
  fake().inject(device_, Fault::Lost, 0, 2, kForGood);
  ASSERT_TRUE(reaches(phantom_, DriverState::Lost));
  fake().failInit(device_, 0x302, 1);
  const auto failed = phantom_.reconnect();
  ASSERT_FALSE(failed);
  EXPECT_THAT(sentence(failed.error()), HasSubstr("No Phantom answered"));
  const std::uint64_t ticks = owner_.ticks();
  fake().waitTicks(20);
  EXPECT_GT(owner_.ticks(), ticks);
  EXPECT_EQ(owner_.sample().status & kDeviceLost, kDeviceLost);
  EXPECT_EQ(phantom_.status().state, DriverState::Lost);
  fake().clearFaults(device_);
  ASSERT_TRUE(phantom_.reconnect());
  ASSERT_TRUE(reaches(phantom_, DriverState::Ready));
  EXPECT_TRUE(forceReturns());
}

TEST_F(PhantomFaultTest, ASchedulerThatStandsStillShowsAsAFault) {
  openReady();
  fake().freezeScheduler(1);
  ASSERT_TRUE(reaches(phantom_, DriverState::Fault));
  EXPECT_THAT(described(), HasSubstr("could not keep its clock"));
  fake().freezeScheduler(0);
  EXPECT_TRUE(reaches(phantom_, DriverState::Ready));
}

TEST_F(PhantomFaultTest, AStalledSchedulerOnlyPauses) {
  openReady();
  fake().inject(device_, Fault::Stall, 30, 2, 1);
  const std::uint64_t ticks = owner_.ticks();
  ASSERT_TRUE(eventually([&] { return owner_.ticks() > ticks + 20; }));
  EXPECT_EQ(phantom_.status().state, DriverState::Ready);
  EXPECT_EQ(phantom_.status().errors, 0u);
}

}  // namespace
}  // namespace palpate::test
