#include "core/trade/promise.h"

#include <gtest/gtest.h>

#include <random>

#include "core/trade/errors.h"

namespace palpate {
namespace {

/// Motions whose values are alike within a motion and differ between motions.
std::vector<std::vector<double>> motions(std::mt19937_64& random, std::size_t count) {
  std::lognormal_distribution<double> level(0.0, 0.6), noise(0.0, 0.1);
  std::vector<std::vector<double>> made(count);
  for (auto& motion : made) {
    const double own = level(random);
    for (int i = 0; i < 50; ++i) motion.push_back(own * noise(random));
  }
  return made;
}

std::vector<double> pooled(const std::vector<std::vector<double>>& motions) {
  std::vector<double> all;
  for (const auto& motion : motions) all.insert(all.end(), motion.begin(), motion.end());
  return all;
}

TEST(Promise, HoldsWithinATenthOverOtherMotionsNineteenTimesInTwenty) {
  std::mt19937_64 random(1);
  int held = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const double promise = boundOf(motions(random, 53), 0.95);
    held += percentile(pooled(motions(random, 53)), 0.95) <= 1.1 * promise ? 1 : 0;
  }
  EXPECT_GE(held, 0.95 * kTrials);
}

TEST(Promise, OfOneMotionIsWhatItMeasured) {
  std::vector<double> values;
  for (int i = 1; i <= 100; ++i) values.push_back(i);
  EXPECT_EQ(boundOf({values}, 0.95), 95.0);
}

TEST(Promise, OfNothingIsNothing) {
  EXPECT_EQ(boundOf({}, 0.95), 0.0);
  EXPECT_EQ(boundOf({{}, {}}, 0.95), 0.0);
}

TEST(Promise, IsTheSameEveryTime) {
  std::mt19937_64 random(2);
  const auto made = motions(random, 20);
  EXPECT_EQ(boundOf(made, 0.95), boundOf(made, 0.95));
  EXPECT_GE(boundOf(made, 0.95), percentile(pooled(made), 0.95));
}

}  // namespace
}  // namespace palpate
