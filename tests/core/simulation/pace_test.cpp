/// Steps that follow the machine: how long they are, and what the coupling does about it.

#include <gtest/gtest.h>

#include <cmath>

#include "core/devices/simulated_phantom.h"
#include "core/simulation/simulation.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

DeviceSample still(const PreparedScene& scene, std::uint64_t index) {
  DeviceSample sample;
  sample.index = index;
  sample.pose = plain(scene.X_WD * Eigen::Translation3d(0, 0.04, 0));
  return sample;
}

TEST(Pace, AStepIsAsLongAsItsSamplesAreApartAndAtMostTenTicks) {
  const auto scene = prepared(ball());
  Simulation simulation(scene, CouplingGains{});
  auto snapshot = std::make_unique<Snapshot>();
  std::uint64_t index = 0;
  for (const auto& [apart, expected] : {std::pair{1, 1e-3}, {4, 4e-3}, {10, 10e-3}, {50, 10e-3}}) {
    index += static_cast<std::uint64_t>(apart);
    (void)simulation.step(still(*scene, index));
    simulation.fill(*snapshot);
    EXPECT_DOUBLE_EQ(snapshot->stepPeriod, expected) << apart;
    EXPECT_EQ(simulation.tool().dueTick - index, std::lround(expected * 1e3));
  }
  EXPECT_EQ(simulation.tool().paceTicks, 10u);
}

TEST(Pace, TheCouplingGivesWayToSlowStepsAndComesBackWithinTwoSeconds) {
  const auto scene = prepared(ball());
  const CouplingGains gains{600.0, 2.0, 0.24, 8e-4};
  Simulation simulation(scene, gains);
  std::uint64_t index = 0;
  double last = 600.0;
  for (int i = 0; i < 10; ++i) {
    (void)simulation.step(still(*scene, index += 10));
    const double now = simulation.coupling().stiffness;
    EXPECT_LE(now, last);
    last = now;
  }
  EXPECT_NEAR(last, stiffestFor(10e-3), 1e-9);
  EXPECT_NEAR(simulation.tool().stiffnessShare, stiffestFor(10e-3) / 600.0, 1e-12);
  EXPECT_EQ(simulation.coupling().damping, 2.0);
  for (int i = 0; i < 2000; ++i) {
    (void)simulation.step(still(*scene, ++index));
    const double now = simulation.coupling().stiffness;
    EXPECT_GE(now, last - 1e-9);
    EXPECT_LE(now - last, 0.6 + 1e-9) << "a thousandth a tick: no step in the force";
    last = now;
  }
  EXPECT_EQ(last, 600.0);
  EXPECT_EQ(simulation.tool().paceTicks, 1u);
}

TEST(Pace, TheUsersShareIsKeptWithinWhatIsMeasured) {
  const auto scene = prepared(ball());
  Simulation simulation(scene, CouplingGains{600.0, 2.0, 0.24, 8e-4});
  std::uint64_t index = 0;
  const auto after = [&](double share) {
    simulation.apply({Command::Kind::SetCoupling, share});
    for (int i = 0; i < 1500; ++i) (void)simulation.step(still(*scene, ++index));
    return simulation.coupling().stiffness;
  };
  EXPECT_NEAR(after(0.5), 300.0, 1e-9);
  EXPECT_NEAR(after(7.0), 600.0, 1e-9);
  EXPECT_NEAR(after(0.0), 60.0, 1e-9);
  EXPECT_NEAR(after(std::nan("")), 60.0, 1e-9);
}

/// A hand that goes down and presses; the machine needs `ticks` servo periods for each step
/// although the scene declares one.
struct SlowRun {
  double roughest = 0.0, lowestEnergy = 0.0, steady = 0.0;
  int faded = 0, faults = 0;
};

SlowRun runSlowly(int ticks) {
  const auto scene = prepared(ball());
  auto device = searchingDevice(3);
  EXPECT_TRUE(device->open());
  ServoSettings settings;
  settings.X_WD = scene->X_WD;
  settings.gains = recommendedGains(device->info(), 1e-3);
  settings.limits = recommendedLimits(device->info());
  ServoLoop servo(*device, settings);
  Simulation simulation(scene, settings.gains);
  SlowRun run;
  Wrench last;
  double window = 0.0;
  std::vector<double> changes;
  ToolState pending;
  for (int tick = 0; tick < 8000; ++tick) {
    if (tick % ticks == 0) {  // the result of the last step comes with the start of the next
      if (pending.step > 0) servo.publishTool(pending);
      servo.deviceSamples().refresh();
    }
    const ServoSample s = servo.tick();
    if (tick % ticks == 0) {
      servo.deviceSamples().refresh();
      (void)simulation.step(servo.deviceSamples().value());
      pending = simulation.tool();
    }
    run.lowestEnergy = std::min(run.lowestEnergy, s.handEnergy);
    if (tick > 1500 && s.state == SafetyState::Fading) ++run.faded;
    if (s.fault != SafetyFault::None) ++run.faults;
    const double* f = s.wrench.force;
    changes.push_back(std::hypot(f[0] - last.force[0], f[1] - last.force[1], f[2] - last.force[2]));
    window += changes.back() - (changes.size() > 200 ? changes[changes.size() - 201] : 0.0);
    if (tick > 1500) run.roughest = std::max(run.roughest, window / 200.0);
    run.steady = std::max(run.steady, std::hypot(f[0], f[1], f[2]));
    last = s.wrench;
  }
  return run;
}

TEST(Pace, AMachineThatNeedsUpToTenTicksAStepDoesNotBuzzAndDoesNotFade) {
  // What a millimetre's voxels make of sliding is there at a step a tick, too; a limit cycle would
  // make 0.3 N/ms and more.
  const double texture = runSlowly(1).roughest;
  EXPECT_LE(texture, 0.08);
  for (const int ticks : {2, 4, 6, 8, 10}) {
    const SlowRun run = runSlowly(ticks);
    std::printf("a step in %2d ms: force to %.2f N, roughest %.3f N/ms, energy %.1f uJ, faded %d\n",
                ticks, run.steady, run.roughest, run.lowestEnergy * 1e6, run.faded);
    EXPECT_EQ(run.faded, 0) << ticks;
    EXPECT_EQ(run.faults, 0) << ticks;
    EXPECT_GT(run.steady, 0.5) << ticks;
    EXPECT_LE(run.roughest, 1.5 * texture) << ticks;
    EXPECT_GE(run.lowestEnergy, -20e-6) << ticks;
  }
}

TEST(Pace, BelowAHundredStepsASecondTheForceFades) {
  const SlowRun run = runSlowly(60);
  EXPECT_GT(run.faded, 1000);
  EXPECT_GE(run.lowestEnergy, -20e-6);
}

}  // namespace
}  // namespace palpate
