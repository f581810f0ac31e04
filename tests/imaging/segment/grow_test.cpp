/// tool::GrowRegion against a breadth-first flood from the seeds.

#include <algorithm>
#include <sstream>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

struct Seeded {
  tool::GrowRegion tool;
  Part voxels;
};

Seeded randomSeeds(Random& random, const Sample& s) {
  Seeded out;
  out.tool.range = randomRange(random);
  for (int n = random.whole(1, 3); n > 0; --n) {
    out.voxels.push_back(static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1)));
    out.tool.seeds_mm.push_back(somewhereIn_mm(random, s.geometry(), out.voxels.back()));
  }
  return out;
}

Mask maskOfRange(const Volume& volume, const ThresholdRange& range) {
  Mask mask(volume.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = inRange(volume, i, range) ? 1 : 0;
  return mask;
}

/// The label stays, whatever was found beside it.
Mask withLabel(const Sample& s, Mask mask) {
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (s.holds(i)) mask[i] = 1;
  }
  return mask;
}

TEST(GrowRegion, IsTheFloodOfTheRangeFromItsSeeds) {
  forSamples(500, [](Random& random, Sample& s) {
    const Seeded seeded = randomSeeds(random, s);
    const Mask range = maskOfRange(s.volume, seeded.tool.range);
    const Mask found = flooded(range, seeded.voxels, s.geometry(), 26);
    (countOf(found) == 0 ? expectEditOrRefusal : expectEdit)(s, seeded.tool, randomLimits(random),
                                                             withLabel(s, found), {}, false);
  });
}

// "No farther than": whether the way to a voxel may lead out of reach is not said, so that voxels
// with such a way only may go either way. All others are decided.
TEST(GrowRegion, StaysWithinReachOfTheNearestSeed) {
  forSamples(500, [](Random& random, Sample& s) {
    Seeded seeded = randomSeeds(random, s);
    for (std::size_t n = 0; n < seeded.voxels.size(); ++n) {
      seeded.tool.seeds_mm[n] = centre_mm(s.geometry(), seeded.voxels[n]);
    }
    seeded.tool.reach_mm = random.real(0.5, 10.0);
    const GridGeometry& g = s.geometry();
    std::ostringstream trace;
    trace << "range " << seeded.tool.range.low << " to " << seeded.tool.range.high << ", reach "
          << seeded.tool.reach_mm << ", seeds (of a voxel)";
    for (const Eigen::Vector3d& seed : seeded.tool.seeds_mm) {
      trace << ", " << (g.X_PV.inverse() * (seed * 1e-3)).cwiseQuotient(g.spacing).transpose();
    }
    SCOPED_TRACE(trace.str());
    const Mask range = maskOfRange(s.volume, seeded.tool.range);
    Mask most = flooded(range, seeded.voxels, g, 26);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const auto near = [&](const Eigen::Vector3d& seed) {
        return (centre_mm(g, i) - seed).norm() <= seeded.tool.reach_mm;
      };
      if (std::none_of(seeded.tool.seeds_mm.begin(), seeded.tool.seeds_mm.end(), near)) most[i] = 0;
    }
    Mask least(s.size(), 0);
    for (std::size_t n = 0; n < seeded.voxels.size(); ++n) {
      Mask near = range;
      for (std::size_t i = 0; i < s.size(); ++i) {
        if ((centre_mm(g, i) - seeded.tool.seeds_mm[n]).norm() > seeded.tool.reach_mm) near[i] = 0;
      }
      const Mask found = flooded(near, {seeded.voxels[n]}, g, 26);
      for (std::size_t i = 0; i < s.size(); ++i) least[i] |= found[i];
    }
    Mask either(s.size(), 0);
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (!s.holds(i) && least[i] != most[i]) either[i] = 1;
    }
    (countOf(least) == 0 ? expectEditOrRefusal : expectEdit)(s, seeded.tool, randomLimits(random),
                                                             withLabel(s, least), either, false);
  });
}

TEST(GrowRegion, ReachCountsFromTheSeedItself) {
  const Sample s = plainSample({9, 1, 1}, {2, 2, 2});
  tool::GrowRegion tool{.range = {0, 0}, .reach_mm = 3.5};
  tool.seeds_mm = {{8.8, 0, 0}};  // in the voxel at 8 mm; those at 6 and 12 mm are within 3.5 mm
  const auto after = applied(s, tool);
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(after->labels.labels, (Mask{0, 0, 0, kValue, kValue, kValue, kValue, 0, 0}));
}

