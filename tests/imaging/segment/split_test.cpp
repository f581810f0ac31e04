/// tool::Split against a slow flooding, and what any flooding must keep to.
///
/// Sources: Meyer, "Un algorithme optimal pour la ligne de partage des eaux", 1991 (the flooding);
/// Cousty et al., "Watershed Cuts", 2009 (each voxel goes to a seed from which the darkest voxel on
/// the way is as bright as can be).

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

/// Seeds by voxel, and the label that each becomes.
struct Flood {
  tool::Split tool;
  Part seeds;
  Mask values;
};

using By = tool::Split::By;

const std::map<std::string, std::uint8_t> kTargets{{kLabel, kValue}, {"bone", 1}, {"nerve", 9}};

/// The brightest voxels of the scan become seeds: they flood first, whether a seed counts with its
/// own brightness or not. No two are nearer than three voxels, so that none meet at once.
Flood brightSeeds(Random& random, Sample& s, int count) {
  Flood out;
  std::map<std::string, std::vector<Eigen::Vector3d>> points;
  for (int tries = 0; tries < 60 && static_cast<int>(out.seeds.size()) < count; ++tries) {
    const auto at = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
    const Voxel v = voxelOf(s.geometry(), at);
    const bool apart = std::all_of(out.seeds.begin(), out.seeds.end(), [&](std::size_t other) {
      const Voxel o = voxelOf(s.geometry(), other);
      return std::max({std::abs(o.i - v.i), std::abs(o.j - v.j), std::abs(o.k - v.k)}) >= 3;
    });
    if (!s.holds(at) || !apart) continue;
    const auto target = std::next(kTargets.begin(), random.whole(0, 2));
    out.seeds.push_back(at);
    out.values.push_back(target->second);
    points[target->first].push_back(somewhereIn_mm(random, s.geometry(), at));
    s.volume.int16[at] = static_cast<std::int16_t>(32000 + out.seeds.size());
  }
  for (const auto& [label, list] : points) out.tool.seeds.push_back({label, list});
  return out;
}

/// As many grey values as `levels`; with as many as voxels all differ.
void randomLevels(Random& random, Sample& s, std::size_t levels) {
  s.volume.type = VoxelType::Int16;
  s.volume.float32.clear();
  s.volume.int16.resize(s.geometry().voxelCount());
  std::vector<int> values(s.size());
  std::iota(values.begin(), values.end(), -200);
  std::shuffle(values.begin(), values.end(), random.bits());
  for (std::size_t i = 0; i < s.size(); ++i) {
    const int level = levels >= s.size() ? values[i] : values[i] % static_cast<int>(levels);
    s.volume.int16[i] = static_cast<std::int16_t>(level);
  }
}

/// Meyer's flooding, the highest level first, then who came first; 0 where no seed gets. Seeds come
/// before all.
Mask meyer(const Sample& s, const Flood& flood, const std::vector<double>& levels) {
  struct Entry {
    double level;
    std::size_t order, voxel;
    bool operator<(const Entry& o) const {
      return level != o.level ? level < o.level : order > o.order;
    }
  };
  std::priority_queue<Entry> queue;
  std::size_t order = 0;
  Mask owner(s.size(), 0);
  for (std::size_t n = 0; n < flood.seeds.size(); ++n) {
    owner[flood.seeds[n]] = flood.values[n];
    queue.push({std::numeric_limits<double>::infinity(), order++, flood.seeds[n]});
  }
  while (!queue.empty()) {
    const Entry from = queue.top();
    queue.pop();
    forNeighbours(s.geometry(), from.voxel, 26, [&](std::size_t next) {
      if (!s.holds(next) || owner[next] != 0) return;
      owner[next] = owner[from.voxel];
      queue.push({levels[next], order++, next});
    });
  }
  return owner;
}

std::vector<double> brightness(const Sample& s) {
  std::vector<double> levels(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) levels[i] = s.volume.value(i);
  return levels;
}

/// Grey values a millimetre, the steepest lowest; central differences, one-sided at the scan's
/// edge.
std::vector<double> smoothness(const Sample& s) {
  const GridGeometry& g = s.geometry();
  std::vector<double> levels(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Voxel v = voxelOf(g, i);
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      std::array<std::int32_t, 3> low{v.i, v.j, v.k}, high = low;
      const auto a = static_cast<std::size_t>(axis);
      if (low[a] > 0) --low[a];
      if (high[a] + 1 < g.dims[a]) ++high[a];
      const double mm = (high[a] - low[a]) * g.spacing[axis] * 1e3;
      if (mm == 0.0) continue;
      slope[axis] = (s.volume.value(g.index(high[0], high[1], high[2])) -
                     s.volume.value(g.index(low[0], low[1], low[2]))) /
                    mm;
    }
    levels[i] = -slope.norm();
  }
  return levels;
}

