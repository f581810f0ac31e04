#include "imaging/otsu.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace palpate {
namespace {

constexpr std::size_t kBins = 256;

struct Histogram {
  std::array<double, kBins> count{};
  double low = 0.0, width = 1.0;
  [[nodiscard]] double lowerEdge(std::size_t bin) const {
    return low + width * static_cast<double>(bin);
  }
};

Histogram fill(const Volume& volume, double low, double high) {
  Histogram h;
  h.low = low;
  h.width = high > low ? (high - low) / static_cast<double>(kBins) : 1.0;
  for (std::size_t i = 0; i < volume.size(); ++i) {
    const double bin = (volume.value(i) - low) / h.width;
    h.count[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins - 1)))] += 1.0;
  }
  return h;
}

Histogram histogram(const Volume& volume) {
  const auto [low, high] = valueRange(volume);
  const Histogram whole = fill(volume, low, high);
  double above = static_cast<double>(volume.size()) * 0.001;
  std::size_t top = kBins - 1;
  for (; top > 0 && above >= whole.count[top]; --top) above -= whole.count[top];
  return fill(volume, low, std::min(high, whole.lowerEdge(top + 1)));
}

/// Sums of count and count·bin before each bin.
struct Sums {
  std::array<double, kBins + 1> n{}, moment{};
  explicit Sums(const Histogram& h) {
    for (std::size_t b = 0; b < kBins; ++b) {
      n[b + 1] = n[b] + h.count[b];
      moment[b + 1] = moment[b] + h.count[b] * static_cast<double>(b);
    }
  }
  /// Share of the variance between classes of the bins [from, to).
  [[nodiscard]] double between(std::size_t from, std::size_t to) const {
    const double count = n[to] - n[from];
    const double sum = moment[to] - moment[from];
    return count > 0.0 ? sum * sum / count : 0.0;
  }
};

}  // namespace

double otsuThreshold(const Volume& volume) {
  const Histogram h = histogram(volume);
  const Sums sums(h);
  std::size_t best = 1;
  double bestScore = -1.0;
  for (std::size_t cut = 1; cut < kBins; ++cut) {
    const double score = sums.between(0, cut) + sums.between(cut, kBins);
    if (score > bestScore) {
      bestScore = score;
      best = cut;
    }
  }
  return h.lowerEdge(best);
}

std::pair<double, double> otsuThresholds2(const Volume& volume) {
  const Histogram h = histogram(volume);
  const Sums sums(h);
  std::pair<std::size_t, std::size_t> best{1, 2};
  double bestScore = -1.0;
  for (std::size_t low = 1; low + 1 < kBins; ++low) {
    for (std::size_t high = low + 1; high < kBins; ++high) {
      const double score =
          sums.between(0, low) + sums.between(low, high) + sums.between(high, kBins);
      if (score > bestScore) {
        bestScore = score;
        best = {low, high};
      }
    }
  }
  return {h.lowerEdge(best.first), h.lowerEdge(best.second)};
}

}  // namespace palpate
