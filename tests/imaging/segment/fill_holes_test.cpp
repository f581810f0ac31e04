/// tool::FillHoles against a flood of the background from the scan's edge.

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

bool atEdge(const GridGeometry& g, std::size_t index) {
  const Voxel v = voxelOf(g, index);
  return v.i == 0 || v.j == 0 || v.k == 0 || v.i == g.dims[0] - 1 || v.j == g.dims[1] - 1 ||
         v.k == g.dims[2] - 1;
}

Mask outsideOf(const Sample& s) {
  Mask outside(s.size());
  for (std::size_t i = 0; i < s.size(); ++i) outside[i] = s.holds(i) ? 0 : 1;
  return outside;
}

/// What the label alone encloses, flooded from all of the scan's edge.
Mask enclosed(const Sample& s) {
  const Mask outside = outsideOf(s);
  Part starts;
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (atEdge(s.geometry(), i)) starts.push_back(i);
  }
  Mask inside = flooded(outside, starts, s.geometry(), 6);
  for (std::size_t i = 0; i < s.size(); ++i) inside[i] = outside[i] != 0 && inside[i] == 0 ? 1 : 0;
  return inside;
}

/// "Other labels inside stay as they are", but the limits may let the tool take them: either.
Mask othersIn(const Sample& s, const Mask& hole, const EditLimits& limits) {
  Mask others(s.size(), 0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    others[i] = limits.overOthers && hole[i] != 0 && s.before.labels.labels[i] != 0 ? 1 : 0;
  }
  return others;
}

TEST(FillHoles, FillsWhatTheEdgeOfTheScanDoesNotReach) {
  forSamples(600, [](Random& random, Sample& s) {
    const Mask hole = enclosed(s);
    Mask wanted = s.label();
    for (std::size_t i = 0; i < s.size(); ++i) wanted[i] |= hole[i];
    const EditLimits limits = randomLimits(random);
    expectEdit(s, tool::FillHoles{}, limits, wanted, othersIn(s, hole, limits));
  });
}

// Whether other labels in a hole count to its size is not said: sizes between are either.
TEST(FillHoles, LeavesHolesThatAreTooLarge) {
  forSamples(600, [](Random& random, Sample& s) {
    const int voxels = random.whole(0, 9);
    const Mask hole = enclosed(s);
    Mask wanted = s.label();
    const EditLimits limits = randomLimits(random);
    Mask either = othersIn(s, hole, limits);
    for (const Part& part : partsOf(hole, s.geometry(), 6)) {
      int background = 0;
      for (const std::size_t i : part) background += s.before.labels.labels[i] == 0 ? 1 : 0;
      if (background > voxels) continue;
      const bool small = static_cast<int>(part.size()) <= voxels;
      for (const std::size_t i : part) (small ? wanted : either)[i] = 1;
    }
    for (std::size_t i = 0; i < s.size(); ++i) {
      if (s.holds(i)) either[i] = 0;
    }
    expectEdit(s, tool::FillHoles{.maxMm3 = (voxels + 0.5) * voxelMm3(s.geometry())}, limits,
               wanted, either);
  });
}

/// A closed shell with a hollow of 27 voxels, `at` the low corner of its 5³.
Sample shell(const Eigen::Vector3d& spacing_mm) {
  Sample s = plainSample({9, 9, 9}, spacing_mm);
  for (int k = 2; k < 7; ++k)
    for (int j = 2; j < 7; ++j)
      for (int i = 2; i < 7; ++i) {
        const bool face = i == 2 || i == 6 || j == 2 || j == 6 || k == 2 || k == 6;
        if (face) s.before.labels.labels[s.geometry().index(i, j, k)] = kValue;
      }
  return s;
}

TEST(FillHoles, AHoleOfJustTheVolumeIsFilled) {
  for (const auto& [spacing, mm3] :
       {std::pair{Eigen::Vector3d(1, 1, 1), 1.0}, std::pair{Eigen::Vector3d(0.5, 0.5, 0.5), 0.125},
        std::pair{Eigen::Vector3d(1, 2, 3), 6.0}, std::pair{Eigen::Vector3d(0.4, 0.5, 1.5), 0.3}}) {
    const Sample s = shell(spacing);
    const auto filled = applied(s, tool::FillHoles{.maxMm3 = 27 * mm3});
    ASSERT_TRUE(filled);
    EXPECT_EQ(voxelsOf(filled->labels, kValue), 125U) << spacing.transpose();
    const auto left = applied(s, tool::FillHoles{.maxMm3 = 26.9 * mm3});
    ASSERT_TRUE(left);
    EXPECT_EQ(voxelsOf(left->labels, kValue), 98U) << spacing.transpose();
  }
}

TEST(FillHoles, AnEdgeDoesNotLeakButAFaceDoes) {
  Sample s = shell({1, 1, 1});
  s.before.labels.labels[s.geometry().index(2, 2, 4)] = 0;  // an edge of the shell
  s.before.labels.labels[s.geometry().index(6, 6, 6)] = 0;  // a corner
  auto after = applied(s, tool::FillHoles{});
  ASSERT_TRUE(after);
  EXPECT_EQ(voxelsOf(after->labels, kValue), 125U - 2U);
  s.before.labels.labels[s.geometry().index(4, 4, 6)] = 0;
  after = applied(s, tool::FillHoles{});
  ASSERT_TRUE(after);
  EXPECT_EQ(voxelsOf(after->labels, kValue), 98U - 3U);
}

TEST(FillHoles, AnotherLabelInsideStaysAndTheRestIsFilled) {
  Sample s = shell({1, 1, 1});
  s.before.labels.labels[s.geometry().index(4, 4, 4)] = 9;
  s.before.labels.labels[s.geometry().index(3, 4, 4)] = 9;
  const auto after = applied(s, tool::FillHoles{});
  ASSERT_TRUE(after);
  EXPECT_EQ(voxelsOf(after->labels, kValue), 123U);
  EXPECT_EQ(after->labels.at(4, 4, 4), 9);
  EXPECT_EQ(after->labels.at(3, 4, 4), 9);
}

TEST(FillHoles, WhatTwoLabelsEncloseTogetherIsNotEnclosedByOne) {
  Sample s = shell({1, 1, 1});
  s.before.labels.labels[s.geometry().index(4, 4, 6)] = 1;
  const auto after = applied(s, tool::FillHoles{});
  ASSERT_TRUE(after);
  EXPECT_EQ(after->labels.labels[s.geometry().index(4, 4, 4)], 0);
  EXPECT_EQ(voxelsOf(after->labels, kValue), 97U);
}

TEST(FillHoles, EqualsTheOracleInALargeScan) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Sample s = plainSample({67, 41, 35}, {0.5, 0.6, 0.7});
    for (auto& label : s.before.labels.labels) {
      label = random.chance(static_cast<int>(60 + 4 * seed)) ? kValue : std::uint8_t{0};
    }
    const Mask hole = enclosed(s);
    Mask wanted = s.label();
    for (std::size_t i = 0; i < s.size(); ++i) wanted[i] |= hole[i];
    expectEdit(s, tool::FillHoles{}, {}, wanted);
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace palpate::test
