/// Four times too many contacts: what the governor does about them, and what it costs.

#include <gtest/gtest.h>

#include <time.h>

#include <chrono>
#include <functional>
#include <thread>

#include "tests/core/simulation/dense_plate.h"
#include "tests/core/simulation/tape.h"

namespace palpate {
namespace {

constexpr double kShell = 0.25e-3;  // 4,300 points on the face
constexpr double kDeep = 2e-3;
constexpr double kSeconds = 6.0;

/// The scene, a ladder measured on one hand's samples, and the headroom that makes the pressed
/// plate four times too much.
struct Overload {
  std::shared_ptr<const PreparedScene> own, governed;
  double headroom = 0.0;
};

const Overload& overload() {
  static const Overload made = [] {
    Overload o;
    o.own = plateScene(kShell);
    const auto samples = samplesOf(o.own, 4.0, kDeep, 0.4);
    const auto measured = sweepPlate(o.own, candidates(o.own->scene.setting), samples);
    for (const auto& m : measured) {
      std::printf("measured %-12s %8.1f us (counted), %.3f N, %.3f mm\n", m.name.c_str(),
                  m.stepP99_us, m.forceErrorP95_N, m.depthErrorP95_mm);
    }
    const auto ladder = ladderOf(o.own->scene.setting, measured);
    for (const auto& l : ladder) std::printf("level %s\n", l.name.c_str());
    auto governed = withLevels(*o.own, ladder);
    EXPECT_TRUE(governed) << sentence(governed.error());
    o.governed = *governed;
    o.headroom = ladder.front().stepP99_us / 4.0 / 1000.0;
    return o;
  }();
  return made;
}

Tape governedRun(double phase, RunReport* report = nullptr) {
  Tape tape(10000);  // steps: more than the run has
  RunOptions options;
  options.sink = &tape;
  options.modelledTime = kCounted;
  options.governor.headroom = overload().headroom;
  auto runner = Runner::create(overload().governed,
                               std::make_unique<SprungHand>(kSeconds, kDeep, phase), options);
  EXPECT_TRUE(runner);
  EXPECT_TRUE((*runner)->runVirtual(kSeconds, {}));
  if (report != nullptr) *report = (*runner)->report();
  return tape;
}

/// The same samples and commands once more: coupling forces and depths.
struct Played {
  std::vector<Eigen::Vector3d> force;
  std::vector<double> depth_mm;
  std::uint64_t hash = 0;
};

Played play(const std::shared_ptr<const PreparedScene>& scene, const Tape& tape) {
  const SprungHand hand(kSeconds, kDeep, 0.0);
  Simulation simulation(scene, recommendedGains(hand.info()));
  Played played;
  auto command = tape.commands.begin();
  for (const StepRecord& step : tape.steps) {
    for (; command != tape.commands.end() && command->first <= step.step; ++command) {
      simulation.apply(command->second);
    }
    const StepRecord& again = simulation.step(tape.ticks[step.deviceSample].device);
    played.force.push_back(forceOf(simulation.tool().coupling));
    played.depth_mm.push_back(1e3 * again.depth);
    played.hash = again.stateHash;
  }
  return played;
}

TEST(Overload, FourTimesTooManyContactsFitTheBudgetAfterThreeSteps) {
  RunReport report;
  const Tape tape = governedRun(0.0, &report);
  ASSERT_TRUE(report.governor);
  const GovernorReport& found = *report.governor;
  EXPECT_TRUE(found.governed);
  std::vector<double> after;
  std::size_t over = 0;
  std::uint64_t firstOver = 0, firstDown = 0;
  for (const StepRecord& step : tape.steps) {
    if (counted_us(step) > found.budget_us) {
      ++over;
      if (firstOver == 0) firstOver = step.step;
    }
    if (step.level > 0 && firstDown == 0) firstDown = step.step;
    if (step.level > 0) after.push_back(counted_us(step));
  }
  const double first = counted_us(tape.steps[firstDown - 2]);
  std::printf(
      "budget %.1f us (counted); %.1f us before, p99 %.1f us after; over from step %llu, down at "
      "%llu, %zu of %zu steps over\n",
      found.budget_us, first, percentileOf(after, 0.99), static_cast<unsigned long long>(firstOver),
      static_cast<unsigned long long>(firstDown), over, tape.steps.size());
  for (const LevelChange& c : found.changes) {
    std::printf("  step %llu: level %u to %u after %.0f us\n",
                static_cast<unsigned long long>(c.step), c.from, c.to, c.step_us);
  }
  for (std::size_t i = 0; i < found.secondsAt.size(); ++i) {
    std::printf("  level %zu (%s): %.2f s\n", i, overload().governed->levels[i].name.c_str(),
                found.secondsAt[i]);
  }
  EXPECT_GE(first, 3.8 * found.budget_us) << "the load that was meant";
  EXPECT_EQ(firstDown, firstOver + 3);
  EXPECT_LE(percentileOf(after, 0.99), found.budget_us);
  EXPECT_EQ(over, found.stepsOver);
  EXPECT_LE(over, 20u);
  EXPECT_LE(found.changeCount, 12u);
  double seconds = 0.0;
  for (const double s : found.secondsAt) seconds += s;
  EXPECT_NEAR(seconds, kSeconds, 1e-9);
}

TEST(Overload, EveryChangeIsACommandThatIsToldBeforeItsStep) {
  RunReport report;
  const Tape tape = governedRun(0.0, &report);
  ASSERT_EQ(tape.commands.size(), report.governor->changeCount);
  for (std::size_t i = 0; i < tape.commands.size(); ++i) {
    const auto& [step, command] = tape.commands[i];
    const LevelChange& change = report.governor->changes[i];
    EXPECT_EQ(command.kind, Command::Kind::SetLevel);
    EXPECT_EQ(change.step, step);
    EXPECT_EQ(change.tick, tape.steps[step - 1].deviceSample);
    EXPECT_EQ(change.to, tape.steps[step - 1].level);
    EXPECT_EQ(change.from, tape.steps[step - 2].level);
    EXPECT_EQ(static_cast<double>(change.to), command.value);
  }
  const Played again = play(overload().governed, tape);
  EXPECT_EQ(again.hash, report.stateHash) << "samples and commands are all that decides";
  RunReport second;
  (void)governedRun(0.0, &second);
  EXPECT_EQ(second.stateHash, report.stateHash);
}

TEST(Overload, TheErrorAgainstTheFinestLevelIsAsTheLevelsPredict) {
  // The levels were measured on another path of another run.
  for (const double phase : {0.0, 0.9}) {
    const Tape tape = governedRun(phase);
    const Played governed = play(overload().governed, tape);
    const Played finest = play(overload().own, tape);
    std::vector<double> force, depth;
    std::uint32_t coarsest = 0;
    for (std::size_t i = 0; i < tape.steps.size(); ++i) {
      coarsest = std::max(coarsest, tape.steps[i].level);
      force.push_back((governed.force[i] - finest.force[i]).norm());
      depth.push_back(std::abs(governed.depth_mm[i] - finest.depth_mm[i]));
    }
    const GovernorLevel& level = overload().governed->levels[coarsest];
    std::printf("phase %.1f: force off by %.3f N (p95), predicted %.3f; depth %.4f mm, %.4f\n",
                phase, percentileOf(force, 0.95), level.forceErrorP95_N, percentileOf(depth, 0.95),
                level.depthErrorP95_mm);
    EXPECT_GT(coarsest, 0u);
    EXPECT_LE(percentileOf(force, 0.95), 1.25 * level.forceErrorP95_N);
    EXPECT_LE(percentileOf(depth, 0.95), 1.25 * level.depthErrorP95_mm + 2e-3);
  }
}

TEST(Overload, WithoutModelledTimesTheVirtualClockGovernsNothingAndLevelsChangeNoBit) {
  const auto run = [](const std::shared_ptr<const PreparedScene>& scene) {
    RunOptions options;
    auto runner = Runner::create(scene, std::make_unique<SprungHand>(1.5, kDeep, 0.0), options);
    EXPECT_TRUE((*runner)->runVirtual(1.5, {}));
    return (*runner)->report();
  };
  const RunReport with = run(overload().governed), without = run(overload().own);
  ASSERT_TRUE(with.governor);
  EXPECT_FALSE(with.governor->governed);
  EXPECT_EQ(with.governor->changeCount, 0u);
  EXPECT_FALSE(without.governor);
  EXPECT_EQ(with.stateHash, without.stateHash);
  EXPECT_GT(with.contactsMax, 1000u);
}

/// A machine whose steps take what the work counts for: the loop of pace_test.
struct SlowMachine {
  int faded = 0, faults = 0, slowSteps = 0;
  std::uint64_t steps = 0;
  double lowestEnergy = 0.0, steepest = 0.0;
  std::size_t changes = 0;
};

SlowMachine pressOnASlowMachine(bool governed, double usPerCount) {
  const auto& scene = overload().governed;
  SprungHand hand(kSeconds, kDeep, 0.0);
  ServoSettings settings;
  settings.X_WD = scene->X_WD;
  settings.gains = recommendedGains(hand.info());
  settings.limits = recommendedLimits(hand.info());
  ServoLoop servo(hand, settings);
  Simulation simulation(scene, settings.gains);
  Governor governor(scene->levels, 1e-3);
  SlowMachine run;
  ToolState pending;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  int busyUntil = 0;
  for (int tick = 0; tick < static_cast<int>(1000 * kSeconds); ++tick) {
    const bool free = tick >= busyUntil;
    if (free && pending.step > 0) servo.publishTool(pending);
    const ServoSample s = servo.tick();
    if (free) {
      servo.deviceSamples().refresh();
      if (governed && governor.level() != simulation.level()) {
        simulation.apply({Command::Kind::SetLevel, static_cast<double>(governor.level())});
        ++run.changes;
      }
      const StepRecord& record = simulation.step(servo.deviceSamples().value());
      pending = simulation.tool();
      const double took = usPerCount * counted_us(record);
      busyUntil = tick + std::max(1, static_cast<int>(std::ceil(1e-3 * took)));
      run.slowSteps += busyUntil > tick + 1 ? 1 : 0;
      ++run.steps;
      if (governed) (void)governor.after(took, record.h);
    }
    const Eigen::Vector3d force = forceOf(s.wrench);
    run.steepest = std::max(run.steepest, (force - last).norm());
    last = force;
    run.lowestEnergy = std::min(run.lowestEnergy, s.handEnergy);
    run.faded += tick > 1000 && s.state == SafetyState::Fading ? 1 : 0;
    run.faults += s.fault != SafetyFault::None ? 1 : 0;
  }
  return run;
}

TEST(Overload, ASlowMachineIsBackAtAStepATickAfterAFewSlowSteps) {
  // Half a millisecond is the budget; the pressed plate takes two: four times.
  const double usPerCount = 2000.0 / overload().governed->levels[0].stepP99_us;
  const SlowMachine alone = pressOnASlowMachine(false, usPerCount);
  const SlowMachine run = pressOnASlowMachine(true, usPerCount);
  for (const auto& [name, r] : {std::pair{"alone", alone}, {"governed", run}}) {
    std::printf(
        "%-8s: %llu steps, %d of them slower than a tick, %zu changes, %.3f N/ms at most, "
        "energy %.1f uJ, faded %d\n",
        name, static_cast<unsigned long long>(r.steps), r.slowSteps, r.changes, r.steepest,
        1e6 * r.lowestEnergy, r.faded);
  }
  EXPECT_GT(alone.slowSteps, 1000);
  EXPECT_LE(run.slowSteps, 20);
  EXPECT_GE(run.steps, static_cast<std::uint64_t>(1000 * kSeconds) - 40);
  EXPECT_EQ(run.faded, 0);
  EXPECT_EQ(run.faults, 0);
  EXPECT_GE(run.lowestEnergy, -20e-6);
  EXPECT_LE(run.steepest, 1.0 + 1e-9);
}

/// What the servo's own thread did between its ticks: told on that thread.
class ServoWatch final : public RunSink {
 public:
  ServoWatch() {
    cpu_us.reserve(10000);
    steps.reserve(10000);
  }
  bool onTick(const ServoSample&) noexcept override {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    const double us =
        1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
    if (last_ > 0.0 && cpu_us.size() < cpu_us.capacity()) cpu_us.push_back(us - last_);
    last_ = us;
    return true;
  }
  bool onStep(const StepRecord& step) noexcept override {
    if (steps.size() < steps.capacity()) steps.push_back(step);
    return true;
  }
  bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }
  std::vector<double> cpu_us;  ///< Processor time from one tick to the next.
  std::vector<StepRecord> steps;

