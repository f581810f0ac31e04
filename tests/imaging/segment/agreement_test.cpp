#include "imaging/segment/agreement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

using Voxel = std::array<std::int32_t, 3>;

LabelGrid emptyGrid(const Voxel& dims, const Eigen::Vector3d& spacing_mm) {
  LabelGrid grid;
  grid.geometry = test::obliqueGeometry(dims[0], dims[1], dims[2]);
  grid.geometry.spacing = spacing_mm * 1e-3;
  grid.labels.resize(grid.geometry.voxelCount());
  return grid;
}

void fillWhere(LabelGrid& grid, const std::function<bool(const Voxel&)>& inside) {
  const auto& d = grid.geometry.dims;
  for (std::int32_t z = 0; z < d[2]; ++z)
    for (std::int32_t y = 0; y < d[1]; ++y)
      for (std::int32_t x = 0; x < d[0]; ++x) {
        if (inside({x, y, z})) grid.labels[grid.geometry.index(x, y, z)] = 1;
      }
}

// ---- The oracle: every pair of surface voxels.

bool isSet(const LabelGrid& grid, const Voxel& v) {
  return grid.geometry.contains(v[0], v[1], v[2]) && grid.at(v[0], v[1], v[2]) != 0;
}

std::vector<Voxel> surfaceOf(const LabelGrid& grid) {
  std::vector<Voxel> surface;
  const auto& d = grid.geometry.dims;
  for (std::int32_t z = 0; z < d[2]; ++z)
    for (std::int32_t y = 0; y < d[1]; ++y)
      for (std::int32_t x = 0; x < d[0]; ++x) {
        if (!isSet(grid, {x, y, z})) continue;
        if (!isSet(grid, {x - 1, y, z}) || !isSet(grid, {x + 1, y, z}) ||
            !isSet(grid, {x, y - 1, z}) || !isSet(grid, {x, y + 1, z}) ||
            !isSet(grid, {x, y, z - 1}) || !isSet(grid, {x, y, z + 1})) {
          surface.push_back({x, y, z});
        }
      }
  return surface;
}