/// No two nearer than rounding.
bool allDiffer(std::vector<double> levels) {
  std::sort(levels.begin(), levels.end());
  return std::adjacent_find(levels.begin(), levels.end(),
                            [](double a, double b) { return b - a < 1e-6; }) == levels.end();
}

LabelGrid expectedOf(const Sample& s, const Mask& owner, const EditLimits& limits) {
  LabelGrid expected = s.before.labels;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (!s.holds(i) || owner[i] == 0) continue;
    if (limits.only && !inRange(s.volume, i, *limits.only)) continue;
    expected.labels[i] = owner[i];
  }
  return expected;
}

/// Runs `test` with flooded samples of so many levels (0: all differ).
void forFloods(unsigned count, std::size_t levels,
               const std::function<void(Random&, Sample&, Flood&)>& test) {
  forSamples(count, [&](Random& random, Sample& s) {
    if (random.chance(40)) {
      for (auto& label : s.before.labels.labels) label = random.chance(90) ? kValue : label;
    }
    randomLevels(random, s, levels == 0 ? s.geometry().voxelCount() : levels);
    Flood flood = brightSeeds(random, s, random.whole(1, 5));
    if (!flood.seeds.empty()) test(random, s, flood);
  });
}

TEST(Split, EqualsMeyersFloodingWhereAllLevelsDiffer) {
  forFloods(500, 0, [](Random& random, Sample& s, Flood& flood) {
    EditLimits limits;
    limits.overOthers = random.chance(50);
    if (random.chance(25)) {
      limits.only = ThresholdRange{static_cast<double>(random.whole(-210, 300)), 40000.0};
    }
    const LabelGrid expected = expectedOf(s, meyer(s, flood, brightness(s)), limits);
    const auto after = applied(s, flood.tool, limits);
    if (!after) {
      EXPECT_EQ(voxelsOf(expected, kValue), 0U) << sentence(after.error()) << "\n" << describe(s);
      EXPECT_EQ(after.error().kind, ErrorKind::InputRefused);
      return;
    }
    EXPECT_TRUE(sameLabels(expected, after->labels)) << describe(s);
    EXPECT_TRUE(sameTable(after->table, s.before.table));
  });
}

TEST(Split, ByEdgesEqualsMeyersFloodingOfTheSteepness) {
  int compared = 0;
  forFloods(500, 0, [&](Random&, Sample& s, Flood& flood) {
    flood.tool.by = By::Edges;
    const std::vector<double> levels = smoothness(s);
    if (!allDiffer(levels)) return;
    ++compared;
    const LabelGrid expected = expectedOf(s, meyer(s, flood, levels), {});
    const auto after = applied(s, flood.tool);
    if (!after) {
      EXPECT_EQ(voxelsOf(expected, kValue), 0U) << sentence(after.error()) << "\n" << describe(s);
      return;
    }
    EXPECT_TRUE(sameLabels(expected, after->labels)) << describe(s);
  });
  EXPECT_GT(compared, 200);
}

/// The brightest level at which each voxel is joined to one of the seeds, by lowering the water.
std::vector<double> joinedAt(const Sample& s, const Part& seeds) {
  std::vector<double> levels(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) levels[i] = s.volume.value(i);
  std::sort(levels.begin(), levels.end(), std::greater<>());
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  std::vector<double> joined(s.size(), -std::numeric_limits<double>::infinity());
  for (const double level : levels) {
    Mask above(s.size(), 0);
    for (std::size_t i = 0; i < s.size(); ++i) {
      above[i] = s.holds(i) && s.volume.value(i) >= level ? 1 : 0;
    }
    const Mask reached = flooded(above, seeds, s.geometry(), 26);
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (reached[i] != 0) joined[i] = std::max(joined[i], level);
    }
  }
  return joined;
}

