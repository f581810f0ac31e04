/// tool::Margin against distances of all pairs of centres.

#include <algorithm>
#include <cmath>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

using Operation = tool::Margin::Operation;
constexpr std::array<Operation, 4> kOperations{Operation::Dilate, Operation::Erode, Operation::Open,
                                               Operation::Close};

/// Every voxel with a set one within `mm`, by all pairs.
Mask dilated(const Mask& mask, const GridGeometry& g, double mm) {
  std::vector<Eigen::Vector3d> centres;
  for (std::size_t i = 0; i < mask.size(); ++i) centres.push_back(centre_mm(g, i));
  Mask out = mask;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    for (std::size_t j = 0; j < mask.size() && out[i] == 0; ++j) {
      if (mask[j] != 0 && (centres[i] - centres[j]).norm() <= mm) out[i] = 1;
    }
  }
  return out;
}

/// As dilated(), by the offsets of a ball: for scans where all pairs are too many.
Mask dilatedByOffsets(const Mask& mask, const GridGeometry& g, double mm) {
  std::array<int, 3> reach{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double step = g.spacing[static_cast<int>(a)] * 1e3;
    reach[a] = static_cast<int>(std::min<double>(std::ceil(mm / step), g.dims[a]));
  }
  Mask out(mask.size(), 0);
  for (int dk = -reach[2]; dk <= reach[2]; ++dk)
    for (int dj = -reach[1]; dj <= reach[1]; ++dj)
      for (int di = -reach[0]; di <= reach[0]; ++di) {
        if (g.centre_V(di, dj, dk).norm() * 1e3 > mm) continue;
        for (std::size_t i = 0; i < mask.size(); ++i) {
          if (mask[i] == 0) continue;
          const Voxel v = voxelOf(g, i);
          if (!g.contains(v.i + di, v.j + dj, v.k + dk)) continue;
          out[g.index(v.i + di, v.j + dj, v.k + dk)] = 1;
        }
      }
  return out;
}

template <class Dilate>
Mask after(Operation operation, const Mask& mask, const Dilate& dilate) {
  // Beyond the scan counts as the label, so that only the background of the scan eats.
  const auto erode = [&](Mask m) {
    for (auto& x : m) x = x == 0 ? 1 : 0;
    m = dilate(m);
    for (auto& x : m) x = x == 0 ? 1 : 0;
    return m;
  };
  switch (operation) {
    case Operation::Dilate:
      return dilate(mask);
    case Operation::Erode:
      return erode(mask);
    case Operation::Open:
      return dilate(erode(mask));
    case Operation::Close:
      return erode(dilate(mask));
  }
  return {};
}

TEST(Margin, EqualsAllPairsOfCentres) {
  forSamples(400, [](Random& random, Sample& s) {
    if (countOf(s.label()) == s.size()) return;  // NothingShrinksFromTheScansEdge
    const auto dilate = [&](double mm) {
      return [&s, mm](const Mask& m) { return dilated(m, s.geometry(), mm); };
    };
    for (const Operation operation : kOperations) {
      SCOPED_TRACE("operation " + std::to_string(static_cast<int>(operation)));
      const double mm = random.real(0.2, random.chance(70) ? 3.0 : 9.0);
      SCOPED_TRACE("mm " + std::to_string(mm));
      expectEdit(s, tool::Margin{.operation = operation, .mm = mm}, randomLimits(random),
                 after(operation, s.label(), dilate(mm)));
    }
  });
}

