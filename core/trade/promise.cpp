#include "core/trade/promise.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

#include "core/trade/errors.h"

namespace palpate {
namespace {

struct Weighted {
  double value = 0.0;
  std::size_t motion = 0;
};

/// By nearest rank, each value as often as its motion was drawn. `values` ascend.
double weightedPercentile(const std::vector<Weighted>& values,
                          const std::vector<std::size_t>& drawn, double share) {
  std::size_t all = 0;
  for (const Weighted& v : values) all += drawn[v.motion];
  if (all == 0) return 0.0;
  const auto rank =
      static_cast<std::size_t>(std::max(std::ceil(share * static_cast<double>(all)), 1.0));
  std::size_t seen = 0;
  for (const Weighted& v : values) {
    seen += drawn[v.motion];
    if (seen >= rank) return v.value;
  }
  return values.back().value;
}

}  // namespace

double boundOf(const std::vector<std::vector<double>>& valuesByMotion, double share) {
  constexpr int kDraws = 400;
  std::vector<Weighted> values;
  for (std::size_t motion = 0; motion < valuesByMotion.size(); ++motion) {
    for (const double value : valuesByMotion[motion]) values.push_back({value, motion});
  }
  std::stable_sort(values.begin(), values.end(),
                   [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  std::mt19937_64 random(20081);
  std::vector<double> found;
  for (int draw = 0; draw < kDraws && !values.empty(); ++draw) {
    const std::size_t count = valuesByMotion.size();
    std::vector<std::size_t> all(count), drawn(count, 0);
    for (std::size_t& motion : all) motion = random() % count;
    for (std::size_t i = 0; i < count; ++i) ++drawn[all[random() % count]];
    found.push_back(weightedPercentile(values, drawn, share));
  }
  return percentile(std::move(found), 0.975);
}

}  // namespace palpate
