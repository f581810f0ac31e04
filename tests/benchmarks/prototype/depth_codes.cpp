#include "tests/benchmarks/prototype/depth_codes.h"

#include <algorithm>
#include <cmath>

#include "tests/benchmarks/prototype/fast_world.h"

namespace palpate::bench {

std::int16_t depthSteps(float value) {
  return static_cast<std::int16_t>(
      std::clamp(std::lround(static_cast<double>(value) * kDepthUnit), -32768L, 32767L));
}

DepthCodes::DepthCodes(const std::vector<std::uint32_t>& histogram, std::int16_t farSteps)
    : code(65536, -1) {
  std::vector<std::int32_t> seen;
  for (std::int32_t s = -32768; s < farSteps; ++s) {
    if (histogram[static_cast<std::size_t>(s + 32768)] > 0) seen.push_back(s);
  }
  std::sort(seen.begin(), seen.end(), [&](std::int32_t a, std::int32_t b) {
    const auto ca = histogram[static_cast<std::size_t>(a + 32768)];
    const auto cb = histogram[static_cast<std::size_t>(b + 32768)];
    return ca > cb || (ca == cb && a < b);
  });
  seen.resize(std::min<std::size_t>(seen.size(), 255));
  steps.fill(farSteps);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    steps[i + 1] = static_cast<std::int16_t>(seen[i]);
    code[static_cast<std::size_t>(seen[i] + 32768)] = static_cast<std::int16_t>(i + 1);
  }
  for (std::int32_t s = farSteps; s < 32768; ++s) code[static_cast<std::size_t>(s + 32768)] = 0;
}

}  // namespace palpate::bench
