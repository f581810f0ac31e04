/// Numbers that are none, in closed loop: each field of the device's reading and of the tool's
/// state, once, while a hand presses. What leaves stays finite, the force is zero within the tick,
/// the fault is told, the last good pose is kept.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/stability/closed_loop.h"
#include "tests/stability/recompute.h"
#include "tests/stability/test_devices.h"
#include "tests/stability/test_hands.h"

namespace palpate::stability {
namespace {

constexpr std::uint64_t kWhen = 1800;  // pressed by then

LoopCase pressing() {
  LoopCase c;
  c.model = "premium-6dof";  // torque leaves as well
  c.hand = std::make_shared<PressingHand>(0.03, -0.008);
  c.seconds = 2.2;
  return c;
}

double forceOf(const ServoSample& s) {
  return std::hypot(s.wrench.force[0], s.wrench.force[1], s.wrench.force[2]);
}

void expectFinite(const LoopResult& r) {
  for (const ServoSample& s : r.samples) {
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(std::isfinite(s.wrench.force[i] + s.wrench.torque[i]));
      ASSERT_TRUE(std::isfinite(s.device.pose.p[i] + s.device.v[i] + s.device.w[i]));
    }
    ASSERT_TRUE(isRigid(s.device.pose));
    ASSERT_TRUE(std::isfinite(s.handEnergy));
  }
  for (const Eigen::Vector3d& p : r.tool_D) ASSERT_TRUE(p.allFinite());
  const Recomputed m = recompute(r.samples, r.limits.continuousForce);
  EXPECT_LE(m.largestForce, r.limits.peakForce + 1e-9);
  EXPECT_LE(m.largestTorque, r.limits.peakTorque + 1e-9);
  EXPECT_LE(m.largestRise, r.limits.forceSlew + 1e-9);
}

void expectStopped(const LoopResult& r, SafetyFault fault) {
  ASSERT_GT(forceOf(r.samples[kWhen - 1]), 0.5);
  EXPECT_EQ(forceOf(r.samples[kWhen]), 0.0);
  EXPECT_EQ(r.samples[kWhen].fault, fault);
  EXPECT_EQ(r.samples[kWhen].state, SafetyState::Fault);
}

/// Field 0..12 of a pose and two velocities.
template <class Message>
double& fieldOf(Message& m, int field) {
  if (field < 3) return m.pose.p[field];
  if (field < 7) return m.pose.q[field - 3];
  return field < 10 ? m.v[field - 7] : m.w[field - 10];
}

const double kNone[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(), 1e300};

TEST(BadNumbers, InEachFieldOfTheReadingStopTheForceWithinTheTick) {
  for (int field = 0; field < 13; ++field) {
    for (const double value : kNone) {
      SCOPED_TRACE(testing::Message() << "field " << field << " value " << value);
      LoopCase c = pressing();
      c.wrap = [field, value](std::unique_ptr<HapticDevice> d) {
        return spoiling(std::move(d), kWhen,
                        [field, value](DeviceSample& s) { fieldOf(s, field) = value; });
      };
      const LoopResult r = runLoop(c);
      expectFinite(r);
      expectStopped(r, SafetyFault::InvalidSample);
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(r.samples[kWhen].device.pose.p[i], r.samples[kWhen - 1].device.pose.p[i]);
      }
    }
  }
}

TEST(BadNumbers, AnOrientationThatIsNoneStopsTheForceWithinTheTick) {
  for (const double scale : {0.0, 0.99, 1.01, 2.0}) {
    SCOPED_TRACE(scale);
    LoopCase c = pressing();
    c.wrap = [scale](std::unique_ptr<HapticDevice> d) {
      return spoiling(std::move(d), kWhen, [scale](DeviceSample& s) {
        for (double& q : s.pose.q) q *= scale;
      });
    };
    const LoopResult r = runLoop(c);
    expectFinite(r);
    expectStopped(r, SafetyFault::InvalidSample);
  }
}

TEST(BadNumbers, DenormalsAreNumbers) {
  for (int field = 0; field < 13; ++field) {
    if (field >= 3 && field < 7) continue;  // no unit quaternion has them for certain
    SCOPED_TRACE(field);
    LoopCase c = pressing();
    c.wrap = [field](std::unique_ptr<HapticDevice> d) {
      return spoiling(std::move(d), kWhen, [field](DeviceSample& s) {
        fieldOf(s, field) = std::numeric_limits<double>::denorm_min();
      });
    };
    expectFinite(runLoop(c));
  }
}

TEST(BadNumbers, InEachFieldOfTheToolStopTheForceWithinTheTick) {
  for (int field = 0; field < 13; ++field) {
    for (const double value : kNone) {
      SCOPED_TRACE(testing::Message() << "field " << field << " value " << value);
      LoopCase c = pressing();
      c.meddle = [field, value](std::uint64_t tick, ServoLoop& servo) {
        if (tick != kWhen) return true;
        ToolState bad;
        bad.step = 1000000;
        bad.dueTick = tick;
        bad.contacts = 1;
        fieldOf(bad, field) = value;
        servo.publishTool(bad);
        return true;
      };
      const LoopResult r = runLoop(c);
      expectFinite(r);
      if (std::isfinite(value)) continue;  // too large is clamped
      expectStopped(r, SafetyFault::InvalidWrench);
    }
  }
}

}  // namespace
}  // namespace palpate::stability
