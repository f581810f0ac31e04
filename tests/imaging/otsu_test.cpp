/// Otsu's thresholds against every cut of the sorted values, compared as fractions of whole
/// numbers.

#include "imaging/otsu.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace palpate {
namespace {

__extension__ using Wide = __int128;

Volume volumeOf(const std::vector<int>& values, VoxelType type = VoxelType::Int16) {
  Volume v;
  v.geometry.dims = {static_cast<std::int32_t>(values.size()), 1, 1};
  v.type = type;
  for (const int value : values) {
    if (type == VoxelType::Int16) v.int16.push_back(static_cast<std::int16_t>(value));
    if (type == VoxelType::Float32) v.float32.push_back(static_cast<float>(value));
  }
  return v;
}

/// A sum of squares over counts, as one fraction. Fits: 2,000 voxels of values up to 65,535.
struct Score {
  Wide above = 0, below = 1;
  void add(Wide sum, Wide count) {
    if (count == 0) return;
    above = above * count + sum * sum * below;
    below *= count;
  }
  bool operator<(const Score& other) const { return above * other.below < other.above * below; }
  bool operator==(const Score& other) const { return above * other.below == other.above * below; }
};

/// The values from low to high, the brightest thousandth cut to the 99.9th percentile, but not to
/// the smallest value.
std::vector<int> clipped(std::vector<int> values) {
  std::sort(values.begin(), values.end());
  const auto second = std::upper_bound(values.begin(), values.end(), values.front());
  int top = values.back();
  for (auto v = second; v != values.end(); ++v) {
    const auto above = values.end() - std::upper_bound(values.begin(), values.end(), *v);
    if (static_cast<double>(above) > 0.001 * static_cast<double>(values.size())) continue;
    top = *v;
    break;
  }
  for (int& v : values) v = std::min(v, top);
  return values;
}

/// What decides between classes [.., low), [low, high), [high, ..], the greater the better.
Score scoreOf(const std::vector<int>& values, double low, double high) {
  std::array<Wide, 3> sum{}, count{};
  for (const int v : values) {
    const std::size_t of = v >= high ? 2 : (v >= low ? 1 : 0);
    sum[of] += v - values.front();
    ++count[of];
  }
  Score score;
  for (std::size_t c = 0; c < 3; ++c) score.add(sum[c], count[c]);
  return score;
}

std::vector<int> distinct(std::vector<int> sorted) {
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

/// Lumps of values, some with a few very bright ones.
std::vector<int> randomValues(std::mt19937& random) {
  const auto below = [&random](int n) {
    return static_cast<int>(random() % static_cast<unsigned>(n));
  };
  const int lumps = 1 + below(4);
  const int width = std::array{2, 6, 30, 3000}[static_cast<std::size_t>(below(4))];
  const int apart = std::array{1, 20, 400, 8000}[static_cast<std::size_t>(below(4))];
  const int low = std::array{-32768, -1024, -3, 0}[static_cast<std::size_t>(below(4))];
  std::vector<int> values(static_cast<std::size_t>(1 + below(width > 30 ? 60 : 2000)));
  for (int& v : values) v = low + below(lumps) * apart + below(width) * below(width) / width;
  for (int bright = below(4); bright > 0; --bright)
    values[random() % values.size()] = 32000 + bright;
  return values;
}

void expectBest(const std::vector<int>& values, VoxelType type) {
  const Volume volume = volumeOf(values, type);
  const std::vector<int> sorted = clipped(values);
  const std::vector<int> cuts = distinct(sorted);
  Score two = scoreOf(sorted, cuts.front(), cuts.front());
  Score three = two;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    two = std::max(two, scoreOf(sorted, cuts[i], cuts[i]));
    for (std::size_t j = i; j < cuts.size(); ++j) {
      three = std::max(three, scoreOf(sorted, cuts[i], cuts[j]));
    }
  }
  const double one = otsuThreshold(volume);
  const auto [low, high] = otsuThresholds2(volume);
  EXPECT_TRUE(scoreOf(sorted, one, one) == two) << one;
  EXPECT_TRUE(scoreOf(sorted, low, high) == three) << low << ", " << high;
  for (const double cut : {one, low, high}) {
    EXPECT_TRUE(std::binary_search(cuts.begin(), cuts.end(), cut)) << cut << " does not occur";
  }
}

TEST(Otsu, NoOtherCutIsBetter) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const std::vector<int> values = randomValues(random);
    expectBest(values, VoxelType::Int16);
    expectBest(values, VoxelType::Float32);
  }
}

TEST(Otsu, WholeNumbersBeyondInt16AreExactToo) {
  std::vector<int> values;
  std::mt19937 random(11);
  for (int i = 0; i < 40; ++i) values.push_back(static_cast<int>(random() % 65536));
  values.push_back(0);
  values.push_back(65535);
  expectBest(values, VoxelType::Float32);
}

TEST(Otsu, ValuesThatAreNoWholeNumbersAreCutBetweenBins) {
  Volume v;
  v.type = VoxelType::Float32;
  for (int i = 0; i < 1000; ++i)
    v.float32.push_back((i < 600 ? 0.25F : 0.75F) + 1e-4F * float(i % 50));
  v.geometry.dims = {1000, 1, 1};
  EXPECT_EQ(otsuThreshold(v), static_cast<double>(0.75F));
}

TEST(Otsu, FewVoxelsInADarkScanAreParted) {
  std::vector<int> values(100000, 0);
  values[7] = 900;
  EXPECT_EQ(otsuThreshold(volumeOf(values)), 900.0);
  EXPECT_EQ(otsuThresholds2(volumeOf(values)), (std::pair{900.0, 900.0}));
}

TEST(Otsu, OneValueIsItsOwnCut) {
  for (const VoxelType type : {VoxelType::Int16, VoxelType::Float32}) {
    EXPECT_EQ(otsuThreshold(volumeOf({-7, -7, -7}, type)), -7.0);
    EXPECT_EQ(otsuThresholds2(volumeOf({-7, -7, -7}, type)), (std::pair{-7.0, -7.0}));
    EXPECT_EQ(otsuThreshold(volumeOf({}, type)), 0.0);
  }
}

}  // namespace
}  // namespace palpate