TEST(GrowRegion, AWholeNumberOfVoxelsOfReachIsReached) {
  for (const int reach : {1, 2, 9, 13, 18}) {
    SCOPED_TRACE(reach);
    for (int axis = 0; axis < 3; ++axis) {
      std::array<std::int32_t, 3> dims{1, 1, 1};
      dims[static_cast<std::size_t>(axis)] = 40;
      const Sample s = plainSample(dims, {1, 1, 1});
      tool::GrowRegion tool{.range = {0, 0}, .reach_mm = static_cast<double>(reach)};
      tool.seeds_mm = {Eigen::Vector3d::Unit(axis) * 20.0};
      const auto after = applied(s, tool);
      ASSERT_TRUE(after) << sentence(after.error());
      EXPECT_EQ(voxelsOf(after->labels, kValue), static_cast<std::size_t>(2 * reach + 1));
    }
  }
}

TEST(GrowRegion, ASeedIsInTheVoxelWhoseBoxHoldsIt) {
  Sample s = plainSample({3, 1, 1}, {2, 1, 1});
  s.volume.int16 = {5, 6, 7};
  const auto grown = [&](double x) {
    tool::GrowRegion tool{.range = {5, 5}};
    tool.seeds_mm = {{x, 0.0, 0.0}};
    return applied(s, tool);
  };
  EXPECT_TRUE(grown(-0.99)) << "half a voxel beyond the first centre is in the scan";
  EXPECT_TRUE(grown(0.99));
  const auto outside = grown(-1.01);
  ASSERT_FALSE(outside);
  EXPECT_EQ(outside.error().kind, ErrorKind::InputRefused);
  const auto beside = grown(1.01);
  ASSERT_FALSE(beside) << "the seed is in the second voxel, which is not in the range";
  EXPECT_EQ(beside.error().kind, ErrorKind::InputRefused);
}

TEST(GrowRegion, OneSeedOutsideTheScanIsRefused) {
  const Sample s = plainSample({4, 5, 6}, {1, 1, 1});
  for (const Eigen::Vector3d& out :
       {Eigen::Vector3d(3.6, 0, 0), Eigen::Vector3d(0, 4.6, 0), Eigen::Vector3d(0, 0, 5.6),
        Eigen::Vector3d(0, 0, -0.6), Eigen::Vector3d(1e12, 0, 0), Eigen::Vector3d(0, -1e12, 0)}) {
    tool::GrowRegion tool{.range = {0, 0}};
    tool.seeds_mm = {{1, 1, 1}, out};
    expectRefused(s, tool, ErrorKind::InputRefused);
  }
}

TEST(GrowRegion, MakesANewLabelInACaseWithoutLabels) {
  Sample s = plainSample({3, 2, 1}, {1, 1, 1});
  s.before = {};
  tool::GrowRegion tool{.range = {0, 0}};
  tool.seeds_mm = {{1, 1, 0}};
  const auto after = applied(s, tool, {}, "canal");
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(after->labels.labels, Mask(6, 1));
  EXPECT_EQ(after->labels.geometry.dims, s.geometry().dims);
  ASSERT_EQ(after->table.size(), 1U);
  EXPECT_EQ(after->table[0].name, "canal");
  EXPECT_EQ(after->table[0].value, 1);
}

/// Far longer than the neighbourhoods of a small case: a way that winds through the whole scan.
TEST(GrowRegion, FollowsALongWindingWay) {
  Sample s = plainSample({41, 41, 5}, {0.3, 0.4, 0.5});
  std::size_t way = 0;
  for (int k = 0; k < 5; k += 2)
    for (int j = 0; j < 41; j += 2) {
      for (int i = 0; i < 41; ++i) s.volume.int16[s.geometry().index(i, j, k)] = 1;
      way += 41;
      if (j + 1 < 41) {
        s.volume.int16[s.geometry().index(j % 4 == 0 ? 40 : 0, j + 1, k)] = 1;
        ++way;
      }
    }
  // Layer to layer at the ends only: 0 to 2 at the end of the way, 2 to 4 at its begin.
  s.volume.int16[s.geometry().index(40, 40, 1)] = 1;
  s.volume.int16[s.geometry().index(0, 0, 3)] = 1;
  way += 2;
  tool::GrowRegion tool{.range = {1, 1}};
  tool.seeds_mm = {at_mm(s.geometry(), 0, 0, 0)};
  const auto after = applied(s, tool);
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(voxelsOf(after->labels, kValue), way);
}

}  // namespace
}  // namespace palpate::test