 private:
  double last_ = 0.0;
};

/// On the real clock, with real times. @param deep  < 0: in the air.
RunReport realRun(const std::shared_ptr<const PreparedScene>& scene, double headroom, double deep,
                  const char* name) {
  ServoWatch watch;
  RunOptions options;
  options.clock = Clock::Real;
  options.sink = &watch;
  options.governor.headroom = headroom;
  auto runner = Runner::create(scene, std::make_unique<SprungHand>(kSeconds, deep, 0.0), options);
  EXPECT_TRUE(runner);
  EXPECT_TRUE((*runner)->start());
  std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  (*runner)->stop();
  const RunReport report = (*runner)->report();
  std::vector<double> pressed;
  for (const StepRecord& step : watch.steps) {
    if (step.contacts > 0) pressed.push_back(step.micros);
  }
  // The last half second: the governor has settled.
  const auto tail = static_cast<std::ptrdiff_t>(std::min<std::size_t>(pressed.size(), 500));
  const std::vector<double> settled(pressed.end() - tail, pressed.end());
  const auto ours = std::count_if(watch.cpu_us.begin(), watch.cpu_us.end(),
                                  [](double us) { return us > 1000.0; });
  std::printf(
      "%-10s: %llu ticks, %llu missed, %llu late; the servo's own time from tick to tick p50 %.0f, "
      "p99 %.0f us, over a period %lld times; %llu steps; in contact p50 %.0f, p99 %.0f us in the "
      "last half second, budget %.0f; level %zu after %llu changes\n",
      name, static_cast<unsigned long long>(report.ticks),
      static_cast<unsigned long long>(report.ticksMissed),
      static_cast<unsigned long long>(report.ticksLate), percentileOf(watch.cpu_us, 0.5),
      percentileOf(watch.cpu_us, 0.99), static_cast<long long>(ours),
      static_cast<unsigned long long>(report.steps), percentileOf(settled, 0.5),
      percentileOf(settled, 0.99), 1000.0 * headroom, report.governor ? report.governor->level : 0,
      report.governor ? static_cast<unsigned long long>(report.governor->changeCount) : 0ULL);
  // Processor time, not wall time: a busy machine does not add to it, though a virtual one may book
  // what it stole, so that single ticks are not judged. A tick whose own work fits its period never
  // makes the next one late, and it waits for nothing (real_time_guard_test): what is missed all
  // the same is the machine's, as in the run that touches nothing.
  EXPECT_LT(percentileOf(watch.cpu_us, 0.99), 1000.0) << name;
  return report;
}

TEST(Overload, OnTheRealClockTheServosOwnWorkFitsItsPeriodUnderAnyLoadOfTheStep) {
  // As measured here and now: the plate pressed at the finest level is four times the budget.
  const auto samples = samplesOf(overload().own, 1.1, kDeep, 0.0);
  Simulation simulation(overload().own, CouplingGains{});
  std::vector<double> times;
  for (const DeviceSample& sample : samples) {
    const StepRecord& record = simulation.step(sample);
    if (record.contacts > 1000) times.push_back(record.micros);
  }
  ASSERT_GT(times.size(), 100u);
  const double headroom = percentileOf(times, 0.5) / 4.0 / 1000.0;
  (void)realRun(overload().own, headroom, -1e-3, "in the air");
  (void)realRun(overload().own, headroom, kDeep, "ungoverned");
  const RunReport governed = realRun(overload().governed, headroom, kDeep, "governed");
  ASSERT_TRUE(governed.governor);
  EXPECT_TRUE(governed.governor->governed);
  EXPECT_GE(governed.governor->changeCount, 1u)
      << "a busy machine makes steps slower, never faster";
  // No hunting, however noisy the machine: each failed trial doubles its wait.
  EXPECT_LE(governed.governor->changeCount, 20u);
}

/// Coarser than any front would have them.
std::shared_ptr<const PreparedScene> withCrudeLevels(const PreparedScene& scene) {
  const SimulationSetting& own = scene.scene.setting;
  std::vector<GovernorLevel> levels(5);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    levels[i].name = "crude " + std::to_string(i);
    levels[i].solverIterations = own.solverIterations;
    levels[i].stepP99_us = 100.0 / static_cast<double>(i + 1);
  }
  levels[1].perceptualBound = 4e-3;
  levels[2].contactBudget = 1;
  levels[3].stopLevel = 2;
  levels[4].perceptualBound = 4e-3;
  levels[4].solverIterations = 1;
  auto made = withLevels(scene, levels);
  EXPECT_TRUE(made) << sentence(made.error());
  return *made;
}