std::vector<double> nearest(const std::vector<Voxel>& from, const std::vector<Voxel>& to,
                            const Eigen::Vector3d& spacing_mm) {
  std::vector<double> distances;
  for (const Voxel& a : from) {
    double best = 1e300;
    for (const Voxel& b : to) {
      const Eigen::Vector3d steps(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
      best = std::min(best, steps.cwiseProduct(spacing_mm).norm());
    }
    distances.push_back(best);
  }
  std::sort(distances.begin(), distances.end());
  return distances;
}

double interpolated(const std::vector<double>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(std::floor(place));
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (place - std::floor(place)) * (sorted[above] - sorted[below]);
}

/// A distance is a float: 6e-8 of it. Squares are sums of exact products to 1e-15.
void expectSummary(const DistanceSummary& found, const std::vector<double>& sorted) {
  double sum = 0.0;
  for (const double d : sorted) sum += d;
  const double tolerance = 2e-7 * std::max(sorted.back(), 1.0);
  EXPECT_NEAR(found.mean, sum / static_cast<double>(sorted.size()), tolerance);
  EXPECT_NEAR(found.median, interpolated(sorted, 0.5), tolerance);
  EXPECT_NEAR(found.p95, interpolated(sorted, 0.95), tolerance);
  EXPECT_NEAR(found.worst, sorted.back(), tolerance);
}

void expectAsByBruteForce(const LabelGrid& a, const LabelGrid& b,
                          const Eigen::Vector3d& spacing_mm) {
  const auto found = compareMasks({a, std::nullopt}, {b, std::nullopt});
  ASSERT_TRUE(found) << sentence(found.error());
  std::size_t inA = 0;
  std::size_t inB = 0;
  std::size_t common = 0;
  for (std::size_t i = 0; i < a.labels.size(); ++i) {
    inA += a.labels[i] != 0;
    inB += b.labels[i] != 0;
    common += a.labels[i] != 0 && b.labels[i] != 0;
  }
  EXPECT_EQ(found->voxels, (std::array<std::size_t, 2>{inA, inB}));
  EXPECT_EQ(found->common, common);
  const auto sum = static_cast<double>(inA + inB);
  EXPECT_DOUBLE_EQ(found->dice, 2.0 * static_cast<double>(common) / sum);
  EXPECT_DOUBLE_EQ(found->jaccard,
                   static_cast<double>(common) / (sum - static_cast<double>(common)));
  const double voxel = spacing_mm.prod();
  EXPECT_NEAR(found->mm3[0], static_cast<double>(inA) * voxel, 1e-9 * sum * voxel);
  EXPECT_NEAR(found->mm3[1], static_cast<double>(inB) * voxel, 1e-9 * sum * voxel);
  const auto surfaceA = surfaceOf(a);
  const auto surfaceB = surfaceOf(b);
  if (surfaceA.empty() || surfaceB.empty()) {
    EXPECT_FALSE(found->surface.has_value());
    return;
  }
  ASSERT_TRUE(found->surface.has_value());
  EXPECT_EQ(found->surface->voxels, (std::array<std::size_t, 2>{surfaceA.size(), surfaceB.size()}));
  const auto there = nearest(surfaceA, surfaceB, spacing_mm);
  const auto back = nearest(surfaceB, surfaceA, spacing_mm);
  expectSummary(found->surface->aToB, there);
  expectSummary(found->surface->bToA, back);
  std::vector<double> both = there;
  both.insert(both.end(), back.begin(), back.end());
  std::sort(both.begin(), both.end());
  const DistanceSummary& symmetric = found->surface->symmetric;
  EXPECT_NEAR(symmetric.median, interpolated(both, 0.5), 2e-7 * std::max(both.back(), 1.0));
  EXPECT_EQ(symmetric.p95, std::max(found->surface->aToB.p95, found->surface->bToA.p95));
  EXPECT_EQ(symmetric.worst, std::max(found->surface->aToB.worst, found->surface->bToA.worst));
}

TEST(Agreement, EqualsBruteForceOnRandomMasks) {
  for (unsigned seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const auto side = [&random] { return static_cast<std::int32_t>(1 + random() % 13); };
    const auto length = [&random] { return 0.2 + static_cast<double>(random() % 400) * 0.01; };
    const Eigen::Vector3d spacing_mm(length(), length(), length());
    LabelGrid a = emptyGrid({side(), side(), side()}, spacing_mm);
    LabelGrid b = a;
    const auto shareA = 1 + random() % 99;  // per cent set: from dust to a block with holes
    const auto shareB = 1 + random() % 99;
    for (auto& label : a.labels) label = random() % 100 < shareA ? 1 : 0;
    for (auto& label : b.labels) label = random() % 100 < shareB ? 1 : 0;
    a.labels[random() % a.labels.size()] = 1;
    expectAsByBruteForce(a, b, spacing_mm);
  }
}

// Slices of this size are worked off a few at a time, so that columns go on from call to call.
TEST(Agreement, EqualsBruteForceWhereSlicesAreLarge) {
  std::mt19937 random(9);
  const Eigen::Vector3d spacing_mm(0.3, 0.5, 90.0);  // slices far apart, so that columns matter
  LabelGrid a = emptyGrid({2100, 1500, 9}, spacing_mm);
  LabelGrid b = a;
  for (int column = 0; column < 40; ++column) {  // several voxels in each
    const auto x = static_cast<std::int32_t>(random() % 2100);
    const auto y = static_cast<std::int32_t>(random() % 1500);
    for (std::int32_t z = 0; z < 9; ++z) {
      LabelGrid& grid = random() % 2 == 0 ? a : b;
      if (random() % 3 == 0) grid.labels[grid.geometry.index(x, y, z)] = 1;
    }
  }
  a.labels.front() = 1;
  b.labels.back() = 1;
  expectAsByBruteForce(a, b, spacing_mm);
}

TEST(Agreement, OfOneMaskWithItselfIsWhole) {
  LabelGrid a = emptyGrid({9, 8, 7}, {1, 2, 3});
  fillWhere(a, [](const Voxel& v) { return v[0] + v[1] > v[2]; });
  const auto found = compareMasks({a, std::nullopt}, {a, std::nullopt});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->dice, 1.0);
  EXPECT_EQ(found->jaccard, 1.0);
  EXPECT_EQ(found->surface->symmetric.mean, 0.0);
  EXPECT_EQ(found->surface->symmetric.worst, 0.0);
}

