/// tool::Box against the centres in P, one by one.

#include <algorithm>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

/// Corners around two voxels of the scan or beyond it.
tool::Box randomBox(Random& random, const Sample& s) {
  tool::Box tool;
  const auto any = [&] {
    const auto i = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
    return Eigen::Vector3d(centre_mm(s.geometry(), i) + random.point(-2.0, 2.0));
  };
  const Eigen::Vector3d a = any();
  const Eigen::Vector3d b = any();
  tool.low_mm = a.cwiseMin(b);
  tool.high_mm = a.cwiseMax(b);
  tool.keepInside = random.chance(50);
  return tool;
}

bool inside(const tool::Box& box, const Eigen::Vector3d& p) {
  return p.x() >= box.low_mm.x() && p.y() >= box.low_mm.y() && p.z() >= box.low_mm.z() &&
         p.x() <= box.high_mm.x() && p.y() <= box.high_mm.y() && p.z() <= box.high_mm.z();
}

TEST(Box, TakesAwayWhatItsSideSays) {
  forSamples(400, [](Random& random, Sample& s) {
    const tool::Box tool = randomBox(random, s);
    Mask wanted = s.label();
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (inside(tool, centre_mm(s.geometry(), i)) != tool.keepInside) wanted[i] = 0;
    }
    expectEdit(s, tool, randomLimits(random), wanted);
  });
}

TEST(Box, CropsEveryLabelWhenAsked) {
  forSamples(300, [](Random& random, Sample& s) {
    tool::Box tool = randomBox(random, s);
    tool.allLabels = true;
    const EditLimits limits = randomLimits(random);
    LabelGrid expected = s.before.labels;
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (limits.only && !inRange(s.volume, i, *limits.only)) continue;
      if (inside(tool, centre_mm(s.geometry(), i)) != tool.keepInside) expected.labels[i] = 0;
    }
    const auto after = applied(s, tool, limits);
    if (voxelsOf(expected, kValue) == 0) {
      ASSERT_FALSE(after);
      EXPECT_EQ(after.error().kind, ErrorKind::InputRefused);
      return;
    }
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_TRUE(sameLabels(expected, after->labels)) << describe(s);
    EXPECT_TRUE(sameTable(after->table, s.before.table)) << "a label without voxels keeps its row";
  });
}

/// Whole millimetres in a scan of 1 mm: the faces go through centres.
TEST(Box, ItsFacesArePartOfIt) {
  for (int low = 0; low < 60; ++low) {
    SCOPED_TRACE(low);
    for (int axis = 0; axis < 3; ++axis) {
      std::array<std::int32_t, 3> dims{1, 1, 1};
      dims[static_cast<std::size_t>(axis)] = 70;
      Sample s = plainSample(dims, {1, 1, 1});
      for (auto& label : s.before.labels.labels) label = kValue;
      tool::Box tool;
      tool.low_mm = Eigen::Vector3d::Unit(axis) * low;
      tool.high_mm = Eigen::Vector3d::Unit(axis) * (low + 7);
      const auto cut = applied(s, tool);
      ASSERT_TRUE(cut);
      EXPECT_EQ(voxelsOf(cut->labels, kValue), 62U);
      tool.keepInside = true;
      const auto kept = applied(s, tool);
      ASSERT_TRUE(kept);
      EXPECT_EQ(voxelsOf(kept->labels, kValue), 8U);
      EXPECT_EQ(kept->labels.labels[static_cast<std::size_t>(low)], kValue);
      EXPECT_EQ(kept->labels.labels[static_cast<std::size_t>(low + 7)], kValue);
    }
    if (HasFailure()) return;
  }
}

TEST(Box, ItsAxesAreThoseOfThePatient) {
  Sample s = plainSample({8, 6, 4}, {1, 1, 1});
  // x of the scan runs towards -y of the patient, y towards x.
  s.volume.geometry.X_PV.linear() =
      Eigen::AngleAxisd(-1.5707963267948966, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  s.before.labels.geometry = s.volume.geometry;
  for (auto& label : s.before.labels.labels) label = kValue;
  tool::Box tool;
  tool.low_mm = {-0.5, -2.5, -0.5};
  tool.high_mm = {1.5, 0.5, 9.5};
  tool.keepInside = true;
  const auto kept = applied(s, tool);
  ASSERT_TRUE(kept);
  EXPECT_EQ(voxelsOf(kept->labels, kValue), 3U * 2U * 4U);
  EXPECT_EQ(kept->labels.at(2, 1, 3), kValue);
  EXPECT_EQ(kept->labels.at(1, 2, 0), 0);
}

}  // namespace
}  // namespace palpate::test