TEST(Margin, EqualsTheOffsetsOfABallInLargerAndLongScans) {
  const std::vector<std::array<std::int32_t, 3>> sizes{
      {51, 33, 27}, {17, 49, 40}, {700, 3, 2}, {2, 700, 3}, {3, 2, 700}};
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    Sample s = plainSample(sizes[seed % sizes.size()], random.point(0.3, 1.2));
    const int percent = random.chance(50) ? 1 : 97;
    for (auto& label : s.before.labels.labels) {
      label = random.chance(percent) ? kValue : std::uint8_t{0};
    }
    if (random.chance(40)) {
      std::fill(s.before.labels.labels.begin(), s.before.labels.labels.end(), kValue);
      const int hole = random.whole(0, static_cast<int>(s.size()) - 1);
      s.before.labels.labels[static_cast<std::size_t>(hole)] = 0;
    }
    for (const Operation operation : kOperations) {
      const double mm = random.real(0.4, 3.0);
      SCOPED_TRACE("seed " + std::to_string(seed) + ", operation " +
                   std::to_string(static_cast<int>(operation)) + ", mm " + std::to_string(mm));
      const auto dilate = [&](const Mask& m) { return dilatedByOffsets(m, s.geometry(), mm); };
      expectEdit(s, tool::Margin{.operation = operation, .mm = mm}, {},
                 after(operation, s.label(), dilate));
      if (HasFailure()) return;
    }
  }
}

/// Distances of more than 255 voxels.
TEST(Margin, ReachesFarInFineScans) {
  for (int axis = 0; axis < 3; ++axis) {
    std::array<std::int32_t, 3> dims{1, 1, 1};
    dims[static_cast<std::size_t>(axis)] = 900;
    Sample s = plainSample(dims, {0.02, 0.02, 0.02});
    s.before.labels.labels[450] = kValue;
    const auto grown = applied(s, tool::Margin{.operation = Operation::Dilate, .mm = 7.01});
    ASSERT_TRUE(grown) << sentence(grown.error());
    EXPECT_EQ(voxelsOf(grown->labels, kValue), 701U);
    for (auto& label : s.before.labels.labels) label = kValue;
    s.before.labels.labels[0] = 0;
    const auto shrunk = applied(s, tool::Margin{.operation = Operation::Erode, .mm = 7.01});
    ASSERT_TRUE(shrunk) << sentence(shrunk.error());
    EXPECT_EQ(voxelsOf(shrunk->labels, kValue), 900U - 351U);
  }
}

/// Centres just as far apart as the margin is wide are within it, however millimetres round.
TEST(Margin, AWholeNumberOfVoxelsIsReached) {
  for (const double spacing : {1.0, 0.5, 0.25, 0.7}) {
    for (int n = 1; n <= 30; ++n) {
      SCOPED_TRACE(std::to_string(n) + " voxels of " + std::to_string(spacing) + " mm");
      for (int axis = 0; axis < 3; ++axis) {
        std::array<std::int32_t, 3> dims{1, 1, 1};
        dims[static_cast<std::size_t>(axis)] = 70;
        Sample s = plainSample(dims, Eigen::Vector3d::Constant(spacing));
        s.before.labels.labels[35] = kValue;
        const double mm = std::round(n * spacing * 100.0) / 100.0;  // as a person types it
        const auto grown = applied(s, tool::Margin{.operation = Operation::Dilate, .mm = mm});
        ASSERT_TRUE(grown) << sentence(grown.error());
        EXPECT_EQ(voxelsOf(grown->labels, kValue), static_cast<std::size_t>(2 * n + 1));
        for (auto& label : s.before.labels.labels) label = label == 0 ? kValue : std::uint8_t{0};
        const auto shrunk = applied(s, tool::Margin{.operation = Operation::Erode, .mm = mm});
        ASSERT_TRUE(shrunk) << sentence(shrunk.error());
        EXPECT_EQ(voxelsOf(shrunk->labels, kValue), static_cast<std::size_t>(70 - 2 * n - 1));
      }
      if (HasFailure()) return;
    }
  }
}