struct Felt {
  double steepest = 0.0, greatest = 0.0, lowestEnergy = 0.0;
  std::size_t changes = 0;
  int faults = 0;
};

/// Pressed hard and slid, the level chosen before each step from the tick and the force.
Felt feel(const std::shared_ptr<const PreparedScene>& scene, double slew,
          const std::function<std::size_t(int tick, double force)>& levelAt) {
  constexpr double kPressed = 5.0;
  SprungHand hand(kPressed, 12e-3, 0.0);
  ServoSettings settings;
  settings.X_WD = scene->X_WD;
  settings.gains = recommendedGains(hand.info());
  settings.limits = recommendedLimits(hand.info());
  settings.limits.forceSlew = slew;
  ServoLoop servo(hand, settings);
  Simulation simulation(scene, settings.gains);
  Felt felt;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (int tick = 0; tick < static_cast<int>(1000 * kPressed); ++tick) {
    const ServoSample s = servo.tick();
    servo.deviceSamples().refresh();
    const std::size_t level = levelAt(tick, last.norm());
    felt.changes += level != simulation.level() ? 1 : 0;
    simulation.apply({Command::Kind::SetLevel, static_cast<double>(level)});
    (void)simulation.step(servo.deviceSamples().value());
    servo.publishTool(simulation.tool());
    const Eigen::Vector3d force = forceOf(s.wrench);
    felt.steepest = std::max(felt.steepest, (force - last).norm());
    felt.greatest = std::max(felt.greatest, force.norm());
    felt.lowestEnergy = std::min(felt.lowestEnergy, s.handEnergy);
    felt.faults += s.fault != SafetyFault::None ? 1 : 0;
    last = force;
  }
  return felt;
}

