/// Demands of two to ten times the peak force: the direction stays, and the force follows the
/// demand again within two ticks of its coming back (haptics_facts.md §4).

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/stability/closed_loop.h"
#include "tests/stability/recompute.h"
#include "tests/stability/test_devices.h"
#include "tests/stability/test_hands.h"

namespace palpate::stability {
namespace {

constexpr double kPeak = 6.0;         // N: Touch X, recommendedLimits()
constexpr double kStiffness = 600.0;  // N/m, its own
constexpr double kDamping = 2.0;
constexpr double kSpeed = 0.3;  // m/s in and out

/// Down to `depth`, `aside` along x for each metre of it; there 0.3 s; back out.
Path pressAndBack(double depth, double aside) {
  return [=](double t) {
    const double in = -0.01 + kSpeed * (t - 0.3);
    const double out = depth - kSpeed * (t - 0.3 - (depth + 0.01) / kSpeed - 0.3);
    const double d = std::max(-0.01, std::min({in, out, depth}));
    PlainPose pose = stylusAtRest(-d);
    pose.p[0] += aside * std::max(0.0, d);
    return pose;
  };
}

LoopResult saturated(double times, double aside, double friction) {
  LoopCase c;
  c.toolFriction = friction;
  c.seconds = 1.6;
  c.wrap = [=](std::unique_ptr<HapticDevice> d) {
    return makePuppet(d->info(), pressAndBack(times * kPeak / kStiffness, aside), 1e-3);
  };
  return runLoop(c);
}

Eigen::Vector3d forceOf(const LoopResult& r, std::size_t i) {
  const double* f = r.samples[i].wrench.force;
  return r.X_WD.linear().transpose() * Eigen::Vector3d(f[0], f[1], f[2]);
}

/// From the device to where the tool was published for this tick.
Eigen::Vector3d demandOf(const LoopResult& r, std::size_t i) {
  const ServoSample& s = r.samples[i];
  const Eigen::Vector3d v =
      r.X_WD.linear().transpose() * Eigen::Vector3d(s.device.v[0], s.device.v[1], s.device.v[2]);
  const Eigen::Vector3d toolV = (r.tool_D[i - 1] - r.tool_D[i - 2]) / 1e-3;
  return kStiffness * (r.tool_D[i - 1] - r.X_WD.inverse() * position(s.device.pose)) +
         kDamping * (toolV - v);
}

TEST(Saturation, KeepsTheDirectionOfTheDemand) {
  for (const double times : {2.0, 5.0, 10.0}) {
    for (const double aside : {0.0, 0.3}) {
      SCOPED_TRACE(testing::Message() << times << " times, aside " << aside);
      const LoopResult r = saturated(times, aside, 1.0);
      std::size_t judged = 0;
      for (std::size_t i = 3; i < r.samples.size(); ++i) {
        const Eigen::Vector3d f = forceOf(r, i), demand = demandOf(r, i);
        if (f.norm() < 0.999 * kPeak || demand.norm() < 1.2 * kPeak) continue;
        const double cosine = f.normalized().dot(demand.normalized());
        EXPECT_GT(cosine, std::cos(std::numbers::pi / 180.0)) << i;
        ++judged;
      }
      EXPECT_GT(judged, 200u);
      const Recomputed m = recompute(r.samples, r.limits.continuousForce);
      EXPECT_LE(m.largestForce, kPeak + 1e-9);
      EXPECT_GE(m.lowestEnergy, -20e-6);
    }
  }
}

TEST(Saturation, FollowsTheDemandWithinTwoTicksOfItsComingBack) {
  for (const double times : {2.0, 3.0}) {  // deeper takes longer than the peak may last
    SCOPED_TRACE(times);
    const LoopResult r = saturated(times, 0.0, 0.0);
    std::size_t below = 0, judged = 0;
    bool was = false;
    for (std::size_t i = 3; i < r.samples.size(); ++i) {
      const double demand = demandOf(r, i).norm();
      was = was || demand > 1.9 * kPeak;
      if (!was || demand > kPeak) {
        below = 0;
        continue;
      }
      if (++below <= 2 || r.samples[i].contacts == 0) continue;
      EXPECT_NEAR(forceOf(r, i).norm(), demand, 0.02 * kPeak) << i;
      ++judged;
    }
    EXPECT_GT(judged, 20u);
  }
}

}  // namespace
}  // namespace palpate::stability
