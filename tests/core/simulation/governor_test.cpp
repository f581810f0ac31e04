/// The governor's decisions on made-up times, and the ladder it steps on.

#include "core/simulation/governor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace palpate {
namespace {

constexpr double kPeriod = 1e-3;

/// Each level takes half of the one before: 100, 50, 25, 12.5 µs.
std::vector<GovernorLevel> halving(std::size_t count = 4) {
  std::vector<GovernorLevel> levels(count);
  double time = 100.0;
  for (GovernorLevel& level : levels) {
    level.stepP99_us = time;
    time /= 2;
  }
  return levels;
}

struct Change {
  int step = 0;
  std::size_t from = 0, to = 0;
};

/// `load` of a step: 1 takes what the ladder predicts.
struct Driven {
  explicit Driven(const GovernorSettings& settings = {}, std::size_t levels = 4)
      : ladder(halving(levels)), governor(ladder, kPeriod, settings) {}
  void run(int steps, const std::function<double(int)>& load) {
    for (int i = 0; i < steps; ++i, ++step) {
      const std::size_t before = governor.level();
      const std::size_t now = governor.after(load(step) * ladder[before].stepP99_us, kPeriod);
      if (now != before) changes.push_back({step, before, now});
    }
  }
  std::vector<GovernorLevel> ladder;
  Governor governor;
  std::vector<Change> changes;
  int step = 0;
};

std::function<double(int)> always(double load) {
  return [load](int) { return load; };
}

TEST(Governor, StaysAtTheFinestWhileStepsFit) {
  Driven run;
  run.run(20000, always(4.9));  // 490 of 500 µs
  EXPECT_TRUE(run.changes.empty());
}

TEST(Governor, FourTimesTooMuchGoesDownTwoLevelsAtOnceWithinThreeSteps) {
  Driven run;
  run.run(1000, always(1.0));
  run.run(100, always(20.0));  // 2000 µs for 500: a quarter fits 500 but not 0.9 of it
  ASSERT_EQ(run.changes.size(), 1u);
  EXPECT_EQ(run.changes[0].step, 1002);
  EXPECT_EQ(run.changes[0].to, 3u);
  Driven less;
  less.run(100, always(17.0));
  ASSERT_EQ(less.changes.size(), 1u);
  EXPECT_EQ(less.changes[0].to, 2u);
}

TEST(Governor, WhatNoLevelFitsIsDoneAtTheCoarsest) {
  Driven run;
  run.run(2000, always(500.0));
  ASSERT_EQ(run.changes.size(), 1u);
  EXPECT_EQ(run.governor.level(), 3u);
}

TEST(Governor, GoesUpALevelAtATimeAfterAWaitOnceTheLoadIsGone) {
  Driven run;
  run.run(100, always(20.0));
  ASSERT_EQ(run.governor.level(), 3u);
  run.changes.clear();
  run.run(3000, always(1.0));
  ASSERT_EQ(run.changes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(run.changes[i].to, 2 - i);
  EXPECT_GE(run.changes[1].step - run.changes[0].step, 500);
  EXPECT_LE(run.changes[2].step, 100 + 3 * 501);
}

TEST(Governor, OneOrTwoLateStepsAreTheMachines) {
  Driven run;
  run.run(20000, [](int i) { return i % 200 < 2 ? 50.0 : 1.0; });
  EXPECT_TRUE(run.changes.empty());
}

TEST(Governor, LateStepsThatNeverComeTogetherGoDownToo) {
  Driven run;
  run.run(1000, [](int i) { return i % 10 == 0 ? 6.0 : 1.0; });
  ASSERT_EQ(run.changes.size(), 1u);
  EXPECT_EQ(run.changes[0].to, 1u);
  EXPECT_LE(run.changes[0].step, 60);
}

TEST(Governor, ARampGoesDownLevelByLevelAndUpAgain) {
  Driven run;
  run.run(10000, [](int i) { return 1.0 + 29.0 * i / 10000; });
  ASSERT_EQ(run.changes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(run.changes[i].to, i + 1);
  run.changes.clear();
  run.run(10000, [](int i) { return 30.0 - 29.0 * (i - 10000) / 10000; });
  ASSERT_EQ(run.changes.size(), 3u);
  EXPECT_EQ(run.governor.level(), 0u);
}

TEST(Governor, NoConstantLoadMakesItHunt) {
  for (double load = 0.5; load < 50.0; load *= 1.03) {
    Driven run;
    run.run(60000, always(load));
    EXPECT_LE(run.changes.size(), 1u) << load;
  }
}

TEST(Governor, NoisyLoadOnTheBorderDoesNotHunt) {
  constexpr unsigned kSeed = 20240517;
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  // A third of noise either way, and one step in 300 twenty times as long.
  std::uniform_real_distribution<double> noise(0.67, 1.33), hiccup(0.0, 1.0);
  std::size_t most = 0;
  for (double load = 1.0; load < 40.0; load *= 1.05) {
    Driven run;
    run.run(60000,
            [&](int) { return load * noise(random) * (hiccup(random) < 1 / 300.0 ? 20 : 1); });
    most = std::max(most, run.changes.size());
    EXPECT_LE(run.changes.size(), 6u) << load << ": a minute";
  }
  std::printf("most changes in a noisy minute: %zu\n", most);
}

TEST(Governor, ALevelWhoseTimeWasPredictedTooShortIsTriedMoreAndMoreSeldom) {
  // Level 0 really takes twenty times of what level 1 promises.
  Driven run;
  for (int i = 0; i < 300000; ++i, ++run.step) {
    const std::size_t before = run.governor.level();
    const std::size_t now = run.governor.after(before == 0 ? 1000.0 : 50.0, kPeriod);
    if (now != before) run.changes.push_back({run.step, before, now});
  }
  // Five minutes: waits of 0.5, 1, 2, ... 32 s, then 32 s each.
  EXPECT_GE(run.changes.size(), 10u);
  EXPECT_LE(run.changes.size(), 80u);
  std::vector<int> late;
  for (const Change& change : run.changes) {
    if (change.from == 0 && change.step > 150000) late.push_back(change.step);
  }
  EXPECT_LE(late.size(), 5u);
  EXPECT_EQ(run.governor.waitFor(0), 32.0);
}

TEST(Governor, ATapEverySecondSettlesAtTheLevelOfTheTaps) {
  Driven run;
  run.run(120000, [](int i) { return i % 1000 < 300 ? 17.0 : 0.01; });
  std::size_t late = 0;
  for (const Change& change : run.changes) late += change.step > 90000 ? 1 : 0;
  std::printf("changes in 120 taps: %zu, of these in the last 30: %zu\n", run.changes.size(), late);
  EXPECT_LE(late, 6u);
}

TEST(Governor, ALoadThatStaysAwayIsForgotten) {
  Driven run;
  run.run(10000, [](int i) { return i % 1000 < 300 ? 17.0 : 0.01; });
  EXPECT_GT(run.governor.waitFor(1), 0.5);
  run.run(120000, always(1.0));
  EXPECT_EQ(run.governor.level(), 0u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(run.governor.waitFor(i), 0.5);
}

TEST(Governor, TimesThatAreNoneSayNothingAndInfiniteOnesAreLate) {
  Driven run;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(run.governor.after(nan, kPeriod), 0u);
    EXPECT_EQ(run.governor.after(-1.0, kPeriod), 0u);
    EXPECT_EQ(run.governor.after(1e9, nan), 0u);
    EXPECT_EQ(run.governor.after(0.0, kPeriod), 0u);
    EXPECT_EQ(run.governor.after(0.0, 0.0), 0u);
  }
  const double endless = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) (void)run.governor.after(endless, kPeriod);
  EXPECT_EQ(run.governor.level(), 3u);
  for (int i = 0; i < 5000; ++i) (void)run.governor.after(0.0, kPeriod);
  EXPECT_EQ(run.governor.level(), 0u);
}

TEST(Governor, ALadderOfOneLevelIsStayedOn) {
  Driven run({}, 1);
  run.run(1000, always(100.0));
  EXPECT_TRUE(run.changes.empty());
}

TEST(Governor, AnothersChoiceIsTakenOver) {
  Driven run;
  run.governor.moveTo(2);
  EXPECT_EQ(run.governor.level(), 2u);
  run.governor.moveTo(77);
  EXPECT_EQ(run.governor.level(), 3u);
  run.run(3000, always(1.0));
  EXPECT_EQ(run.governor.level(), 0u);
}

TEST(Governor, EqualTimesGiveEqualAnswers) {
  std::mt19937 random(7);
  std::exponential_distribution<double> load(0.2);
  std::vector<double> loads(20000);
  for (double& l : loads) l = load(random);
  const auto play = [&loads] {
    Driven run;
    run.run(static_cast<int>(loads.size()),
            [&loads](int i) { return loads[static_cast<std::size_t>(i)]; });
    std::vector<std::size_t> levels;
    for (const Change& change : run.changes) levels.push_back(change.to);
    return levels;
  };
  EXPECT_EQ(play(), play());
}

MeasuredSetting measuredAs(const std::string& name, double bound, double time, double error) {
  MeasuredSetting m;
  m.name = name;
  m.setting.query.perceptualBound = bound;
  m.stepP99_us = time;
  m.forceErrorP95_N = error;
  m.depthErrorP95_mm = error;
  return m;
}

TEST(Ladder, KeepsTheFrontFinestFirstAndNothingThatCannotChangeWhileItRuns) {
  std::vector<MeasuredSetting> measured{
      measuredAs("far", 3e-3, 20, 0.6),      measuredAs("own", 0, 100, 0.1),
      measuredAs("slower", 1e-4, 110, 0.05), measuredAs("near", 1e-3, 50, 0.2),
      measuredAs("beaten", 1.5e-3, 60, 0.3), measuredAs("hardly", 2e-3, 47, 0.4)};
  MeasuredSetting other = measuredAs("shell", 0, 30, 0.1);
  other.setting.shellSpacing = 2e-3;
  measured.push_back(other);
  other = measuredAs("voxel", 1e-3, 10, 0.1);
  other.setting.tree.leaf =
      other.setting.tree.leaf == LeafModel::Voxel ? LeafModel::Distance : LeafModel::Voxel;
  measured.push_back(other);
  const auto ladder = ladderOf({}, measured);
  ASSERT_EQ(ladder.size(), 3u);
  EXPECT_EQ(ladder[0].name, "own");
  EXPECT_EQ(ladder[1].name, "near");
  EXPECT_EQ(ladder[2].name, "far");
  EXPECT_EQ(ladder[2].perceptualBound, 3e-3);
}

TEST(Ladder, IsMonotoneInTimeAndErrorWhateverWasMeasured) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> time(1, 100), error(0, 1);
  for (int round = 0; round < 200; ++round) {
    std::vector<MeasuredSetting> measured{measuredAs("own", 0, 60, 0.2)};
    for (int i = 1; i < 30; ++i) {
      measured.push_back(measuredAs(std::to_string(i), 1e-4 * i, time(random), error(random)));
    }
    const auto ladder = ladderOf({}, measured);
    EXPECT_LE(ladder.size(), kMostLevels);
    for (std::size_t i = 1; i < ladder.size(); ++i) {
      EXPECT_LT(ladder[i].stepP99_us, ladder[i - 1].stepP99_us);
      EXPECT_GE(ladder[i].forceErrorP95_N, ladder[i - 1].forceErrorP95_N);
      EXPECT_GE(ladder[i].depthErrorP95_mm, ladder[i - 1].depthErrorP95_mm);
    }
  }
}

TEST(Ladder, WithoutTheOwnSettingOrAnythingFasterThereIsNone) {
  const double nan = std::nan("");
  EXPECT_TRUE(ladderOf({}, {}).empty());
  const std::vector<MeasuredSetting> alone{measuredAs("own", 0, 10, 0)};
  EXPECT_TRUE(ladderOf({}, alone).empty());
  const std::vector<MeasuredSetting> notOwn{measuredAs("a", 1e-3, 10, 0),
                                            measuredAs("b", 2e-3, 5, 1)};
  EXPECT_TRUE(ladderOf({}, notOwn).empty());
  const std::vector<MeasuredSetting> broken{
      measuredAs("own", 0, 10, 0), measuredAs("a", 1e-3, nan, 0), measuredAs("b", 1e-3, 0, 0),
      measuredAs("c", 1e-3, 5, nan), measuredAs("d", 1e-3, -5, 0)};
  EXPECT_TRUE(ladderOf({}, broken).empty());
}

}  // namespace
}  // namespace palpate