/// Holds for any order of ties.
TEST(Split, EveryVoxelIsWithASeedThatTheBrightestWayLeadsTo) {
  for (const std::size_t levels : {std::size_t{2}, std::size_t{5}, std::size_t{0}}) {
    forFloods(200, levels, [&](Random&, Sample& s, Flood& flood) {
      SCOPED_TRACE("levels " + std::to_string(levels));
      const auto after = applied(s, flood.tool);
      if (!after) {
        EXPECT_EQ(after.error().kind, ErrorKind::InputRefused);
        EXPECT_EQ(std::count(flood.values.begin(), flood.values.end(), kValue), 0);
        return;
      }
      std::map<std::uint8_t, std::vector<double>> joined;
      for (const std::uint8_t value : {std::uint8_t{1}, kValue, std::uint8_t{9}}) {
        Part seeds;
        for (std::size_t n = 0; n < flood.seeds.size(); ++n) {
          if (flood.values[n] == value) seeds.push_back(flood.seeds[n]);
        }
        joined[value] = joinedAt(s, seeds);
      }
      for (std::size_t i = 0; i < s.size(); ++i) {
        if (!s.holds(i)) {
          ASSERT_EQ(after->labels.labels[i], s.before.labels.labels[i]);
          continue;
        }
        ASSERT_TRUE(kTargets.size() == 3 && joined.contains(after->labels.labels[i]))
            << "the parts together are the label as it was";
        double best = -std::numeric_limits<double>::infinity();
        for (const auto& [value, level] : joined) best = std::max(best, level[i]);
        if (std::isinf(best)) {
          ASSERT_EQ(after->labels.labels[i], kValue) << "a part without a seed stays";
        } else {
          ASSERT_EQ(joined[after->labels.labels[i]][i], best) << i << "\n" << describe(s);
        }
      }
      for (std::size_t n = 0; n < flood.seeds.size(); ++n) {
        ASSERT_EQ(after->labels.labels[flood.seeds[n]], flood.values[n]) << "a seed is in its part";
      }
    });
  }
}

TEST(Split, TheOrderOfTheSeedsDoesNotMatter) {
  forFloods(200, 0, [](Random& random, Sample& s, Flood& flood) {
    const auto first = applied(s, flood.tool);
    std::shuffle(flood.tool.seeds.begin(), flood.tool.seeds.end(), random.bits());
    for (auto& seeds : flood.tool.seeds) {
      std::reverse(seeds.points_mm.begin(), seeds.points_mm.end());
    }
    const auto second = applied(s, flood.tool);
    ASSERT_EQ(first.has_value(), second.has_value());
    if (first) {
      EXPECT_TRUE(sameLabels(first->labels, second->labels)) << describe(s);
    }
  });
}

/// Two bright balls along `axis` with a dark neck in the middle: the neck's darkest is at 20.
Sample twoBalls(int axis) {
  std::array<std::int32_t, 3> dims{15, 15, 15};
  dims[static_cast<std::size_t>(axis)] = 41;
  Sample s = plainSample(dims, {0.7, 0.5, 1.1});
  Random random(3);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Voxel v = voxelOf(s.geometry(), i);
    const std::array<int, 3> at{v.i, v.j, v.k};
    const auto a = static_cast<std::size_t>(axis);
    const double side = std::hypot(at[(a + 1) % 3] - 7, at[(a + 2) % 3] - 7);
    const double ball = std::hypot(side, std::min(std::abs(at[a] - 8), std::abs(at[a] - 32)));
    s.volume.int16[i] = static_cast<std::int16_t>(-1000 + random.whole(0, 20));
    if (ball <= 6.5) {
      s.before.labels.labels[i] = kValue;
      s.volume.int16[i] = static_cast<std::int16_t>(1000 + random.whole(0, 200));
    } else if (side <= 2.0 && at[a] >= 8 && at[a] <= 32) {
      s.before.labels.labels[i] = kValue;
      s.volume.int16[i] =
          static_cast<std::int16_t>(400 + 50 * std::abs(at[a] - 20) + random.whole(0, 20));
    }
  }
  return s;
}

TEST(Split, BallsMeetInTheirDarkNeck) {
  for (int axis = 0; axis < 3; ++axis) {
    SCOPED_TRACE("axis " + std::to_string(axis));
    const Sample s = twoBalls(axis);
    std::array<double, 3> low{7, 7, 7};
    std::array<double, 3> high{7, 7, 7};
    low[static_cast<std::size_t>(axis)] = 5;
    high[static_cast<std::size_t>(axis)] = 36;
    tool::Split tool;
    tool.seeds = {{"nerve", {at_mm(s.geometry(), high[0], high[1], high[2])}},
                  {kLabel, {at_mm(s.geometry(), low[0], low[1], low[2])}}};
    const auto after = applied(s, tool);
    ASSERT_TRUE(after) << sentence(after.error());
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (!s.holds(i)) continue;
      const Voxel v = voxelOf(s.geometry(), i);
      const int along = std::array{v.i, v.j, v.k}[static_cast<std::size_t>(axis)];
      if (along < 20) {
        EXPECT_EQ(after->labels.labels[i], kValue) << along;
      }
      if (along > 20) {
        EXPECT_EQ(after->labels.labels[i], 9) << along;
      }
      if (HasFailure()) return;
    }
  }
}