TEST(Margin, ABallReachesItsSurface) {
  // 3-4-5 and 1-2-2: whole distances that are not along an axis.
  for (const int mm : {3, 5, 6}) {
    Sample s = plainSample({15, 15, 15}, {1, 1, 1});
    s.before.labels.labels[s.geometry().index(7, 7, 7)] = kValue;
    const auto grown =
        applied(s, tool::Margin{.operation = Operation::Dilate, .mm = static_cast<double>(mm)});
    ASSERT_TRUE(grown) << sentence(grown.error());
    for (int k = -7; k <= 7; ++k)
      for (int j = -7; j <= 7; ++j)
        for (int i = -7; i <= 7; ++i) {
          const bool in = i * i + j * j + k * k <= mm * mm;
          ASSERT_EQ(grown->labels.at(7 + i, 7 + j, 7 + k), in ? kValue : 0)
              << i << " " << j << " " << k << " within " << mm;
        }
  }
}

TEST(Margin, NothingShrinksFromTheScansEdge) {
  Sample s = plainSample({5, 6, 7}, {1, 1, 1});
  for (auto& label : s.before.labels.labels) label = kValue;
  for (const Operation operation : kOperations) {
    const auto same = applied(s, tool::Margin{.operation = operation, .mm = 3.0});
    ASSERT_TRUE(same) << sentence(same.error());
    EXPECT_TRUE(sameLabels(s.before.labels, same->labels));
  }
}

TEST(Margin, NothingGrowsInFromTheScansEdge) {
  Sample s = plainSample({9, 9, 9}, {1, 1, 1});
  s.before.labels.labels[s.geometry().index(4, 4, 4)] = kValue;
  const auto grown = applied(s, tool::Margin{.operation = Operation::Dilate, .mm = 1.0});
  ASSERT_TRUE(grown);
  EXPECT_EQ(voxelsOf(grown->labels, kValue), 7U);
}

TEST(Margin, ShrinksAwayFromOtherLabels) {
  Sample s = plainSample({7, 1, 1}, {1, 1, 1});
  s.before.labels.labels = {9, 9, kValue, kValue, kValue, kValue, kValue};
  const auto shrunk = applied(s, tool::Margin{.operation = Operation::Erode, .mm = 1.0});
  ASSERT_TRUE(shrunk);
  EXPECT_EQ(shrunk->labels.labels, (Mask{9, 9, 0, kValue, kValue, kValue, kValue}));
}

TEST(Margin, WhatErosionLeavesNothingOfIsRefused) {
  Sample s = plainSample({5, 5, 5}, {1, 1, 1});
  s.before.labels.labels[s.geometry().index(2, 2, 2)] = kValue;
  expectRefused(s, tool::Margin{.operation = Operation::Erode, .mm = 1.0}, ErrorKind::InputRefused);
  expectRefused(s, tool::Margin{.operation = Operation::Open, .mm = 1.0}, ErrorKind::InputRefused);
  EXPECT_TRUE(applied(s, tool::Margin{.operation = Operation::Erode, .mm = 0.9}));
}

/// Opening and closing twice change nothing more, and lie on their sides of the label.
TEST(Margin, OpeningAndClosingAreIdempotent) {
  forSamples(150, [](Random& random, Sample& s) {
    const double mm = random.real(0.3, 3.0);
    for (const Operation operation : {Operation::Open, Operation::Close}) {
      const tool::Margin tool{.operation = operation, .mm = mm};
      const auto once = applied(s, tool);
      if (!once) continue;
      if (operation == Operation::Close &&
          voxelsOf(s.before.labels, 0) + voxelsOf(s.before.labels, kValue) < s.size()) {
        continue;  // Other labels keep voxels that the closing needs.
      }
      Sample again = s;
      again.before = *once;
      const auto twice = applied(again, tool);
      ASSERT_TRUE(twice);
      EXPECT_TRUE(sameLabels(once->labels, twice->labels)) << describe(s);
      for (std::size_t i = 0; i < s.size(); ++i) {
        const bool was = s.holds(i);
        const bool is = once->labels.labels[i] == kValue;
        EXPECT_TRUE(operation == Operation::Open ? was || !is : is || !was);
      }
    }
  });
}

}  // namespace
}  // namespace palpate::test