TEST(LevelChange, MakesNoJumpOfForceEvenAtTheWorstMomentsAndWithoutTheSlewLimit) {
  constexpr double kNoLimit = 1e9;
  const auto scene = withCrudeLevels(*plateScene(0.4e-3));
  const Felt still = feel(scene, 1.0, [](int, double) { return std::size_t{0}; });
  std::printf("never      : %.3f N/ms at most, to %.2f N\n", still.steepest, still.greatest);
  EXPECT_GT(still.greatest, 2.0);
  double steepest = 0.0;
  for (std::size_t level = 1; level < scene->levels.size(); ++level) {
    const auto check = [&](const char* what,
                           const std::function<std::size_t(int, double)>& levelAt) {
      // What the change itself does; the limit comes on top, below.
      const Felt felt = feel(scene, kNoLimit, levelAt);
      std::printf("level %zu, %-12s: %.3f N/ms at most, %zu changes, energy %.1f uJ\n", level, what,
                  felt.steepest, felt.changes, 1e6 * felt.lowestEnergy);
      EXPECT_LE(felt.steepest, still.steepest + 0.5);
      EXPECT_LE(felt.steepest, 1.0);
      EXPECT_EQ(felt.faults, 0);
      EXPECT_GE(felt.lowestEnergy, -20e-6);
      EXPECT_GT(felt.changes, 5u);
      steepest = std::max(steepest, felt.steepest);
    };
    check("every ms", [level](int tick, double) { return tick % 2 == 0 ? level : 0; });
    check("every 7 ms", [level](int tick, double) { return tick / 7 % 2 == 0 ? level : 0; });
    check("every 90 ms", [level](int tick, double) { return tick / 90 % 2 == 0 ? level : 0; });
    // Coarse until the force has built up, then fine, and so on: at the greatest forces.
    std::size_t now = 0;
    int since = 0;
    check("at the peaks", [&, level](int tick, double force) {
      if (tick == 0) now = since = 0;
      if (force > 2.0 && tick > since + 40) {
        now = now == 0 ? level : 0;
        since = tick;
      }
      return now;
    });
  }
  std::printf("a change makes at most %.3f N/ms more than none\n", steepest - still.steepest);
  const Felt limited =
      feel(scene, 1.0, [](int tick, double) { return std::size_t(tick % 2 == 0 ? 1 : 0); });
  EXPECT_LE(limited.steepest, 1.0) << "what leaves the program";
}

}  // namespace
}  // namespace palpate
