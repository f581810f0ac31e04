#include "core/trade/errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

Felt steady(std::size_t ticks, const Eigen::Vector3d& force) {
  Felt felt;
  felt.force_W.assign(ticks, force);
  felt.torque_W.assign(ticks, Eigen::Vector3d::Zero());
  felt.tool_W.assign(ticks, Eigen::Vector3d::Zero());
  return felt;
}

Trajectory still(std::size_t ticks) {
  Trajectory path;
  path.samples.resize(ticks);
  path.restFrom = ticks / 2;
  return path;
}

TEST(Spread, ByNearestRank) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Spread spread = spreadOf(values);
  EXPECT_EQ(spread.median, 50.0);
  EXPECT_EQ(spread.p95, 95.0);
  EXPECT_EQ(spread.worst, 100.0);
  EXPECT_EQ(percentile(values, 0.999), 100.0);
  EXPECT_EQ(percentile(values, 0.001), 1.0);
  EXPECT_EQ(spreadOf({}).worst, 0.0);
}

TEST(Errors, AForceThatIsOffIsOffInEveryTick) {
  ErrorSamples samples;
  Felt felt = steady(200, {0, 0, 1.0});
  const Felt reference = steady(200, {0, 0.3, 1.4});
  felt.torque_W.assign(200, Eigen::Vector3d(0, 2e-3, 0));
  samples.addFelt(still(200), felt, reference);
  const TradeErrors errors = samples.errors();
  EXPECT_NEAR(errors.force_N.median, 0.5, 1e-12);
  EXPECT_NEAR(errors.force_N.worst, 0.5, 1e-12);
  EXPECT_NEAR(errors.torque_Nmm.p95, 2.0, 1e-12);
  EXPECT_EQ(errors.onset_ms.worst, 0.0);
  EXPECT_EQ(errors.ripple_N.worst, 0.0);
}

TEST(Errors, FreeMotionDoesNotThinTheErrorsOut) {
  ErrorSamples samples;
  Felt felt = steady(1000, Eigen::Vector3d::Zero());
  for (std::size_t i = 900; i < 1000; ++i) felt.force_W[i].z() = 1.0;
  samples.addFelt(still(1000), felt, steady(1000, Eigen::Vector3d::Zero()));
  EXPECT_NEAR(samples.errors().force_N.median, 1.0, 1e-12);
}

TEST(Errors, OnsetRestRippleAndJumpsAreThoseThatWerePutIn) {
  ErrorSamples samples;
  Felt felt = steady(400, Eigen::Vector3d::Zero()), reference = felt;
  for (std::size_t i = 100; i < 400; ++i) reference.force_W[i].z() = 1.0;
  for (std::size_t i = 107; i < 400; ++i) felt.force_W[i].z() = i % 2 == 0 ? 1.02 : 0.98;
  for (auto& p : felt.tool_W) p.x() = 0.2e-3;
  samples.addFelt(still(400), felt, reference);
  const TradeErrors errors = samples.errors();
  EXPECT_EQ(errors.onset_ms.worst, 7.0);
  EXPECT_NEAR(errors.rest_mm.worst, 0.2, 1e-12);
  EXPECT_NEAR(errors.jump_N_per_ms.median, 0.04, 1e-9);
  EXPECT_NEAR(errors.jump_N_per_ms.worst, 0.98, 1e-9);  // where it sets in
  EXPECT_NEAR(errors.ripple_N.median, 0.02, 2e-3);
}

TEST(Errors, AContactThatNeverComesCountsUntilTheEnd) {
  ErrorSamples samples;
  Felt reference = steady(400, Eigen::Vector3d::Zero());
  for (std::size_t i = 100; i < 400; ++i) reference.force_W[i].z() = 1.0;
  samples.addFelt(still(400), steady(400, Eigen::Vector3d::Zero()), reference);
  EXPECT_EQ(samples.errors().onset_ms.worst, 300.0);
}

TEST(Errors, MotionsWithJumpsAreNotJudgedByRipple) {
  ErrorSamples samples;
  Trajectory path = still(400);
  path.smooth = false;
  Felt felt = steady(400, {0, 0, 1});
  for (std::size_t i = 0; i < 400; i += 2) felt.force_W[i].z() = 2.0;
  samples.addFelt(path, felt, steady(400, {0, 0, 1}));
  EXPECT_EQ(samples.errors().ripple_N.worst, 0.0);
  EXPECT_EQ(samples.errors().jump_N_per_ms.worst, 0.0);
}

}  // namespace
}  // namespace palpate
