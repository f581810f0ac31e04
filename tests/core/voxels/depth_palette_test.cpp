#include "core/voxels/depth_palette.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace palpate {
namespace {

// Cubic, as scanners have it, nearly cubic (hardly two distances are the same), and far from it.
const std::vector<Eigen::Vector3d>& spacings() {
  static const std::vector<Eigen::Vector3d> all{
      {1, 1, 1},
      {0.7, 0.7, 0.7},
      {0.95703, 0.7, 2.5},
      {0.4, 0.4, 0.625},
      {1, 1.001, 1.002},
      {1.002, 1, 1.001},
      {1, 1, 40},
      {40, 1, 1},
      {1, 40, 40},
      {1, 1e-3 + 1, 1},
      {1, 1.0000001, 1},
      {0.3, 0.5, 0.31415926},
      {1, 1.41421356, 1.73205},
      {1e-3, 1.3e-3, 2e-3},
      {1, 1000, 1000},
      {1, 3.3, 7.7},
  };
  return all;
}

std::string named(const Eigen::Vector3d& s) {
  return "spacing " + std::to_string(s.x()) + " " + std::to_string(s.y()) + " " +
         std::to_string(s.z());
}

// Every square that the transform can come to, up to this distance, in its arithmetic.
std::vector<float> squaresUpTo(const DepthPalette& palette, double distance) {
  const auto& w = palette.weight();
  std::set<float> all;
  const auto limit = static_cast<float>(distance * distance);
  for (int z = 0; w[2] * static_cast<float>(z * z) <= limit; ++z) {
    for (int y = 0; w[1] * static_cast<float>(y * y) <= limit; ++y) {
      for (int x = 0; w[0] * static_cast<float>(x * x) <= limit; ++x) {
        const float sum = (w[0] * static_cast<float>(x * x) + w[1] * static_cast<float>(y * y)) +
                          w[2] * static_cast<float>(z * z);
        if (sum > 0 && sum <= limit) all.insert(sum);
      }
    }
  }
  return {all.begin(), all.end()};
}

double diagonalOf(const Eigen::Vector3d& spacing) {
  return (spacing / spacing.minCoeff()).norm();
}

TEST(DepthPalette, WeightsAreSquareStepsInSmallestSpacings) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    for (std::size_t a = 0; a < 3; ++a) {
      const double ratio = s[static_cast<Eigen::Index>(a)] / s.minCoeff();
      EXPECT_NEAR(static_cast<double>(palette.weight()[a]) / (ratio * ratio), 1.0, 1e-6);
    }
  }
}

TEST(DepthPalette, EveryDistanceOfTheBandHasACodeThatGivesItsValue) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    // Inside down to saturation at least, outside over a cell's diagonal at least.
    EXPECT_GE(static_cast<double>(palette.deepSquare()), 16.5 * 16.5);
    EXPECT_GE(std::sqrt(static_cast<double>(palette.farSquare())), diagonalOf(s) * (1 - 1e-6));
    const double farthest = std::sqrt(std::max(static_cast<double>(palette.deepSquare()),
                                               static_cast<double>(palette.farSquare()))) +
                            2;
    const auto squares = squaresUpTo(palette, std::min(farthest, 60.0));
    std::size_t inBand = 0;
    for (const float square : squares) {
      const double exact = std::sqrt(static_cast<double>(square)) - 0.5;
      const std::uint16_t inside = palette.codeOf(-square);
      if (square <= palette.deepSquare()) {
        ++inBand;
        // Half a unit in the last place; what is deeper than 16 is saturated anyway.
        ASSERT_NEAR(static_cast<double>(palette.value(inside)), -exact,
                    1e-6 * std::max(1.0, exact / 16))
            << square;
      } else {
        ASSERT_EQ(inside, palette.deepestCode()) << square;
      }
      const std::uint16_t outside = palette.codeOf(square);
      if (square <= palette.farSquare()) {
        ASSERT_NE(outside, DepthPalette::kFarCode) << square;
        ASSERT_NEAR(static_cast<double>(palette.value(outside)), exact, 1e-6 * std::max(1.0, exact))
            << square;
      } else {
        ASSERT_EQ(outside, DepthPalette::kFarCode) << square;
      }
    }
    EXPECT_GE(inBand, 17U);
    EXPECT_EQ(palette.codeOf(-INFINITY), palette.deepestCode());
    EXPECT_EQ(palette.codeOf(INFINITY), DepthPalette::kFarCode);
  }
}

