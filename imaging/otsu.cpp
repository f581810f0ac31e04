#include "imaging/otsu.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace palpate {
namespace {

constexpr std::size_t kBins = 65536;  // one a value of int16

/// A grey value that occurs, or a bin of them.
struct Level {
  double least = 0.0;  ///< Smallest value in it.
  double count = 0.0;
  double sum = 0.0;  ///< Of the values, from the volume's smallest. Whole numbers stay exact.
};

/// All values that occur, ascending.
std::vector<Level> levelsOf(const std::vector<std::int16_t>& values) {
  constexpr int kLowest = std::numeric_limits<std::int16_t>::min();
  std::vector<std::uint64_t> counts(kBins);
  for (const std::int16_t value : values) ++counts[static_cast<std::size_t>(value - kLowest)];
  std::vector<Level> levels;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (counts[bin] == 0) continue;
    const double value = static_cast<double>(bin) + kLowest;
    const auto count = static_cast<double>(counts[bin]);
    const double low = levels.empty() ? value : levels.front().least;
    levels.push_back({value, count, count * (value - low)});
  }
  return levels;
}

/// Occupied bins, ascending; what is above counts as `high`.
std::vector<Level> levelsOf(const std::vector<float>& values, double low, double high) {
  const double perValue = high > low ? static_cast<double>(kBins) / (high - low) : 0.0;
  std::vector<Level> levels(kBins);
  for (const float v : values) {
    const double value = std::min(static_cast<double>(v), high);
    if (!(value >= low)) continue;  // not a number
    const double bin = std::min((value - low) * perValue, static_cast<double>(kBins - 1));
    Level& level = levels[static_cast<std::size_t>(bin)];
    if (level.count == 0.0 || value < level.least) level.least = value;
    level.count += 1.0;
    level.sum += value - low;
  }
  std::erase_if(levels, [](const Level& level) { return level.count == 0.0; });
  return levels;
}

/// The level that the brightest thousandth counts as. Two levels always stay: a small thing in a
/// dark scan is what is looked for.
std::size_t topOf(const std::vector<Level>& levels, std::size_t voxels) {
  double above = static_cast<double>(voxels) * 0.001;
  std::size_t top = levels.empty() ? 0 : levels.size() - 1;
  for (; top > 1 && above >= levels[top].count; --top) above -= levels[top].count;
  return top;
}

std::vector<Level> levelsOf(const Volume& volume) {
  const bool whole = volume.type == VoxelType::Int16;
  const auto [low, high] = whole ? std::pair{0.0, 0.0} : valueRange(volume);
  std::vector<Level> levels = whole ? levelsOf(volume.int16) : levelsOf(volume.float32, low, high);
  const std::size_t top = topOf(levels, volume.size());
  if (top + 1 >= levels.size()) return levels;
  if (!whole) return levelsOf(volume.float32, low, levels[top].least);  // in narrower bins
  for (std::size_t i = top + 1; i < levels.size(); ++i) levels[top].count += levels[i].count;
  levels[top].sum = levels[top].count * (levels[top].least - levels.front().least);
  levels.resize(top + 1);
  return levels;
}

/// Sums of count and of values before each level.
class Sums {
 public:
  explicit Sums(const std::vector<Level>& levels)
      : count_(levels.size() + 1), sum_(levels.size() + 1) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      count_[i + 1] = count_[i] + levels[i].count;
      sum_[i + 1] = sum_[i] + levels[i].sum;
    }
  }
  /// Share of the variance between classes of the levels [from, to), of one or more.
  [[nodiscard]] double between(std::size_t from, std::size_t to) const {
    const double sum = sum_[to] - sum_[from];
    return sum * sum / (count_[to] - count_[from]);
  }

 private:
  std::vector<double> count_, sum_;
};

/// The cut in [first, last] that parts the levels [0, end) best.
std::size_t bestCut(const Sums& sums, std::size_t first, std::size_t last, std::size_t end) {
  std::size_t best = first;
  double bestScore = -1.0;
  for (std::size_t cut = first; cut <= last; ++cut) {
    const double score = sums.between(0, cut) + sums.between(cut, end);
    if (score > bestScore) {
      bestScore = score;
      best = cut;
    }
  }
  return best;
}

/// For each end in [first, last] the best cut below it, known to be in [low, high]. As the end
/// rises the best cut never falls (Grønlund and others, "Fast exact k-means, k-medians and Bregman
/// divergence clustering in 1D", 2017), so that the middle end's cut bounds those of both halves.
void bestCuts(const Sums& sums, std::size_t first, std::size_t last, std::size_t low,
              std::size_t high, std::vector<std::size_t>& cuts) {
  const std::size_t end = first + (last - first) / 2;
  const std::size_t cut = bestCut(sums, low, std::min(high, end - 1), end);
  cuts[end] = cut;
  if (end > first) bestCuts(sums, first, end - 1, low, cut, cuts);
  if (end < last) bestCuts(sums, end + 1, last, cut, high, cuts);
}

}  // namespace

double otsuThreshold(const Volume& volume) {
  const std::vector<Level> levels = levelsOf(volume);
  if (levels.empty()) return 0.0;
  if (levels.size() == 1) return levels[0].least;
  return levels[bestCut(Sums(levels), 1, levels.size() - 1, levels.size())].least;
}

std::pair<double, double> otsuThresholds2(const Volume& volume) {
  const std::vector<Level> levels = levelsOf(volume);
  if (levels.empty()) return {0.0, 0.0};
  if (levels.size() < 3) return {levels.back().least, levels.back().least};
  const Sums sums(levels);
  std::vector<std::size_t> lower(levels.size());  // of each upper cut
  bestCuts(sums, 2, levels.size() - 1, 1, levels.size() - 2, lower);
  std::size_t best = 2;
  double bestScore = -1.0;
  for (std::size_t upper = 2; upper < levels.size(); ++upper) {
    const std::size_t cut = lower[upper];
    const double score =
        sums.between(0, cut) + sums.between(cut, upper) + sums.between(upper, levels.size());
    if (score > bestScore) {
      bestScore = score;
      best = upper;
    }
  }
  return {levels[lower[best]].least, levels[best].least};
}

}  // namespace palpate
