#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <thread>

#include "core/simulation/runner.h"
#include "core/simulation/simulation.h"
#include "tests/core/simulation/synthetic_scene.h"
#include "tests/core/simulation/tape.h"

namespace palpate {
namespace {

RunReport virtualRun(const std::shared_ptr<const PreparedScene>& scene, std::uint64_t seed,
                     double seconds, RunSink* sink = nullptr) {
  RunOptions options;
  options.seed = seed;
  options.sink = sink;
  auto runner = makeRunner(scene, options);
  const auto ran = runner->runVirtual(seconds, {});
  EXPECT_TRUE(ran);
  return runner->report();
}

TEST(VirtualRun, TheBuiltInHandFindsTheAnatomyAndFeelsIt) {
  const auto scene = prepared(ball());
  Tape tape(10000);
  const RunReport report = virtualRun(scene, 1, 6.0, &tape);
  RecordProperty("steps", static_cast<int>(report.steps));
  EXPECT_EQ(report.ticks, 6000U);
  EXPECT_EQ(report.steps, 6000U);
  EXPECT_GT(report.contactsMax, 0U);
  EXPECT_GT(report.forceMax, 0.5);         // it presses to about 1 N
  EXPECT_LT(report.forceMax, 6.0);         // the clamp of this device
  EXPECT_LT(report.penetrationMax, 1e-3);  // one voxel
  EXPECT_GT(report.penetrationMax, 0.0);
  EXPECT_GT(report.handEnergy, -20e-6);
  bool armed = false;
  for (const auto& tick : tape.ticks) {
    armed = armed || tick.state == SafetyState::Armed;
    EXPECT_EQ(tick.fault, SafetyFault::None);
  }
  EXPECT_TRUE(armed);
}

TEST(VirtualRun, SameSeedSameBits) {
  const auto scene = prepared(ball());
  const RunReport first = virtualRun(scene, 7, 4.0);
  const RunReport second = virtualRun(scene, 7, 4.0);
  EXPECT_EQ(first.stateHash, second.stateHash);
  EXPECT_EQ(first.forceMax, second.forceMax);
  EXPECT_NE(first.stateHash, virtualRun(scene, 8, 4.0).stateHash);
}

TEST(VirtualRun, RunningInPiecesChangesNothing) {
  const auto scene = prepared(ball());
  const RunReport whole = virtualRun(scene, 7, 3.0);
  RunOptions options;
  options.seed = 7;
  auto runner = makeRunner(scene, options);
  for (int piece = 0; piece < 3; ++piece) ASSERT_TRUE(runner->runVirtual(1.0, {}));
  EXPECT_EQ(runner->report().stateHash, whole.stateHash);
}

TEST(VirtualRun, TheSecondSceneOfTheSameMakingGivesTheSameBits) {
  EXPECT_EQ(virtualRun(prepared(ball()), 3, 2.0).stateHash,
            virtualRun(prepared(ball()), 3, 2.0).stateHash);
}

TEST(VirtualRun, ExactOptionsDoNotChangeTheBits) {
  const RunReport base = virtualRun(prepared(ball()), 5, 4.0);
  ASSERT_GT(base.contactsMax, 0U);
  for (const Branching branching : {Branching::Children8, Branching::Children512}) {
    Scene scene;
    scene.setting.tree.branching = branching;
    EXPECT_EQ(virtualRun(prepared(ball(), scene), 5, 4.0).stateHash, base.stateHash);
  }
  for (const QueryMethod method : {QueryMethod::Paper, QueryMethod::BruteForce}) {
    Scene scene;
    scene.setting.query.method = method;
    EXPECT_EQ(virtualRun(prepared(ball(), scene), 5, 4.0).stateHash, base.stateHash);
  }
}

TEST(VirtualRun, EachStepUsesTheSampleItNamesAndTheServoTheStepItNames) {
  Scene scene;
  scene.setting.stepPeriod = 2e-3;
  Tape tape(3000);
  const RunReport report = virtualRun(prepared(ball(), scene), 2, 2.0, &tape);
  EXPECT_EQ(report.ticks, 2000U);
  ASSERT_EQ(tape.steps.size(), 1000U);
  for (std::size_t i = 0; i < tape.steps.size(); ++i) {
    EXPECT_EQ(tape.steps[i].step, i + 1);
    EXPECT_EQ(tape.steps[i].deviceSample, 2 * i);
  }
  for (std::size_t i = 1; i < tape.ticks.size(); ++i) {
    EXPECT_EQ(tape.ticks[i].toolStep, (i + 1) / 2);
  }
}

TEST(VirtualRun, TheToolStaysWhereTheHandIsInFreeSpace) {
  Tape tape(400);
  virtualRun(prepared(ball()), 2, 0.3, &tape);
  for (std::size_t i = 50; i < tape.steps.size(); ++i) {
    ASSERT_EQ(tape.steps[i].contacts, 0U);
    const auto& device = tape.ticks[i].device;
    EXPECT_LT((position(tape.steps[i].tool) - position(device.pose)).norm(), 1.5e-3);
  }
}

TEST(VirtualRun, CommandsActBetweenStepsAndAreToldInOrder) {
  Tape tape(2000);
  tape.commands.reserve(8);
  RunOptions options;
  options.sink = &tape;
  const auto scene = prepared(ball());
  auto runner = makeRunner(scene, options);
  ASSERT_TRUE(runner->runVirtual(0.5, {}));
  ASSERT_TRUE(runner->send({Command::Kind::SetSolverIterations, 50}));
  ASSERT_TRUE(runner->send({Command::Kind::ResetTool, 0}));
  ASSERT_TRUE(runner->runVirtual(0.1, {}));
  ASSERT_EQ(tape.commands.size(), 2U);
  EXPECT_EQ(tape.commands[0].first, 501U);
  EXPECT_EQ(tape.commands[0].second.kind, Command::Kind::SetSolverIterations);
  EXPECT_EQ(tape.commands[1].second.kind, Command::Kind::ResetTool);
  EXPECT_EQ(tape.steps.back().commandCount, 2U);
  // A reset puts the tool at rest where the device is, so its force is that of one step.
  const auto& after = tape.steps[500];
  EXPECT_LT((position(after.tool) - position(tape.ticks[500].device.pose)).norm(), 1e-4);
}

TEST(VirtualRun, AFullCommandQueueRefuses) {
  const auto scene = prepared(ball());
  auto runner = makeRunner(scene, {});
  int taken = 0;
  while (runner->send({Command::Kind::SetFriction, 1}) && taken < 100000) ++taken;
  EXPECT_GE(taken, 256);
  EXPECT_LT(taken, 1024);
  ASSERT_TRUE(runner->runVirtual(0.01, {}));
  EXPECT_TRUE(runner->send({Command::Kind::SetFriction, 1}));
}

TEST(VirtualRun, SnapshotsShowContactsInTheWorld) {
  const auto scene = prepared(ball());
  auto runner = makeRunner(scene, {});
  const auto centre =
      scene->labels->geometry.X_PV * scene->labels->geometry.centre_V(31.5, 31.5, 31.5);
  std::size_t seen = 0;
  for (int i = 0; i < 600; ++i) {
    ASSERT_TRUE(runner->runVirtual(0.008, {}));
    if (!runner->snapshots().refresh()) continue;
    const Snapshot& snapshot = runner->snapshots().value();
    EXPECT_EQ(snapshot.contactsDrawn, snapshot.contacts);
    EXPECT_LT((position(snapshot.tool) - position(snapshot.device)).norm(), 20e-3);
    for (std::uint32_t c = 0; c < snapshot.contactsDrawn; ++c) {
      const Eigen::Vector3d p(snapshot.contact_W[c].p[0], snapshot.contact_W[c].p[1],
                              snapshot.contact_W[c].p[2]);
      const Eigen::Vector3d n(snapshot.contact_W[c].n[0], snapshot.contact_W[c].n[1],
                              snapshot.contact_W[c].n[2]);
      // On the ball, to the width of a voxel; the stairs of its voxels tilt the normal.
      EXPECT_NEAR((p - centre).norm(), 24e-3, 1.5e-3);
      EXPECT_GT(n.dot((p - centre).normalized()), 0.75);
      ++seen;
    }
  }
  EXPECT_GT(seen, 0U);
}

TEST(VirtualRun, CancelStopsItAndSaysSo) {
  const auto scene = prepared(ball());
  auto runner = makeRunner(scene, {});
  CancelToken cancel;
  cancel.cancel();
  Progress progress;
  progress.cancel = &cancel;
  const auto ran = runner->runVirtual(1.0, progress);
  ASSERT_FALSE(ran);
  EXPECT_EQ(ran.error().kind, ErrorKind::Cancelled);
}

TEST(VirtualRun, ClocksAreNotMixedUp) {
  const auto scene = prepared(ball());
  RunOptions options;
  auto virtualRunner = makeRunner(scene, options);
  EXPECT_EQ(virtualRunner->start().error().kind, ErrorKind::Usage);
  options.clock = Clock::Real;
  auto realRunner = makeRunner(scene, options);
  EXPECT_EQ(realRunner->runVirtual(1.0, {}).error().kind, ErrorKind::Usage);
}

TEST(RealRun, BothThreadsRunAndStop) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.clock = Clock::Real;
  auto runner = makeRunner(scene, options);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_TRUE(runner->start());
  std::size_t snapshots = 0;
  const auto until = start + std::chrono::milliseconds(1500);
  while (std::chrono::steady_clock::now() < until) {
    if (runner->snapshots().refresh()) ++snapshots;
    (void)runner->send({Command::Kind::SetFriction, 1});
    (void)runner->report();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  runner->setEnabled(true);
  runner->forceOff();
  runner->clearFault();
  runner->stop();
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - start;
  const RunReport report = runner->report();
  EXPECT_GT(report.ticks, 100U);
  EXPECT_GT(report.steps, 100U);
  EXPECT_LE(report.steps, report.ticks);
  EXPECT_GT(snapshots, 10U);
  // Every period is either ticked or counted as missed; a busy machine may start the thread late.
  EXPECT_LE(static_cast<double>(report.ticks + report.ticksMissed), passed.count() + 2.0);
  EXPECT_GE(static_cast<double>(report.ticks + report.ticksMissed), 0.5 * passed.count());
  EXPECT_TRUE(report.realTimePriority || !report.realTimeNote.empty());
  EXPECT_GT(report.lateness.max, 0.0);
  EXPECT_EQ(report.ticks, runner->report().ticks);  // nothing runs any more
}

/// A device whose own scheduler calls the tick, as a vendor's library does.
class SchedulingDevice final : public HapticDevice {
 public:
  SchedulingDevice() { info_.name = "Scheduling device"; }
  ~SchedulingDevice() override { stopServo(); }
  const DeviceInfo& info() const noexcept override { return info_; }
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  DeviceSample read(std::uint64_t) noexcept override {
    EXPECT_EQ(std::this_thread::get_id(), scheduler_.get_id());
    DeviceSample sample;
    sample.pose = stylusAtRest(0.04);
    return sample;
  }
  void write(const Wrench&) noexcept override {
    EXPECT_EQ(std::this_thread::get_id(), scheduler_.get_id());
  }
  bool ownsClock() const noexcept override { return true; }
  Result<void> startServo(void (*tick)(void*) noexcept, void* owner) override {
    if (refuses) return fail(machineError("The scheduler does not start."));
    stop_ = false;
    std::promise<void> ready;
    scheduler_ = std::thread([this, tick, owner, started = ready.get_future()]() mutable {
      started.wait();  // until scheduler_ can be compared with
      while (!stop_) {
        tick(owner);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    ready.set_value();
    return {};
  }
  void stopServo() noexcept override {
    stop_ = true;
    if (scheduler_.joinable()) scheduler_.join();
  }
  bool refuses = false;

 private:
  DeviceInfo info_;
  std::thread scheduler_;
  std::atomic<bool> stop_{false};
};

TEST(RealRun, ADeviceWithAClockOfItsOwnCallsTheTick) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.clock = Clock::Real;
  auto runner = Runner::create(scene, std::make_unique<SchedulingDevice>(), options);
  ASSERT_TRUE(runner);
  ASSERT_TRUE((*runner)->start());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  (*runner)->stop();
  EXPECT_GT((*runner)->report().ticks, 20U);
  EXPECT_GT((*runner)->report().steps, 10U);
}

TEST(RealRun, ASchedulerThatDoesNotStartIsSaidAndLeavesNoThread) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.clock = Clock::Real;
  auto device = std::make_unique<SchedulingDevice>();
  device->refuses = true;
  auto runner = Runner::create(scene, std::move(device), options);
  ASSERT_TRUE(runner);
  const auto started = (*runner)->start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message, "The scheduler does not start.");
  EXPECT_EQ((*runner)->report().ticks, 0U);
}

TEST(Runner, WhatADeviceCannotDoIsRefused) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.latchEnabled = true;
  const auto latched = Runner::create(scene, std::make_unique<SchedulingDevice>(), options);
  ASSERT_FALSE(latched);
  EXPECT_EQ(sentence(latched.error()),
            "Hold-to-enable may be a latch only on a simulated device. Found: Scheduling device. "
            "Hold the stylus' button to feel force.");
  options.latchEnabled = false;
  auto runner = Runner::create(scene, std::make_unique<SchedulingDevice>(), options);
  ASSERT_TRUE(runner);
  EXPECT_EQ((*runner)->runVirtual(1.0, {}).error().message,
            "This device keeps its own time: run it in the real clock.");
}

TEST(RealRun, StartsAgainAfterAStop) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.clock = Clock::Real;
  auto runner = makeRunner(scene, options);
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(runner->start());
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    runner->stop();
  }
  EXPECT_GT(runner->report().ticks, 10U);
}

}  // namespace
}  // namespace palpate
