#include "core/voxels/clearance_word.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace palpate {
namespace {

constexpr std::uint32_t kSeed = 313;
constexpr float kSteps[] = {ClearanceWord::kCoarseSteps, ClearanceWord::kBlockSteps,
                            ClearanceWord::kBrickSteps};

TEST(ClearanceWord, SlopesAreRoundedTowardsZero) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<float, 3> g{uniform(rng), uniform(rng), uniform(rng)};
    if (trial % 10 == 0)
      g[static_cast<std::size_t>(trial / 10 % 3)] = trial % 20 == 0 ? 1.0f : -1.0f;
    const auto q = ClearanceWord::slopesOf(g);
    for (std::size_t a = 0; a < 3; ++a) {
      const double stored = q[a] / 63.0;
      EXPECT_LE(std::abs(stored), std::abs(static_cast<double>(g[a])) + 1e-7);
      EXPECT_LT(std::abs(stored - static_cast<double>(g[a])), 1 / 63.0 + 1e-7);
      EXPECT_GE(stored * static_cast<double>(g[a]), 0.0);
    }
  }
}

TEST(ClearanceWord, ABoundIsRoundedDownwardsByLessThanAStep) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const float steps : kSteps) {
    const float reach = 512 / steps;
    for (int trial = 0; trial < 20000; ++trial) {
      const std::array<int, 3> slopes{static_cast<int>(rng() % 127) - 63,
                                      static_cast<int>(rng() % 127) - 63,
                                      static_cast<int>(rng() % 127) - 63};
      float bound = 1.5f * reach * uniform(rng);
      if (trial % 9 == 0) bound = std::floor(bound * steps) / steps;  // exactly a step
      if (trial % 1000 == 0) bound = trial % 2000 == 0 ? 1e9f : -1e9f;
      const std::uint32_t word = ClearanceWord::encode(slopes, bound, steps);
      EXPECT_EQ(word & ClearanceWord::kLink, 0U);
      const float level = ClearanceWord::at(word, {0, 0, 0}, steps);
      if (bound < -reach) {
        EXPECT_EQ(word, ClearanceWord::kNever);
        continue;
      }
      EXPECT_LE(level, bound);
      if (bound < 511 / steps) {
        EXPECT_GT(level, bound - 1 / steps - 1e-4f);
      } else {
        EXPECT_EQ(level, 511 / steps);
      }
      const std::array<float, 3> from{8 * uniform(rng), 8 * uniform(rng), 8 * uniform(rng)};
      double expected = static_cast<double>(level);
      for (std::size_t a = 0; a < 3; ++a) {
        expected += slopes[a] / 63.0 * static_cast<double>(from[a]);
      }
      EXPECT_NEAR(static_cast<double>(ClearanceWord::at(word, from, steps)), expected, 1e-4);
    }
  }
}

TEST(ClearanceWord, NeverClaimsNothingAnywhereInItsBlock) {
  // The least bound and no slope.
  for (const float steps : kSteps) {
    EXPECT_EQ(ClearanceWord::at(ClearanceWord::kNever, {3, -2, 1}, steps), -512 / steps);
  }
}

}  // namespace
}  // namespace palpate