TEST(Split, EdgesMeetWhereGreyValuesChange) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool brightFirst : {false, true}) {
      std::array<std::int32_t, 3> dims{9, 8, 7};
      dims[static_cast<std::size_t>(axis)] = 40;
      Sample s = plainSample(dims, {0.7, 0.5, 1.1});
      Random random(17);
      for (std::size_t i = 0; i < s.size(); ++i) {
        const Voxel v = voxelOf(s.geometry(), i);
        const int along = std::array{v.i, v.j, v.k}[static_cast<std::size_t>(axis)];
        const bool bright = (along < 27) == brightFirst;
        s.volume.int16[i] = static_cast<std::int16_t>((bright ? 900 : 100) + random.whole(0, 40));
        s.before.labels.labels[i] = kValue;
      }
      std::array<double, 3> low{3, 3, 3};
      std::array<double, 3> high{3, 3, 3};
      low[static_cast<std::size_t>(axis)] = 4;
      high[static_cast<std::size_t>(axis)] = 37;
      tool::Split tool{.by = tool::Split::By::Edges};
      tool.seeds = {{kLabel, {at_mm(s.geometry(), low[0], low[1], low[2])}},
                    {"nerve", {at_mm(s.geometry(), high[0], high[1], high[2])}}};
      const auto after = applied(s, tool);
      ASSERT_TRUE(after) << sentence(after.error());
      for (std::size_t i = 0; i < s.size(); ++i) {
        const Voxel v = voxelOf(s.geometry(), i);
        const int along = std::array{v.i, v.j, v.k}[static_cast<std::size_t>(axis)];
        // The two voxels beside the step are equally steep and belong to either.
        if (along < 26) {
          ASSERT_EQ(after->labels.labels[i], kValue) << axis << " " << along;
        }
        if (along > 27) {
          ASSERT_EQ(after->labels.labels[i], 9) << axis << " " << along;
        }
      }
    }
  }
}

TEST(Split, MakesNewLabelsOnTheLowestFreeValues) {
  Sample s = twoBalls(0);
  tool::Split tool;
  tool.seeds = {{"left", {at_mm(s.geometry(), 5, 7, 7)}},
                {"right", {at_mm(s.geometry(), 36, 7, 7)}}};
  // The ball in the middle of nowhere keeps the label from being empty.
  s.before.labels.labels[0] = kValue;
  const auto after = applied(s, tool);
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(after->labels.labels[0], kValue) << "a part without a seed stays";
  ASSERT_EQ(after->table.size(), 5U);
  EXPECT_EQ(after->table[3].name, "left");
  EXPECT_EQ(after->table[3].value, 2);
  EXPECT_EQ(after->table[4].name, "right");
  EXPECT_EQ(after->table[4].value, 3);
  EXPECT_EQ(after->labels.at(5, 7, 7), 2);
  EXPECT_EQ(after->labels.at(36, 7, 7), 3);
}

TEST(Split, WhatLeavesTheLabelEmptyIsRefused) {
  const Sample s = twoBalls(1);
  tool::Split tool;
  tool.seeds = {{"left", {at_mm(s.geometry(), 7, 5, 7)}},
                {"right", {at_mm(s.geometry(), 7, 36, 7)}}};
  expectRefused(s, tool, ErrorKind::InputRefused);
}

TEST(Split, ASeedOutsideTheScanIsRefused) {
  const Sample s = twoBalls(2);
  for (const By by : {By::Brightness, By::Edges}) {
    tool::Split tool{.by = by};
    tool.seeds = {{kLabel, {at_mm(s.geometry(), 7, 7, 5)}},
                  {"right", {at_mm(s.geometry(), 7, 7, 36), at_mm(s.geometry(), 7, 15.0, 36)}}};
    expectRefused(s, tool, ErrorKind::InputRefused);
  }
}

