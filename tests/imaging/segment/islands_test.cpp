/// tool::Islands against parts found breadth first, in all four ways to keep.

#include <algorithm>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

using Keep = tool::Islands::Keep;

TEST(Islands, LargestKeepsTheCountAskedFor) {
  forSamples(400, [](Random& random, Sample& s) {
    tool::Islands tool{.keep = Keep::Largest};
    tool.count = static_cast<std::size_t>(random.whole(1, 4));
    std::vector<Part> parts = partsOf(s.label(), s.geometry(), 26);
    std::stable_sort(parts.begin(), parts.end(),
                     [](const Part& a, const Part& b) { return a.size() > b.size(); });
    const std::size_t kept = std::min(tool.count, parts.size());
    const std::size_t last = kept > 0 ? parts[kept - 1].size() : 0;
    const bool tie = kept < parts.size() && parts[kept].size() == last;
    Mask wanted(s.size(), 0);
    Mask either(s.size(), 0);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      Mask& mask = tie && parts[p].size() == last ? either : wanted;
      if (p >= kept && &mask == &wanted) continue;
      for (const std::size_t i : parts[p]) mask[i] = 1;
    }
    const EditLimits limits = randomLimits(random);
    expectEdit(s, tool, limits, wanted, either);
    // Of equal parts so many as are missing to the count, each whole.
    const auto after = applied(s, tool, limits);
    if (!after || limits.only) return;
    Mask left(s.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
      left[i] = after->labels.labels[i] == kValue ? 1 : 0;
    }
    std::vector<Part> now = partsOf(left, s.geometry(), 26);
    std::stable_sort(now.begin(), now.end(),
                     [](const Part& a, const Part& b) { return a.size() > b.size(); });
    ASSERT_EQ(now.size(), kept) << describe(s);
    for (std::size_t p = 0; p < kept; ++p) EXPECT_EQ(now[p].size(), parts[p].size());
  });
}

TEST(Islands, AtLeastKeepsPartsByTheirVolume) {
  forSamples(300, [](Random& random, Sample& s) {
    const int voxels = random.whole(0, 6);
    tool::Islands tool{.keep = Keep::AtLeast};
    tool.minMm3 = (voxels + 0.5) * voxelMm3(s.geometry());
    Mask wanted(s.size(), 0);
    for (const Part& part : partsOf(s.label(), s.geometry(), 26)) {
      if (part.size() <= static_cast<std::size_t>(voxels)) continue;
      for (const std::size_t i : part) wanted[i] = 1;
    }
    expectEdit(s, tool, randomLimits(random), wanted);
  });
}

TEST(Islands, APartOfJustTheVolumeStays) {
  const std::vector<std::pair<Eigen::Vector3d, double>> rows{{{1, 1, 1}, 1.0},
                                                             {{0.5, 0.5, 0.5}, 0.125},
                                                             {{1, 2, 3}, 6.0},
                                                             {{0.25, 0.25, 2}, 0.125},
                                                             {{0.4, 0.5, 1.5}, 0.3}};
  for (const auto& [spacing, mm3] : rows) {
    for (int n = 1; n <= 30; ++n) {
      SCOPED_TRACE(std::to_string(n) + " voxels of " + std::to_string(mm3) + " mm3");
      Sample s = plainSample({80, 1, 1}, spacing);
      for (int i = 0; i < n; ++i) s.before.labels.labels[static_cast<std::size_t>(i)] = kValue;
      for (int i = 0; i < n - 1; ++i) {
        s.before.labels.labels[static_cast<std::size_t>(40 + i)] = kValue;
      }
      const auto after = applied(s, tool::Islands{.keep = Keep::AtLeast, .minMm3 = n * mm3});
      ASSERT_TRUE(after) << sentence(after.error());
      EXPECT_EQ(voxelsOf(after->labels, kValue), static_cast<std::size_t>(n));
      if (HasFailure()) return;
    }
  }
}

/// Voxels of the parts that a pick means: the part of the nearest voxel, within 5 mm.
Mask pickedMask(const Sample& s, const std::vector<Eigen::Vector3d>& picks_mm, bool& missed) {
  missed = false;
  const std::vector<Part> parts = partsOf(s.label(), s.geometry(), 26);
  Mask picked(s.size(), 0);
  for (const Eigen::Vector3d& pick : picks_mm) {
    const Part* nearest = nullptr;
    double best = 5.0;
    for (const Part& part : parts) {
      for (const std::size_t i : part) {
        const double mm = (centre_mm(s.geometry(), i) - pick).norm();
        if (mm > best) continue;
        best = mm;
        nearest = &part;
      }
    }
    if (nearest == nullptr) {
      missed = true;
      continue;
    }
    for (const std::size_t i : *nearest) picked[i] = 1;
  }
  return picked;
}

