#include "core/trade/options.h"

#include <gtest/gtest.h>

#include <set>

namespace palpate {
namespace {

constexpr double kSpacing = 0.5e-3;

bool same(const TradeSetting& a, const TradeSetting& b) {
  const SimulationSetting &x = a.simulation, &y = b.simulation;
  return a.coarsening == b.coarsening && a.doublePrecision == b.doublePrecision &&
         x.tree.branching == y.tree.branching && x.tree.leaf == y.tree.leaf &&
         x.tree.surfaceOnly == y.tree.surfaceOnly && x.query.method == y.query.method &&
         x.query.tightSpheres == y.query.tightSpheres &&
         x.query.oneChildSkip == y.query.oneChildSkip && x.query.sideOffset == y.query.sideOffset &&
         x.query.stopLevel == y.query.stopLevel && x.query.contactBudget == y.query.contactBudget &&
         x.query.threads == y.query.threads && x.query.coherence == y.query.coherence &&
         x.query.perceptualBound == y.query.perceptualBound && x.shellSpacing == y.shellSpacing &&
         x.stepPeriod == y.stepPeriod && x.solverIterations == y.solverIterations;
}

TEST(Options, EveryOptionOfTheIssueIsThere) {
  std::set<std::string> names;
  for (const auto& option : optionsAround({}, kSpacing)) names.insert(option.name);
  EXPECT_EQ(names, (std::set<std::string>{
                       "voxels", "branching", "leaf", "surface-only", "method", "tight-spheres",
                       "one-child-skip", "side-offset", "stop-level", "budget", "perceptual",
                       "shell", "coherence", "iterations", "threads", "rate", "precision"}));
}

TEST(Options, EveryValueChangesTheSettingAndNoTwoAlike) {
  SimulationSetting base;
  const auto singles = singleChanges(base, optionsAround(base, kSpacing));
  EXPECT_EQ(singles.front().name, "default");
  for (std::size_t a = 0; a < singles.size(); ++a) {
    for (std::size_t b = a + 1; b < singles.size(); ++b) {
      EXPECT_FALSE(same(singles[a].setting, singles[b].setting))
          << singles[a].name << " and " << singles[b].name;
    }
  }
}

TEST(Options, TheBasesOwnValueIsNotAChange) {
  SimulationSetting base;
  base.solverIterations = 20;
  base.query.tightSpheres = false;
  base.stepPeriod = 5e-3;
  std::set<std::string> names;
  for (const auto& single : singleChanges(base, optionsAround(base, kSpacing))) {
    names.insert(single.name);
  }
  EXPECT_FALSE(names.contains("iterations=20"));
  EXPECT_TRUE(names.contains("iterations=200"));
  EXPECT_TRUE(names.contains("tight-spheres=on"));
  EXPECT_FALSE(names.contains("rate=200Hz"));
  EXPECT_TRUE(names.contains("rate=1000Hz"));
  EXPECT_TRUE(names.contains("shell=2.00mm"));
}

TEST(Options, ANameListsItsChanges) {
  SimulationSetting base;
  const auto options = optionsAround(base, kSpacing);
  const auto both = settingNamed(base, options, "shell=1.00mm iterations=20");
  ASSERT_TRUE(both);
  EXPECT_EQ(both->simulation.shellSpacing, 1e-3);
  EXPECT_EQ(both->simulation.solverIterations, 20U);
  for (const NamedSetting& single : singleChanges(base, options)) {
    const auto named = settingNamed(base, options, single.name);
    ASSERT_TRUE(named) << single.name;
    EXPECT_TRUE(same(*named, single.setting)) << single.name;
  }
  EXPECT_FALSE(settingNamed(base, options, ""));
  EXPECT_FALSE(settingNamed(base, options, "shell=1.00mm iterations=21"));
}

TEST(Options, PairsAreOfDifferentOptionsAndChangeBoth) {
  SimulationSetting base;
  const auto options = optionsAround(base, kSpacing);
  const auto singles = singleChanges(base, options);
  std::vector<NamedSetting> few;
  for (const auto& single : singles) {
    if (single.name == "leaf=voxel" || single.name == "shell=2.00mm" ||
        single.name == "shell=1.00mm") {
      few.push_back(single);
    }
  }
  const auto pairs = pairedChanges(base, options, few);
  ASSERT_EQ(pairs.size(), 2U);
  for (const auto& pair : pairs) {
    EXPECT_EQ(pair.setting.simulation.tree.leaf, LeafModel::Voxel);
    EXPECT_GT(pair.setting.simulation.shellSpacing, 0.9e-3);
  }
  EXPECT_EQ(pairs[0].name, "leaf=voxel shell=1.00mm");
}

TEST(Options, RandomCombinationsFollowTheSeed) {
  SimulationSetting base;
  const auto options = optionsAround(base, kSpacing);
  const auto once = randomChanges(base, options, 50, 3),
             again = randomChanges(base, options, 50, 3);
  const auto other = randomChanges(base, options, 50, 4);
  ASSERT_EQ(once.size(), 50U);
  std::set<std::string> names;
  for (std::size_t i = 0; i < 50; ++i) {
    EXPECT_EQ(once[i].name, again[i].name);
    EXPECT_TRUE(same(once[i].setting, again[i].setting));
    EXPECT_FALSE(once[i].setting.doublePrecision);
    names.insert(once[i].name);
  }
  EXPECT_NE(once[0].name, other[0].name);
  EXPECT_GT(names.size(), 45U);
}

}  // namespace
}  // namespace palpate