TEST(Agreement, OfShiftedCubesIsTheClosedForm) {
  LabelGrid a = emptyGrid({20, 20, 20}, {0.5, 2.0, 2.0});
  LabelGrid b = a;
  const auto cube = [](std::int32_t x0) {
    return [x0](const Voxel& v) {
      return v[0] >= x0 && v[0] < x0 + 10 && v[1] >= 5 && v[1] < 15 && v[2] >= 5 && v[2] < 15;
    };
  };
  fillWhere(a, cube(4));
  fillWhere(b, cube(7));
  const auto found = compareMasks({a, std::nullopt}, {b, std::nullopt});
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->dice, 0.7);
  EXPECT_DOUBLE_EQ(found->jaccard, 700.0 / 1300.0);
  EXPECT_NEAR(found->mm3[0], 2000.0, 1e-6);
  // Three voxels of 0.5 mm. The trailing face (100 voxels) is 1.5 mm off; the rings of the sides
  // (36 voxels a layer) 1.0, 0.5, then 0; of the leading face 64 are inside b, 1.5 from its face.
  const double mean = (100 * 1.5 + 36 * 1.0 + 36 * 0.5 + 64 * 1.5) / 488.0;
  EXPECT_EQ(found->surface->voxels, (std::array<std::size_t, 2>{488, 488}));
  for (const DistanceSummary& way :
       {found->surface->aToB, found->surface->bToA, found->surface->symmetric}) {
    EXPECT_NEAR(way.mean, mean, 1e-12);
    EXPECT_EQ(way.median, 0.0);  // 252 of 488: the rings from the fourth layer on
    EXPECT_EQ(way.p95, 1.5);
    EXPECT_EQ(way.worst, 1.5);
  }
}

TEST(Agreement, OfConcentricBallsIsTheDifferenceOfTheirRadii) {
  LabelGrid inner = emptyGrid({64, 64, 44}, {0.5, 0.5, 0.75});
  LabelGrid outer = inner;
  const auto ball = [](double radius_mm) {
    return [radius_mm](const Voxel& v) {
      const Eigen::Vector3d p(0.5 * v[0] - 15.75, 0.5 * v[1] - 15.75, 0.75 * v[2] - 16.125);
      return p.norm() <= radius_mm;
    };
  };
  fillWhere(inner, ball(9.0));
  fillWhere(outer, ball(14.0));
  const auto found = compareMasks({inner, std::nullopt}, {outer, std::nullopt});
  ASSERT_TRUE(found);
  // A ball counted in voxels is within 1 % of its volume at these radii (4.2 is below 4 pi / 3).
  const double small = 9.0 * 9.0 * 9.0;
  const double large = 14.0 * 14.0 * 14.0;
  EXPECT_NEAR(found->mm3[0], 4.0 / 3.0 * std::numbers::pi * small, 0.01 * 4.2 * small);
  EXPECT_NEAR(found->dice, 2.0 * small / (small + large), 0.005);
  EXPECT_NEAR(found->jaccard, small / large, 0.005);
  // Surface voxels lie up to one diagonal of a voxel (1.03 mm) inside their ball.
  for (const DistanceSummary& way : {found->surface->aToB, found->surface->bToA}) {
    EXPECT_NEAR(way.mean, 5.0, 0.3);
    EXPECT_GT(way.median, 5.0 - 1.03);
    EXPECT_LT(way.worst, 5.0 + 1.03);
  }
}

TEST(Agreement, TheScansEdgeIsASurface) {
  LabelGrid a = emptyGrid({5, 6, 7}, {1, 1, 1});
  fillWhere(a, [](const Voxel&) { return true; });
  const auto found = compareMasks({a, std::nullopt}, {a, std::nullopt});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->surface->voxels[0], std::size_t{5 * 6 * 7 - 3 * 4 * 5});
}

