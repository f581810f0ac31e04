#include "core/trade/trajectory.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/geometry/pose.h"

namespace palpate {
namespace {

constexpr double kApproach_s = 1.0, kSlide_s = 2.0;
constexpr double kAbove = 10e-3, kBelow = 1.5e-3, kReach = 8e-3;
constexpr double kPi = std::numbers::pi;
constexpr double kServoPeriod = 1e-3;

/// Where the tip is in D after t seconds.
Eigen::Vector3d tip_D(double t, double heading, double rate) {
  const double down = std::min(t / kApproach_s, 1.0);
  // Half a cosine: at rest at both ends, so that arriving makes no jump of velocity.
  const double eased = 0.5 - 0.5 * std::cos(kPi * down);
  const double y = kAbove - (kAbove + kBelow) * eased;
  // Sums of (1 - cos): the slide, too, begins at rest.
  const double slide = std::max(t - kApproach_s, 0.0);
  const double along = 0.5 * kReach * (1.0 - std::cos(2.0 * kPi * rate * slide));
  const double across = 0.25 * kReach * (1.0 - std::cos(4.0 * kPi * rate * slide));
  return {along * std::cos(heading) - across * std::sin(heading), y,
          along * std::sin(heading) + across * std::cos(heading)};
}

/// Tip first, as the built-in hand holds it: the shaft along +y of D, tilted 30 degrees to +z.
Eigen::Quaterniond grip_D() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(-kPi / 3.0, Eigen::Vector3d::UnitX()));
}

}  // namespace

std::vector<DeviceSample> approachAndSlide(const PreparedScene& scene, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&random] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  const double heading = 2.0 * kPi * uniform();
  const double rate = 0.8 + 0.4 * uniform();
  const double h = scene.scene.setting.stepPeriod;
  const auto ticksPerStep = static_cast<std::uint64_t>(std::llround(h / kServoPeriod));
  const auto steps = static_cast<std::uint64_t>(std::llround((kApproach_s + kSlide_s) / h));
  const Eigen::Quaterniond q_WD(scene.X_WD.linear());
  std::vector<DeviceSample> samples(steps);
  for (std::uint64_t i = 0; i < steps; ++i) {
    DeviceSample& sample = samples[i];
    sample.index = i * ticksPerStep;
    sample.t = static_cast<double>(i) * h;
    const Eigen::Vector3d p = tip_D(sample.t, heading, rate);
    const Eigen::Vector3d v = (tip_D(sample.t + 0.5 * h, heading, rate) -
                               tip_D(std::max(sample.t - 0.5 * h, 0.0), heading, rate)) /
                              h;
    sample.pose = plain(scene.X_WD * p, (q_WD * grip_D()).normalized());
    const Eigen::Vector3d v_W = q_WD * v;
    for (int axis = 0; axis < 3; ++axis) sample.v[axis] = v_W[axis];
  }
  return samples;
}

}  // namespace palpate
