#include "core/voxels/sphere_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "core/voxels/enclosing_ball.h"

namespace palpate {
namespace {

// Rounding of a radius of a few units.
constexpr double kTiny = 1e-12;

template <int Bits>
std::vector<Eigen::Vector3d> corners(const NodeMask<Bits>& mask, const Eigen::Vector3d& cell,
                                     int level) {
  using Mask = NodeMask<Bits>;
  const double child = std::pow(2.0, Bits * (level - 1));
  std::vector<Eigen::Vector3d> out;
  forEachChild(mask, [&](int c) {
    const Eigen::Vector3d lower(c & Mask::kLow, (c >> Bits) & Mask::kLow, c >> (2 * Bits));
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d at(corner & 1, (corner >> 1) & 1, corner >> 2);
      const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * Mask::kEdge);
      out.emplace_back((child * (lower + at - half)).cwiseProduct(cell));
    }
  });
  return out;
}

TEST(SphereTable, SeventyEightOf255PatternsAreSmallerThanTheFullSphere) {
  const SphereTable table(1, Eigen::Vector3d::Ones());
  std::map<long, int> classes;  // radius relative to the full sphere, in 1e-4
  int smaller = 0;
  for (unsigned pattern = 1; pattern < 256; ++pattern) {
    const double share = table.tight8(static_cast<std::uint8_t>(pattern)).radius / std::sqrt(3.0);
    ++classes[std::lround(share * 1e4)];
    smaller += share < 1.0 - 1e-9 ? 1 : 0;
  }
  EXPECT_EQ(smaller, 78);
  const std::map<long, int> expected{{5000, 8}, {7071, 12}, {8660, 42}, {9428, 16}, {10000, 177}};
  EXPECT_EQ(classes, expected);
}

// A ball is the smallest if its centre is in the convex hull of the points on its sphere; checked
// here without any shared code: no small step of the centre lets the radius shrink.
TEST(SphereTable, NoOtherCentreGivesASmallerSphere) {
  constexpr std::uint32_t kSeed = 3;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::normal_distribution<double> normal;
  for (const Eigen::Vector3d& cell :
       {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(0.957, 0.957, 1.5), Eigen::Vector3d(1, 2, 5)}) {
    const SphereTable table(1, cell);
    for (unsigned pattern = 1; pattern < 256; ++pattern) {
      const auto& sphere = table.tight8(static_cast<std::uint8_t>(pattern));
      NodeMask<1> mask;
      mask.word[0] = pattern;
      const auto points = corners(mask, cell, 1);
      for (int trial = 0; trial < 60; ++trial) {
        const Eigen::Vector3d direction =
            Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
        for (const double step : {1e-4, 1e-2, 0.3}) {
          double radius = 0;
          for (const auto& p : points) {
            radius = std::max(radius, (p - sphere.offset - step * direction).norm());
          }
          ASSERT_GE(radius, sphere.radius - kTiny) << "pattern " << pattern;
        }
      }
    }
  }
}

TEST(SphereTable, FullRadiusFollowsTheClosedForm) {
  for (int bits = 1; bits <= 3; ++bits) {
    const double s = 0.7e-3;
    const SphereTable table(bits, Eigen::Vector3d::Constant(s));
    for (int level = 0; level * bits <= 11; ++level) {
      const double expected = s * std::pow(2.0, bits * level - 1) * std::sqrt(3.0);
      EXPECT_NEAR(table.fullRadius(level), expected, 1e-12 * expected) << bits << " " << level;
    }
  }
  EXPECT_NEAR(SphereTable(2, Eigen::Vector3d(1, 2, 2)).fullRadius(1), 6.0, kTiny);
}

template <int Bits>
void expectEnclosed(std::uint32_t seed) {
  SCOPED_TRACE("bits " + std::to_string(Bits) + ", seed " + std::to_string(seed));
  std::mt19937_64 rng(seed);
  for (const Eigen::Vector3d& cell : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(0.6, 0.9, 2.5)}) {
    const SphereTable table(Bits, cell);
    for (int trial = 0; trial < 400; ++trial) {
      NodeMask<Bits> mask;
      for (auto& w : mask.word) {
        w = rng();
        for (int thin = trial % 7; thin > 0; --thin) w &= rng();  // from half full to nearly empty
        if (Bits == 1) w &= 255;
      }
      if (mask.empty()) mask.set(static_cast<int>(rng() % NodeMask<Bits>::kChildren));
      for (const int level : {1, 2}) {
        const double full = table.fullRadius(level);
        for (const auto kind : {SphereKind::Full, SphereKind::SideOffset, SphereKind::Tight}) {
          const NodeSphere sphere = table.sphere(mask, level, kind);
          EXPECT_LE(sphere.radius, full * (1 + kTiny));
          for (const auto& p : corners(mask, cell, level)) {
            ASSERT_LE((p - sphere.offset).norm(), sphere.radius + kTiny * full);
          }
        }
        EXPECT_LE(table.sphere(mask, level, SphereKind::Tight).radius,
                  table.sphere(mask, level, SphereKind::SideOffset).radius * (1 + kTiny));
      }
    }
  }
}

TEST(SphereTable, EveryOccupiedChildIsEnclosed) {
  expectEnclosed<1>(11);
  expectEnclosed<2>(12);
  expectEnclosed<3>(13);
}

TEST(SphereTable, FullMasksGiveTheFullSphereCentred) {
  const Eigen::Vector3d cell(1, 1.5, 2);
  const auto check = [&]<int Bits>(NodeMask<Bits> mask) {
    for (int c = 0; c < NodeMask<Bits>::kChildren; ++c) mask.set(c);
    const SphereTable table(Bits, cell);
    const NodeSphere sphere = table.sphere(mask, 1, SphereKind::Tight);
    EXPECT_NEAR(sphere.radius, table.fullRadius(1), kTiny);
    EXPECT_LT(sphere.offset.norm(), kTiny);
  };
  check(NodeMask<1>{});
  check(NodeMask<2>{});
  check(NodeMask<3>{});
}

TEST(EnclosingBall, OfNothingAPointAndATriangle) {
  EXPECT_EQ(smallestEnclosingBall({}).radius, 0.0);
  const std::vector<Eigen::Vector3d> one{{1, 2, 3}};
  EXPECT_EQ(smallestEnclosingBall(one).centre, one[0]);
  // Obtuse: the longest side is the diameter.
  const std::vector<Eigen::Vector3d> obtuse{{-2, 0, 0}, {0.1, 0.3, 0}, {2, 0, 0}};
  EXPECT_NEAR(smallestEnclosingBall(obtuse).radius, 2.0, kTiny);
  // A regular tetrahedron of edge 2·sqrt(2): circumradius sqrt(3).
  const std::vector<Eigen::Vector3d> tetra{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EXPECT_NEAR(smallestEnclosingBall(tetra).radius, std::sqrt(3.0), kTiny);
}

}  // namespace
}  // namespace palpate
