#include "app/trade_memo.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/core/scene/temporary_folder.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

TradeMemo memo() {
  TradeMemo made;
  made.rows = {{"shell=2.00mm", 0.4, 0.3, 5, 20, true}, {"default", 0.1, 0.2, 8, 30, false}};
  made.chosen = "shell=2.00mm";
  return made;
}

TEST(TradeMemo, IsReadAsItWasWritten) {
  const TemporaryFolder folder;
  ASSERT_TRUE(writeTradeMemo(folder.path(), "key", memo()));
  const auto read = readTradeMemo(folder.path(), "key");
  ASSERT_TRUE(read);
  EXPECT_EQ(read->chosen, "shell=2.00mm");
  ASSERT_EQ(read->rows.size(), 2U);
  EXPECT_EQ(read->rows[1].name, "default");
  EXPECT_EQ(read->rows[1].force_N, 0.2);
  EXPECT_EQ(read->rows[1].p999_us, 30);
  EXPECT_TRUE(read->rows[0].onFront);
}

TEST(TradeMemo, OfAnotherKeyOrBrokenIsAsIfThereWereNone) {
  const TemporaryFolder folder;
  EXPECT_FALSE(readTradeMemo(folder.path(), "key"));
  ASSERT_TRUE(writeTradeMemo(folder.path(), "key", memo()));
  EXPECT_FALSE(readTradeMemo(folder.path(), "another"));
  for (const char* broken : {"", "{", "[]", R"({"format":1,"key":"key","chosen":1,"rows":[]})",
                             R"({"format":1,"key":"key","chosen":"a","rows":[{"name":"a"}]})"}) {
    std::ofstream(folder.path() / "trade.cache.json") << broken;
    EXPECT_FALSE(readTradeMemo(folder.path(), "key")) << broken;
  }
}

TEST(TradeMemo, TheKeyIsOfSceneOwnSettingAndDevice) {
  const auto scene = prepared(ball());
  const std::string key = tradeKey(*scene, scene->scene.setting, "touch-x");
  EXPECT_EQ(tradeKey(*prepared(ball()), scene->scene.setting, "touch-x"), key);
  EXPECT_NE(tradeKey(*scene, scene->scene.setting, "touch"), key);
  EXPECT_NE(tradeKey(*prepared(ball(20.0)), scene->scene.setting, "touch-x"), key);
  SimulationSetting other = scene->scene.setting;
  other.solverIterations = 20;
  EXPECT_NE(tradeKey(*scene, other, "touch-x"), key);
  // The setting that was chosen since does not count.
  Scene chosen;
  chosen.setting.solverIterations = 20;
  EXPECT_EQ(tradeKey(*prepared(ball(), chosen), scene->scene.setting, "touch-x"), key);
}

TEST(TradeMemo, ARowNamesItsSetting) {
  const Instrument instrument = datasetInstrument();
  const SimulationSetting own;
  EXPECT_EQ(settingOfRow("iterations=20", own, instrument)->solverIterations, 20U);
  EXPECT_EQ(settingOfRow("shell=1.00mm", own, instrument)->shellSpacing, 1e-3);
  EXPECT_EQ(settingOfRow("default", own, instrument)->solverIterations, own.solverIterations);
  EXPECT_FALSE(settingOfRow("shell=1.01mm", own, instrument));
}

TEST(TradeMemo, GivesAGovernorWhatARunningSceneCanStepDownTo) {
  const auto scene = prepared(ball());
  TradeMemo made;
  made.rows = {{"iterations=20", 0.1, 0.25, 4, 9, true},
               {"shell=2.00mm", 0.4, 0.3, 3, 8, true},
               {"default", 0.1, 0.2, 8, 30, true}};
  const auto with = governed(scene, scene->scene.setting, made);
  ASSERT_EQ(with->levels.size(), 2U);
  EXPECT_EQ(with->levels[0].name, "default");
  EXPECT_EQ(with->levels[1].solverIterations, 20U);
  EXPECT_EQ(with->levels[1].forceErrorP95_N, 0.25);
  EXPECT_TRUE(governed(scene, scene->scene.setting, {})->levels.empty());
}

TEST(TradeMemo, HoldsWhatASceneCanHaveTheFastestFirst) {
  TradeSweep sweep;
  for (int i = 0; i < 3; ++i) {
    TradePoint point;
    point.name = std::to_string(i);
    point.cost.p99_us = 10.0 - i;
    point.promise = {0.1 * i, 0.2 * i, 30.0};
    point.offered = i != 0;
    sweep.points.push_back(point);
  }
  const TradeMemo made = memoOf(sweep, "1");
  ASSERT_EQ(made.rows.size(), 2U);
  EXPECT_EQ(made.rows[0].name, "2");
  EXPECT_EQ(made.rows[0].force_N, 0.2);
  EXPECT_EQ(made.rows[0].depth_mm, 0.4);
  EXPECT_EQ(made.chosen, "1");
}

}  // namespace
}  // namespace palpate