TEST(Agreement, ComparesTheValueThatIsAskedFor) {
  LabelGrid a = emptyGrid({4, 1, 1}, {1, 1, 1});
  LabelGrid b = a;
  a.labels = {0, 3, 3, 2};
  b.labels = {1, 0, 7, 0};
  const auto one = compareMasks({a, std::uint8_t{3}}, {b, std::uint8_t{7}});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->voxels, (std::array<std::size_t, 2>{2, 1}));
  EXPECT_EQ(one->common, 1U);
  const auto all = compareMasks({a, std::nullopt}, {b, std::nullopt});
  ASSERT_TRUE(all);
  EXPECT_EQ(all->voxels, (std::array<std::size_t, 2>{3, 2}));
}

TEST(Agreement, WithAnEmptyMaskHasNoSurfaceDistance) {
  LabelGrid a = emptyGrid({4, 4, 4}, {1, 1, 1});
  const LabelGrid none = a;
  a.labels[5] = 1;
  for (const auto& found : {compareMasks({a, std::nullopt}, {none, std::nullopt}),
                            compareMasks({none, std::nullopt}, {a, std::nullopt})}) {
    ASSERT_TRUE(found);
    EXPECT_EQ(found->dice, 0.0);
    EXPECT_EQ(found->jaccard, 0.0);
    EXPECT_FALSE(found->surface.has_value());
  }
  const auto nothing = compareMasks({none, std::nullopt}, {none, std::nullopt});
  ASSERT_FALSE(nothing);
  EXPECT_EQ(sentence(nothing.error()),
            "Both masks are empty, so there is nothing to compare. Field: voxels. Found: no voxel "
            "in either. Expected: a voxel in one of them. Choose labels that hold something.");
}

TEST(Agreement, OnOtherGridsIsRefused) {
  const LabelGrid a = emptyGrid({4, 5, 6}, {1, 1, 1});
  const LabelGrid counts = emptyGrid({4, 5, 7}, {1, 1, 1});
  const auto otherCounts = compareMasks({a, std::nullopt}, {counts, std::nullopt});
  ASSERT_FALSE(otherCounts);
  EXPECT_EQ(sentence(otherCounts.error()),
            "The two masks do not lie on the same grid. Field: geometry. Found: 4 x 5 x 7 voxels. "
            "Expected: 4 x 5 x 6 voxels at the same place. Resample one onto the other's grid in "
            "the program that made it.");
  LabelGrid moved = a;
  moved.geometry.X_PV.translation().x() += 2e-6;
  const auto otherPlace = compareMasks({a, std::nullopt}, {moved, std::nullopt});
  ASSERT_FALSE(otherPlace);
  EXPECT_EQ(otherPlace.error().found, "4 x 5 x 6 voxels, corners up to 0.002000 mm away");
  EXPECT_EQ(otherPlace.error().kind, ErrorKind::InputRefused);
}

TEST(Agreement, StopsWhenCancelled) {
  LabelGrid a = emptyGrid({4, 4, 4}, {1, 1, 1});
  a.labels[5] = 1;
  CancelToken token;
  token.cancel();
  Progress progress;
  progress.cancel = &token;
  const auto found = compareMasks({a, std::nullopt}, {a, std::nullopt}, progress);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::Cancelled);
}

TEST(Agreement, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(3);
  LabelGrid a = emptyGrid({60, 70, 80}, {0.7, 0.9, 1.1});
  LabelGrid b = a;
  for (auto& label : a.labels) label = random() % 100 < 2 ? 1 : 0;
  for (auto& label : b.labels) label = random() % 100 < 1 ? 1 : 0;
  const auto many = compareMasks({a, std::nullopt}, {b, std::nullopt});
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto single = compareMasks({a, std::nullopt}, {b, std::nullopt});
  ASSERT_TRUE(many && single);
  EXPECT_EQ(many->surface->symmetric.mean, single->surface->symmetric.mean);
  EXPECT_EQ(many->surface->aToB.p95, single->surface->aToB.p95);
  EXPECT_EQ(many->surface->bToA.median, single->surface->bToA.median);
}

}  // namespace
}  // namespace palpate