TEST(DepthPalette, CodesAscendWithDepth) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    auto squares = squaresUpTo(palette, std::min(45.0, diagonalOf(s) + 20));
    const std::size_t outside = squares.size();
    squares.insert(squares.end(), squares.begin(), squares.end());
    for (std::size_t n = 0; n < outside; ++n) squares[n] = squares[2 * outside - 1 - n];
    std::uint16_t last = 0;
    for (std::size_t n = 0; n < squares.size(); ++n) {
      const std::uint16_t code = palette.codeOf(n < outside ? squares[n] : -squares[n]);
      ASSERT_GE(code, last) << n;
      last = code;
    }
    EXPECT_GE(palette.codeOf(-INFINITY), last);
    for (std::uint16_t c = 1; c <= palette.deepestCode(); ++c) {
      // Nearly cubic voxels have distances that single precision does not tell apart.
      ASSERT_LE(palette.value(c), palette.value(static_cast<std::uint16_t>(c - 1))) << c;
    }
  }
}

TEST(DepthPalette, AnySpacingGetsByWithTwelveBits) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    EXPECT_LE(palette.deepestCode() + DepthPalette::kRungs, 4095);
    EXPECT_LE(palette.rung(DepthPalette::kRungs - 1), 4095);
  }
}

TEST(DepthPalette, CubicVoxelsHaveFewDepthsAndNarrowCodesReachEightVoxels) {
  const DepthPalette palette(Eigen::Vector3d::Constant(0.8e-3));
  const double deepest = std::sqrt(static_cast<double>(palette.deepSquare()));
  const std::size_t inside = squaresUpTo(palette, deepest).size();
  EXPECT_EQ(palette.deepestCode(), 3 + inside);  // 1, 2 and 3 outside; from 0, the far code, on
  EXPECT_LT(inside, 300U);
  // Depths lie 0.06 apart there.
  EXPECT_NEAR(static_cast<double>(palette.value(63)), -8.0, 0.15);
}

TEST(DepthPalette, TheSaturatedCodeIsTheFirstOfSixteenVoxels) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    ASSERT_LE(palette.saturatedCode(), palette.deepestCode());
    EXPECT_LE(palette.value(palette.saturatedCode()), -16.0f);
    EXPECT_GT(palette.value(static_cast<std::uint16_t>(palette.saturatedCode() - 1)), -16.0f);
  }
}

TEST(DepthPalette, RungsAreEvenStepsBeyondSaturation) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    const double step = static_cast<double>(palette.value(palette.rung(1))) -
                        static_cast<double>(palette.value(palette.rung(0)));
    EXPECT_NE(step, 0.0);
    for (int r = 0; r < DepthPalette::kRungs; ++r) {
      EXPECT_LE(palette.value(palette.rung(r)), -16.0f);
      if (r == 0) continue;
      EXPECT_NEAR(static_cast<double>(palette.value(palette.rung(r))) -
                      static_cast<double>(palette.value(palette.rung(r - 1))),
                  step, 1e-5);
      // What the query reads: even in whole steps too, but for their rounding.
      EXPECT_NEAR(palette.steps(palette.rung(r)) - palette.steps(palette.rung(r - 1)),
                  step * static_cast<double>(palette.stepsPerUnit()), 1.01);
    }
  }
}

TEST(DepthPalette, StepsAreTheValuesWithinHalfAStep) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    EXPECT_GT(palette.stepsPerUnit(), 0.0f);
    for (int c = 0; c <= palette.rung(DepthPalette::kRungs - 1); ++c) {
      const auto code = static_cast<std::uint16_t>(c);
      ASSERT_NEAR(
          palette.steps(code),
          static_cast<double>(palette.value(code)) * static_cast<double>(palette.stepsPerUnit()),
          0.5 + 1e-3)  // products of single precision
          << c;
      EXPECT_EQ(palette.stepsTable()[c], palette.steps(code));
    }
  }
}

TEST(DepthPalette, TheTablesOfNarrowCodesSayTheSame) {
  for (const Eigen::Vector3d& s : spacings()) {
    SCOPED_TRACE(named(s));
    const DepthPalette palette(s);
    for (std::uint32_t a = 0; a < 64; ++a) {
      const auto low = static_cast<std::uint16_t>(palette.steps(static_cast<std::uint16_t>(a)));
      EXPECT_EQ(palette.lowBytes()[a], low & 255);
      EXPECT_EQ(palette.highBytes()[a], low >> 8);
      for (std::uint32_t b = 0; b < 64; ++b) {
        const auto high = static_cast<std::uint16_t>(palette.steps(static_cast<std::uint16_t>(b)));
        ASSERT_EQ(palette.pairTable()[a | b << 6], low | static_cast<std::uint32_t>(high) << 16);
      }
    }
  }
}

}  // namespace
}  // namespace palpate