std::vector<Eigen::Vector3d> randomPicks(Random& random, const Sample& s) {
  std::vector<Eigen::Vector3d> picks;
  for (int n = random.whole(1, 3); n > 0; --n) {
    const auto voxel = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
    picks.push_back(somewhereIn_mm(random, s.geometry(), voxel));
  }
  return picks;
}

TEST(Islands, PickedKeepsThePartsAtThePicks) {
  forSamples(400, [](Random& random, Sample& s) {
    tool::Islands tool{.keep = Keep::Picked};
    tool.picks_mm = randomPicks(random, s);
    bool missed = false;
    const Mask wanted = pickedMask(s, tool.picks_mm, missed);
    (missed ? expectEditOrRefusal : expectEdit)(s, tool, randomLimits(random), wanted, {}, false);
  });
}

TEST(Islands, NotPickedKeepsAllOtherParts) {
  forSamples(400, [](Random& random, Sample& s) {
    tool::Islands tool{.keep = Keep::NotPicked};
    tool.picks_mm = randomPicks(random, s);
    bool missed = false;
    Mask wanted = pickedMask(s, tool.picks_mm, missed);
    for (std::size_t i = 0; i < s.size(); ++i) wanted[i] = s.holds(i) && wanted[i] == 0 ? 1 : 0;
    (missed ? expectEditOrRefusal : expectEdit)(s, tool, randomLimits(random), wanted, {}, false);
  });
}

TEST(Islands, APickReachesFiveMillimetres) {
  for (int axis = 0; axis < 3; ++axis) {
    std::array<std::int32_t, 3> dims{1, 1, 1};
    dims[static_cast<std::size_t>(axis)] = 40;
    Sample s = plainSample(dims, {1, 1, 1});
    s.before.labels.labels[20] = kValue;
    const auto picked = [&](double at) {
      tool::Islands tool{.keep = Keep::Picked};
      tool.picks_mm = {Eigen::Vector3d::Unit(axis) * at};
      return applied(s, tool);
    };
    EXPECT_TRUE(picked(15.0));
    EXPECT_TRUE(picked(25.0));
    ASSERT_FALSE(picked(14.9));
    ASSERT_FALSE(picked(25.1));
    EXPECT_EQ(picked(14.9).error().kind, ErrorKind::InputRefused);
  }
}

TEST(Islands, APickOutsideTheScanIsRefused) {
  Sample s = plainSample({4, 5, 6}, {1, 1, 1});
  s.before.labels.labels.assign(s.size(), kValue);
  for (const Keep keep : {Keep::Picked, Keep::NotPicked}) {
    for (const Eigen::Vector3d& out : {Eigen::Vector3d(3.6, 0, 0), Eigen::Vector3d(0, 4.6, 0),
                                       Eigen::Vector3d(0, 0, 5.6), Eigen::Vector3d(-0.6, 0, 0)}) {
      tool::Islands tool{.keep = keep};
      tool.picks_mm = {{1, 1, 1}, out};
      expectRefused(s, tool, ErrorKind::InputRefused);
    }
  }
}

TEST(Islands, TouchingByACornerIsOnePart) {
  Sample s = plainSample({4, 4, 4}, {1, 1, 1});
  for (int n = 0; n < 3; ++n) s.before.labels.labels[s.geometry().index(n, n, n)] = kValue;
  s.before.labels.labels[s.geometry().index(3, 0, 3)] = kValue;
  s.before.labels.labels[s.geometry().index(3, 0, 2)] = kValue;
  const auto after = applied(s, tool::Islands{});
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(voxelsOf(after->labels, kValue), 3U);
  EXPECT_EQ(after->labels.at(2, 2, 2), kValue);
}

/// Larger than a small case: parts that meet far from where they begin.
TEST(Islands, EqualTheOracleInALargeScan) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Sample s = plainSample({67, 41, 35}, {0.5, 0.6, 0.7});
    for (auto& label : s.before.labels.labels) {
      label = random.chance(static_cast<int>(5 + seed)) ? kValue : std::uint8_t{0};
    }
    for (const double voxels : {1.5, 3.5, 20.5}) {
      Mask wanted(s.size(), 0);
      for (const Part& part : partsOf(s.label(), s.geometry(), 26)) {
        if (static_cast<double>(part.size()) < voxels) continue;
        for (const std::size_t i : part) wanted[i] = 1;
      }
      expectEdit(s, tool::Islands{.keep = Keep::AtLeast, .minMm3 = voxels * voxelMm3(s.geometry())},
                 {}, wanted);
      if (HasFailure()) return;
    }
  }
}

}  // namespace
}  // namespace palpate::test
