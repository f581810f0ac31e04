#include "core/trade/growth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate {
namespace {

TEST(Growth, FindsThePowerOfAPowerLaw) {
  std::vector<double> x, y;
  for (int i = 1; i <= 6; ++i) {
    x.push_back(i);
    y.push_back(3.0 * std::pow(i, 1.7));
  }
  const Growth growth = fitGrowth("time", "points", x, y);
  EXPECT_NEAR(growth.exponent, 1.7, 1e-12);
  EXPECT_NEAR(growth.low, 1.7, 1e-6);
  EXPECT_NEAR(growth.high, 1.7, 1e-6);
  EXPECT_EQ(growth.points, 6U);
  EXPECT_EQ(growth.what, "time");
}

TEST(Growth, TheConfidenceHoldsTheTruthNineteenTimesInTwenty) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 0.2);
  int held = 0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> x, y;
    for (int i = 1; i <= 5; ++i) {
      x.push_back(std::pow(2.0, i));
      y.push_back(std::pow(x.back(), 0.5) * std::exp(noise(random)));
    }
    const Growth growth = fitGrowth("", "", x, y);
    held += growth.low <= 0.5 && growth.high >= 0.5 ? 1 : 0;
  }
  EXPECT_NEAR(held / static_cast<double>(kTrials), 0.95, 0.015);
}

TEST(Growth, KnowsNothingFromTooFewPoints) {
  EXPECT_TRUE(std::isnan(fitGrowth("", "", {2, 2, 2}, {1, 2, 3}).exponent));
  const Growth two = fitGrowth("", "", {1, 2}, {1, 4});
  EXPECT_NEAR(two.exponent, 2.0, 1e-12);
  EXPECT_TRUE(std::isinf(two.high));
  EXPECT_EQ(fitGrowth("", "", {0, -1, 4}, {1, 1, 1}).points, 1U);
}

}  // namespace
}  // namespace palpate
