#include "core/voxels/depth_palette.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

// Rungs lie between saturation and what 16 bits hold; steps of 1/64 s keep them apart.
constexpr double kRungStep = 1.0 / 64.0;

// Every square up to `limit`, added up as the transform does, ascending, each once.
std::vector<float> squaresUpTo(const std::array<float, 3>& w, float limit) {
  std::vector<float> all;
  const auto square = [&w](std::size_t a, int n) { return w[a] * static_cast<float>(n * n); };
  for (int x = 0; square(0, x) <= limit; ++x) {
    for (int y = 0; square(0, x) + square(1, y) <= limit; ++y) {
      for (int z = 0;; ++z) {
        const float sum = (square(0, x) + square(1, y)) + square(2, z);
        if (sum > limit) break;
        if (sum > 0.0f) all.push_back(sum);
      }
    }
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

void DepthPalette::setCode(std::size_t code, double value) {
  value_[code] = static_cast<float>(value);
  steps_[code] = static_cast<std::int16_t>(std::lround(value * static_cast<double>(stepsPerUnit_)));
}

DepthPalette::DepthPalette(const Eigen::Vector3d& spacing) {
  const double s = spacing.minCoeff();
  double diagonal2 = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto step = static_cast<float>(spacing[static_cast<Eigen::Index>(a)] / s);
    weight_[a] = step * step;
    diagonal2 += static_cast<double>(weight_[a]);
  }
  const double diagonal = std::sqrt(diagonal2);
  // An outside corner of a cell with one inside is at most a cell's diagonal away from it. Inside,
  // a cell that reaches up to saturation has corners at most a diagonal deeper.
  farSquare_ = static_cast<float>(diagonal2 * (1.0 + 1e-6));
  const double deep = kSaturationVoxels + 0.5 + diagonal;
  deepSquare_ = static_cast<float>(deep * deep);
  const double ladder = kSaturationVoxels + diagonal + kRungs * kRungStep;
  stepsPerUnit_ = std::min(1800.0f, static_cast<float>(std::floor(32767.0 / (ladder + 1.0))));

  const std::vector<float> outside = squaresUpTo(weight_, farSquare_);
  std::vector<float> inside = squaresUpTo(weight_, deepSquare_);
  // Unequal spacings of great ratio have long cells with many depths; what does not fit is left
  // out from the deep end on, where depths are saturated anyway.
  const std::size_t room = kCodes - kRungs - 1 - std::min(outside.size(), kCodes / 2);
  if (inside.size() > room) {
    inside.resize(room);
    deepSquare_ = inside.back();
  }
  const std::size_t out = std::min(outside.size(), kCodes / 2);
  value_.assign(kCodes, 0.0f);
  steps_.assign(kCodes, 0);
  square_.assign(kCodes, 0.0f);
  setCode(kFarCode, diagonal);
  square_[kFarCode] = farSquare_;
  std::size_t code = 1;
  for (std::size_t i = out; i-- > 0; ++code) {
    square_[code] = outside[i];
    setCode(code, std::sqrt(static_cast<double>(outside[i])) - 0.5);
  }
  firstInside_ = static_cast<std::uint16_t>(code);
  saturated_ = static_cast<std::uint16_t>(code + inside.size() - 1);
  for (const float square : inside) {
    square_[code] = -square;
    const double depth = std::sqrt(static_cast<double>(square)) - 0.5;
    setCode(code, -depth);
    if (depth >= kSaturationVoxels && saturated_ > code)
      saturated_ = static_cast<std::uint16_t>(code);
    ++code;
  }
  deepest_ = static_cast<std::uint16_t>(code - 1);
  for (int r = 0; r < kRungs; ++r) {
    setCode(rung(r), -(kSaturationVoxels + (r + 1) * kRungStep));
  }

  firstCode_.resize(static_cast<std::size_t>(deepSquare_) + 2);
  std::uint16_t at = firstInside_;
  for (std::size_t whole = 0; whole < firstCode_.size(); ++whole) {
    while (at < deepest_ && -square_[at] < static_cast<float>(whole)) ++at;
    firstCode_[whole] = at;
  }
  pairs_.resize(kNarrow * kNarrow);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const auto low = static_cast<std::uint16_t>(steps_[i % kNarrow]);
    const auto high = static_cast<std::uint16_t>(steps_[i / kNarrow]);
    pairs_[i] = static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 16;
  }
  for (std::size_t i = 0; i < kTabled; ++i) {
    const auto bits = static_cast<std::uint16_t>(steps_[i]);
    low_[i] = static_cast<std::uint8_t>(bits & 255U);
    high_[i] = static_cast<std::uint8_t>(bits >> 8U);
  }
}

std::uint16_t DepthPalette::codeOf(float signedSquare) const noexcept {
  if (signedSquare > 0.0f) {
    if (signedSquare >= farSquare_) return kFarCode;
    std::uint16_t code = 1;  // few: those within a cell's diagonal
    while (code + 1 < firstInside_ && square_[code] > signedSquare) ++code;
    return code;
  }
  const float square = -signedSquare;
  if (square >= deepSquare_) return deepest_;
  std::uint16_t code = firstCode_[static_cast<std::size_t>(square)];
  while (code < deepest_ && -square_[code] < square) ++code;
  return code;
}

}  // namespace palpate
