#include "core/haptics/safety.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>
#include <string>

namespace palpate {
namespace {

using Inputs = SafetyGuard::Inputs;

Wrench force(double x, double y = 0.0, double z = 0.0) {
  Wrench w;
  w.force[0] = x;
  w.force[1] = y;
  w.force[2] = z;
  return w;
}

double size(const Wrench& w) {
  return std::hypot(w.force[0], w.force[1], w.force[2]);
}
bool isZero(const Wrench& w) {
  return size(w) == 0.0 && std::hypot(w.torque[0], w.torque[1], w.torque[2]) == 0.0;
}

Inputs enabled() {
  Inputs in;
  in.enabled = true;
  return in;
}

/// Enabled, out of contact, through the ramp, at full force zero.
SafetyGuard armed(SafetyLimits limits = {}) {
  SafetyGuard g(limits);
  for (int i = 0; i < 400; ++i) (void)g.apply({}, enabled());
  EXPECT_EQ(g.state(), SafetyState::Armed);
  return g;
}

TEST(SafetyGuard, GivesNoForceUntilEnabled) {
  SafetyGuard g({});
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(isZero(g.apply(force(1.0), {})));
  EXPECT_EQ(g.state(), SafetyState::Disarmed);
}

TEST(SafetyGuard, DoesNotArmInContactNorWithoutNews) {
  SafetyGuard g({});
  Inputs in = enabled();
  in.inContact = true;
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(isZero(g.apply(force(1.0), in)));
  EXPECT_EQ(g.state(), SafetyState::Blocked);
  in.inContact = false;
  in.ticksSinceNews = std::numeric_limits<std::uint32_t>::max();
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(isZero(g.apply(force(1.0), in)));
  EXPECT_EQ(g.state(), SafetyState::Blocked);
  in.ticksSinceNews = 0;
  (void)g.apply(force(1.0), in);
  EXPECT_EQ(g.state(), SafetyState::Ramping);
}

TEST(SafetyGuard, RampsUpEvenlyOnStart) {
  SafetyLimits limits;
  SafetyGuard g(limits);
  while (g.state() != SafetyState::Ramping) (void)g.apply({}, enabled());
  double last = 0.0;
  for (std::uint32_t i = 2; i <= limits.rampTicks; ++i) {
    const double f = size(g.apply(force(0.7), enabled()));
    EXPECT_NEAR(f, 0.7 * i / limits.rampTicks, 1e-9);
    EXPECT_GT(f, last);
    last = f;
  }
  EXPECT_EQ(g.state(), SafetyState::Armed);
}

TEST(SafetyGuard, LettingGoAndForceOffCutWithinTheTick) {
  SafetyGuard g = armed();
  EXPECT_GT(size(g.apply(force(0.5), enabled())), 0.4);
  EXPECT_TRUE(isZero(g.apply(force(0.5), {})));
  EXPECT_EQ(g.state(), SafetyState::Disarmed);

  SafetyGuard h = armed();
  (void)h.apply(force(0.5), enabled());
  Inputs off = enabled();
  off.forceOff = true;
  EXPECT_TRUE(isZero(h.apply(force(0.5), off)));
  // Still held: it stays off until the enable was let go once.
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(isZero(h.apply(force(0.5), enabled())));
  (void)h.apply({}, {});
  for (int i = 0; i < 500; ++i) (void)h.apply(force(0.5), enabled());
  EXPECT_EQ(h.state(), SafetyState::Armed);
}

TEST(SafetyGuard, SaturationKeepsTheDirection) {
  SafetyLimits limits;
  limits.peakForce = 3.0;
  SafetyGuard g = armed(limits);
  Wrench out;
  for (const double demand : {6.0, 15.0, 30.0}) {
    for (int i = 0; i < 10; ++i) {
      out = g.apply(force(demand * 0.48, demand * -0.6, demand * 0.64), enabled());
    }
    EXPECT_NEAR(size(out), 3.0, 1e-12);
    const double cosine = (0.48 * out.force[0] - 0.6 * out.force[1] + 0.64 * out.force[2]) / 3.0;
    EXPECT_GT(cosine, std::cos(M_PI / 180.0));
  }
  // No wind-up: the demand falls, the force is there with it.
  out = g.apply(force(0.24, -0.3, 0.32), enabled());
  EXPECT_NEAR(size(out), 0.5, 1e-12);
}

TEST(SafetyGuard, RisesAndTurnsAreAtMostOneNewtonATick) {
  constexpr int kSeed = 5;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> d(-8.0, 8.0);
  SafetyLimits limits;
  limits.continuousForce = limits.peakForce = 6.0;
  SafetyGuard g = armed(limits);
  Wrench last;
  for (int i = 0; i < 20000; ++i) {
    const double x = d(random), y = d(random), z = d(random);
    const Wrench now = g.apply(force(x, y, z), enabled());
    const double before = size(last), after = size(now);
    const double kept = before > after ? after / before : 1.0;  // falling is free
    const double change =
        std::hypot(now.force[0] - kept * last.force[0], now.force[1] - kept * last.force[1],
                   now.force[2] - kept * last.force[2]);
    ASSERT_LE(change, 1.0 + 1e-9) << "seed " << kSeed << " tick " << i;
    ASSERT_LE(after, 6.0 + 1e-9);
    last = now;
  }
}

TEST(SafetyGuard, TheContinuousLimitHoldsAfterASecond) {
  SafetyLimits limits;
  SafetyGuard g = armed(limits);
  int above = 0;
  for (int i = 0; i < 5000; ++i) {
    if (size(g.apply(force(2.5), enabled())) > limits.continuousForce + 1e-9) ++above;
  }
  EXPECT_LE(above, 1000);
  EXPECT_GT(above, 700);
  for (int i = 0; i < 1500; ++i) (void)g.apply(force(0.1), enabled());  // rest
  for (int i = 0; i < 10; ++i) (void)g.apply(force(2.5), enabled());
  EXPECT_NEAR(size(g.apply(force(2.5), enabled())), 2.5, 1e-12);
}

TEST(SafetyGuard, SilenceFadesToZeroAndNewsRampsUpAgain) {
  SafetyLimits limits;
  SafetyGuard g = armed(limits);
  for (int i = 0; i < 5; ++i) (void)g.apply(force(0.6), enabled());
  Inputs in = enabled();
  for (std::uint32_t silent = 1; silent <= limits.staleTicks; ++silent) {
    in.ticksSinceNews = silent;
    EXPECT_NEAR(size(g.apply(force(0.6), in)), 0.6, 1e-12);
  }
  double last = 0.6;
  for (std::uint32_t i = 1; i <= limits.fadeTicks; ++i) {
    in.ticksSinceNews = limits.staleTicks + i;
    const double f = size(g.apply(force(0.6), in));
    EXPECT_LT(f, last);
    last = f;
    EXPECT_EQ(g.state(), SafetyState::Fading);
  }
  EXPECT_NEAR(last, 0.0, 1e-12);
  in.ticksSinceNews = 0;
  std::uint32_t rising = 0;
  while (size(g.apply(force(0.6), in)) < 0.6 - 1e-9) ++rising;
  EXPECT_GE(rising, 100u);  // haptics_facts.md §4
}

TEST(SafetyGuard, SlowStepsHaveALongerWatchdog) {
  SafetyGuard g = armed();
  Inputs in = enabled();
  in.declaredStepTicks = 10;
  in.ticksSinceNews = 30;
  (void)g.apply(force(0.6), in);
  EXPECT_EQ(g.state(), SafetyState::Armed);
  in.ticksSinceNews = 31;
  (void)g.apply(force(0.6), in);
  EXPECT_EQ(g.state(), SafetyState::Fading);
}

struct FaultCase {
  SafetyFault fault;
  Inputs cause;
  Wrench wanted;
};

std::vector<FaultCase> everyFault() {
  std::vector<FaultCase> out;
  const auto add = [&](SafetyFault fault, auto change) {
    FaultCase c{fault, enabled(), force(0.6)};
    change(c);
    out.push_back(c);
  };
  add(SafetyFault::InvalidSample, [](auto& c) { c.cause.deviceStatus = kDeviceInvalidSample; });
  add(SafetyFault::InvalidSample, [](auto& c) { c.cause.speed = std::nan(""); });
  add(SafetyFault::DeviceLost, [](auto& c) { c.cause.deviceStatus = kDeviceLost; });
  add(SafetyFault::DeviceFault, [](auto& c) { c.cause.deviceStatus = kDeviceFault; });
  add(SafetyFault::InvalidWrench, [](auto& c) { c.wanted.torque[1] = std::nan(""); });
  add(SafetyFault::InvalidWrench, [](auto& c) { c.wanted.force[2] = INFINITY; });
  add(SafetyFault::OverSpeed, [](auto& c) { c.cause.speed = 2.1; });
  add(SafetyFault::Stalled, [](auto& c) { c.cause.ticksSinceNews = 501; });
  add(SafetyFault::EnergyGenerated, [](auto& c) { c.cause.energyFault = true; });
  return out;
}

TEST(SafetyGuard, EveryFaultCutsAtOnceIsSurfacedAndHasAWayBack) {
  for (const FaultCase& c : everyFault()) {
    SCOPED_TRACE(describe(c.fault));
    SafetyGuard g = armed();
    (void)g.apply(force(0.6), enabled());
    const Wrench cut = g.apply(c.wanted, c.cause);
    EXPECT_TRUE(isZero(cut));
    EXPECT_EQ(g.state(), SafetyState::Fault);
    EXPECT_EQ(g.fault(), c.fault);
    // Without being cleared it stays, even when the cause is gone.
    for (int i = 0; i < 500; ++i) EXPECT_TRUE(isZero(g.apply(force(0.6), enabled())));
    EXPECT_EQ(g.state(), SafetyState::Fault);
    // Cleared in contact: blocked until clear of the anatomy.
    Inputs in = enabled();
    in.inContact = in.clearFault = true;
    (void)g.apply(force(0.6), in);
    in.clearFault = false;
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(isZero(g.apply(force(0.6), in)));
    EXPECT_EQ(g.state(), SafetyState::Blocked);
    EXPECT_EQ(g.fault(), SafetyFault::None);
    for (int i = 0; i < 400; ++i) (void)g.apply(force(0.6), enabled());
    EXPECT_EQ(g.state(), SafetyState::Armed);
  }
}

TEST(SafetyGuard, AFaultIsNotClearedWhileItsCauseLasts) {
  SafetyGuard g = armed();
  Inputs in = enabled();
  in.deviceStatus = kDeviceLost;
  in.clearFault = true;
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(isZero(g.apply(force(0.6), in)));
  EXPECT_EQ(g.fault(), SafetyFault::DeviceLost);
}

TEST(SafetyGuard, ADeviceThatIsNotReadyGivesNoForceAndNoFault) {
  SafetyGuard g = armed();
  Inputs in = enabled();
  in.deviceStatus = kDeviceNotReady;
  EXPECT_TRUE(isZero(g.apply(force(0.6), in)));
  EXPECT_EQ(g.fault(), SafetyFault::None);
  EXPECT_EQ(g.state(), SafetyState::Disarmed);
}

TEST(SafetyGuard, EveryStateAndFaultHasItsOwnSentence) {
  std::set<std::string> sentences;
  for (int i = 0; i <= static_cast<int>(SafetyFault::EnergyGenerated); ++i) {
    const std::string s = describe(static_cast<SafetyFault>(i));
    EXPECT_EQ(s.back(), '.');
    EXPECT_TRUE(sentences.insert(s).second) << s;
  }
  for (int i = 0; i <= static_cast<int>(SafetyState::Fault); ++i) {
    EXPECT_TRUE(sentences.insert(describe(static_cast<SafetyState>(i))).second);
  }
}

TEST(SafetyGuard, LimitsAreInsideTheDevicesOwn) {
  DeviceInfo touch;
  touch.peakForce = 3.3;
  touch.continuousForce = 0.88;
  SafetyLimits limits = recommendedLimits(touch);
  EXPECT_LT(limits.peakForce, 3.3);
  EXPECT_LT(limits.continuousForce, 0.88);
  EXPECT_EQ(limits.peakTorque, 0.0);
  EXPECT_EQ(limits.forceSlew, 1.0);
  DeviceInfo strong;
  strong.peakForce = 37.5;
  strong.continuousForce = 6.2;
  strong.feelsTorque = true;
  strong.peakTorque = 0.188;
  limits = recommendedLimits(strong, 2e-3);
  EXPECT_EQ(limits.peakForce, 6.0);
  EXPECT_EQ(limits.forceSlew, 2.0);
  EXPECT_EQ(limits.staleTicks, 3u);
  EXPECT_EQ(limits.rampTicks, 100u);
  EXPECT_GT(limits.peakTorque, 0.1);
}

}  // namespace
}  // namespace palpate
