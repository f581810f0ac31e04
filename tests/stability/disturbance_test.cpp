/// What goes wrong from outside, in closed loop: stalls, dropouts, deep starts, distance, jumps.

#include <gtest/gtest.h>

#include <random>

#include "tests/stability/closed_loop.h"
#include "tests/stability/recompute.h"
#include "tests/stability/test_hands.h"

namespace palpate::stability {
namespace {

constexpr double kEnergy = -20e-6;

double forceOf(const ServoSample& s) {
  return std::hypot(s.wrench.force[0], s.wrench.force[1], s.wrench.force[2]);
}

TEST(Disturbance, AStallFadesTheForceAndItComesBackSlowly) {
  for (const std::uint64_t stall : {20u, 100u}) {
    LoopCase c;
    c.hand = std::make_shared<PressingHand>(0.03, -0.008);
    c.meddle = [stall](std::uint64_t tick, ServoLoop&) {
      return tick < 2000 || tick >= 2000 + stall;
    };
    const LoopResult r = runLoop(c);
    ASSERT_GT(forceOf(r.samples[1999]), 0.5);
    // The last result was due at 2000; then 5 ticks of patience and 10 of fade.
    EXPECT_NEAR(forceOf(r.samples[2017]), 0.0, 1e-9);
    const std::size_t resumed = 2000 + stall + 2;
    // The hand sank in meanwhile; the force comes back over 200 ticks.
    for (std::size_t i = 0; i < 100; ++i) {
      const double share = (static_cast<double>(i) + 3.0) / 200.0;
      EXPECT_LE(forceOf(r.samples[resumed + i]), share * 6.0) << i;
    }
    // Less than before: what the ramp put into the pressed spring was never taken from the hand, so
    // the passivity controller holds it back until the tool is lifted and pressed again.
    EXPECT_GT(forceOf(r.samples.back()), 0.2);
    const Recomputed m = recompute(r.samples, r.limits.continuousForce);
    EXPECT_GE(m.lowestEnergy, kEnergy);
    EXPECT_LE(m.largestRise, 1.0 + 1e-9);
  }
}

TEST(Disturbance, ALongStallIsAFaultWithAWayBack) {
  LoopCase c;
  c.seconds = 6.0;
  c.meddle = [](std::uint64_t tick, ServoLoop& servo) {
    if (tick == 4800) servo.clearFault();
    return tick < 2000 || tick >= 2700;
  };
  const LoopResult r = runLoop(c);
  EXPECT_EQ(r.samples[2600].fault, SafetyFault::Stalled);
  EXPECT_EQ(r.samples[4700].state, SafetyState::Fault);
  EXPECT_EQ(forceOf(r.samples[4700]), 0.0);
  EXPECT_EQ(r.samples[4800].fault, SafetyFault::None);
  EXPECT_EQ(r.samples.back().state, SafetyState::Armed);
}

TEST(Disturbance, DroppedStepsStayPassive) {
  constexpr std::uint64_t kSeed = 77;
  for (const double share : {0.01, 0.05, 0.2}) {
    std::mt19937_64 random(kSeed);
    LoopCase c;
    c.meddle = [&](std::uint64_t, ServoLoop&) {
      return static_cast<double>(random() % 10000) >= 1e4 * share;
    };
    const LoopResult r = runLoop(c);
    const Recomputed m = recompute(r.samples, r.limits.continuousForce);
    EXPECT_GE(m.lowestEnergy, kEnergy) << "share " << share << " seed " << kSeed;
    EXPECT_LE(m.roughness, 0.08) << "share " << share << " seed " << kSeed;
    EXPECT_LE(m.largestRise, 1.0 + 1e-9);
    EXPECT_GT(m.largestForce, 0.8);
  }
}

TEST(Disturbance, ADeepStartGivesNoForceUntilClear) {
  LoopCase c;
  c.hand = std::make_shared<PressingHand>(-0.01, -0.012);
  c.seconds = 2.0;
  const LoopResult r = runLoop(c);
  for (const ServoSample& s : r.samples) ASSERT_EQ(forceOf(s), 0.0);
  EXPECT_EQ(r.samples.back().state, SafetyState::Blocked);
  // The tool itself leaves the anatomy, slowly, and stays out.
  for (std::size_t i = 1; i < r.tool_D.size(); ++i) {
    ASSERT_LE((r.tool_D[i] - r.tool_D[i - 1]).norm(), 0.25e-3);
  }
  EXPECT_GT(r.tool_D.back().y(), 0.0);
}

TEST(Disturbance, FarFromTheOriginItIsTheSame) {
  LoopCase c;
  const LoopResult near = runLoop(c);
  c.faraway = 100.0;  // 1e5 mm
  const LoopResult far = runLoop(c);
  ASSERT_EQ(near.tool_D.size(), far.tool_D.size());
  double worst = 0.0;
  // Until the first slide: later the loop's own sensitivity to the last bit shows, not the
  // offset's.
  for (std::size_t i = 0; i < 1600; ++i) {
    worst = std::max(worst, (near.tool_D[i] - far.tool_D[i]).norm());
  }
  EXPECT_LE(worst, 1e-9);  // haptics_facts.md §4: 1e-6 mm
  EXPECT_GT(near.stepsInContact, 1000u);
}

TEST(Disturbance, AJumpOfTheDeviceIsStoppedAndTheToolDoesNotFollowAtOnce) {
  class Jumping final : public Hand {
   public:
    HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
      HandTarget out{stylusAtRest(t < 1.5 ? 0.03 : -0.07), 1, true};
      if (t >= 1.5) {
        out.pose_D.q[0] = 0.0;
        out.pose_D.q[1] = 1.0;
        out.pose_D.q[2] = out.pose_D.q[3] = 0.0;
      }
      return out;
    }
  };
  for (const std::string grip : {"stiff", "light"}) {
    LoopCase c;
    c.grip = grip;
    c.hand = std::make_shared<Jumping>();
    c.seconds = 3.0;
    const LoopResult r = runLoop(c);
    const Recomputed m = recompute(r.samples, r.limits.continuousForce);
    EXPECT_LE(m.largestRise, 1.0 + 1e-9);
    EXPECT_LE(m.largestForce, r.limits.peakForce + 1e-9);
    for (std::size_t i = 1; i < r.tool_D.size(); ++i) {
      ASSERT_LE((r.tool_D[i] - r.tool_D[i - 1]).norm(), c.maxTravel + 0.25e-3) << i;
    }
    EXPECT_LT(r.deepest, c.maxTravel + 1e-4);  // no tunnelling
  }
}

TEST(Disturbance, SameSeedSameBits) {
  LoopCase c;
  c.seconds = 3.0;
  const LoopResult a = runLoop(c), b = runLoop(c);
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    ASSERT_EQ(a.samples[i].wrench.force[1], b.samples[i].wrench.force[1]) << i;
    ASSERT_EQ(a.samples[i].device.pose.p[0], b.samples[i].device.pose.p[0]) << i;
    ASSERT_EQ(a.samples[i].handEnergy, b.samples[i].handEnergy) << i;
  }
}

}  // namespace
}  // namespace palpate::stability