/// A bright ball along x in a dark rim, then a second; the label is all of them.
Sample rims() {
  Sample s = plainSample({31, 9, 9}, {0.5, 1.0, 0.8});
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Voxel v = voxelOf(s.geometry(), i);
    s.before.labels.labels[i] = kValue;
    // Bright in the middle of each half, darkest at x = 15 and at the ends.
    s.volume.int16[i] = static_cast<std::int16_t>(100 * std::min(std::abs(v.i - 15), 7) +
                                                  (v.i == 0 || v.i == 30 ? -900 : 0));
  }
  return s;
}

/// Seeds that are balls: every voxel of the label within the radius (centre to centre of the seed's
/// voxel), in mm on each axis, belongs to its seed whatever its value.
TEST(Split, VoxelsWithinTheRadiusOfASeedAreItsOwn) {
  const Sample s = rims();
  for (const double radius : {1.0, 1.5, 2.0, 3.3}) {
    SCOPED_TRACE(radius);
    tool::Split tool;
    tool.radius_mm = radius;
    // Off its voxel's centre: the ball is about the voxel.
    const Eigen::Vector3d seed = at_mm(s.geometry(), 18.3, 4, 4);
    tool.seeds = {{kLabel, {at_mm(s.geometry(), 6, 4, 4)}}, {"nerve", {seed}}};
    tool.seeds[0].points_mm.push_back(at_mm(s.geometry(), 24, 4, 4));
    const auto after = applied(s, tool);
    ASSERT_TRUE(after) << sentence(after.error());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Voxel v = voxelOf(s.geometry(), i);
      const double apart = (centre_mm(s.geometry(), i) - at_mm(s.geometry(), 18, 4, 4)).norm();
      // The seed's dark side is reached from the bright seeds first, but for the ball.
      const bool otherBall = std::any_of(
          tool.seeds[0].points_mm.begin(), tool.seeds[0].points_mm.end(), [&](const auto& other) {
            return (centre_mm(s.geometry(), i) - other).norm() <= radius + 1e-6;
          });
      if (otherBall) continue;
      if (apart <= radius + 1e-9) {
        ASSERT_EQ(after->labels.labels[i], 9) << v.i << " " << v.j << " " << v.k;
      }
    }
  }
}

/// On a scan of one value with a corner of the label per seed, what is beyond the label stays.
TEST(Split, TheRadiusTakesNothingBeyondTheLabel) {
  forSamples(300, [](Random& random, Sample& s) {
    Part held;
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (s.holds(i)) held.push_back(i);
    }
    if (held.size() < 2) return;
    std::shuffle(held.begin(), held.end(), random.bits());
    tool::Split tool;
    tool.radius_mm = random.real(0.1, 6.0);
    tool.seeds = {{kLabel, {centre_mm(s.geometry(), held[0])}},
                  {"nerve", {centre_mm(s.geometry(), held[1])}}};
    const auto after = applied(s, tool);
    ASSERT_TRUE(after) << sentence(after.error());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const std::uint8_t is = after->labels.labels[i];
      if (!s.holds(i)) {
        ASSERT_EQ(is, s.before.labels.labels[i]) << describe(s);
        continue;
      }
      // The first seed's ball comes first; then the second's, where the first's is not.
      const double first = (centre_mm(s.geometry(), i) - tool.seeds[0].points_mm[0]).norm();
      const double second = (centre_mm(s.geometry(), i) - tool.seeds[1].points_mm[0]).norm();
      if (std::abs(first - tool.radius_mm) < 1e-6 || std::abs(second - tool.radius_mm) < 1e-6) {
        continue;
      }
      if (first < tool.radius_mm && i != held[1]) {
        ASSERT_EQ(is, kValue) << describe(s);
      } else if (first > tool.radius_mm && second < tool.radius_mm) {
        ASSERT_EQ(is, 9) << describe(s);
      }
    }
  });
}

TEST(Split, TheRadiusIsWithinItsRange) {
  const Sample s = rims();
  tool::Split tool;
  tool.seeds = {{kLabel, {at_mm(s.geometry(), 6, 4, 4)}},
                {"nerve", {at_mm(s.geometry(), 24, 4, 4)}}};
  for (const double radius : {-0.1, std::numeric_limits<double>::quiet_NaN(), 1e9}) {
    tool.radius_mm = radius;
    expectRefused(s, tool, ErrorKind::Usage);
  }
  tool.radius_mm = 2.0;
  const auto after = applied(s, tool);
  ASSERT_TRUE(after);
}

}  // namespace
}  // namespace palpate::test
