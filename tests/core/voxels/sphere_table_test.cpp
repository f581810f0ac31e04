#include "core/voxels/sphere_table.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
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

// From here on: tight spheres of 64 and 512 children against balls found another way.

const Eigen::Vector3d kCells[] = {{1, 1, 1}, {0.957, 0.957, 1.5}, {0.3, 1, 2.7}, {1, 1, 40}};

// Rounding of a centre: the thinnest tetrahedra of such corners lose four or five digits of 16.
constexpr double kRounding = 1e-10;

// The weights of `points[chosen]`, summing to 1, whose mean is nearest to `centre`; least squares.
Eigen::VectorXd weightsOf(const std::vector<Eigen::Vector3d>& points,
                          const std::vector<std::size_t>& chosen, const Eigen::Vector3d& centre,
                          double radius, double& error) {
  Eigen::MatrixXd A(4, static_cast<Eigen::Index>(chosen.size()));
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    A.col(static_cast<Eigen::Index>(i)) << (points[chosen[i]] - centre) / radius, 1.0;
  }
  const Eigen::Vector4d b(0, 0, 0, 1);
  Eigen::VectorXd w = A.colPivHouseholderQr().solve(b);
  error = (A * w - b).norm();
  return w;
}

// Calls f with every choice of one to four of n, until f says true.
template <class F>
bool anyChoice(std::size_t n, F&& f) {
  for (std::size_t a = 0; a < n; ++a) {
    if (f(std::vector<std::size_t>{a})) return true;
    for (std::size_t b = a + 1; b < n; ++b) {
      if (f(std::vector<std::size_t>{a, b})) return true;
      for (std::size_t c = b + 1; c < n; ++c) {
        if (f(std::vector<std::size_t>{a, b, c})) return true;
        for (std::size_t d = c + 1; d < n; ++d) {
          if (f(std::vector<std::size_t>{a, b, c, d})) return true;
        }
      }
    }
  }
  return false;
}

std::vector<Eigen::Vector3d> distinct(std::vector<Eigen::Vector3d> points) {
  const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::sort(points.begin(), points.end(), less);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// A ball that holds the points is the smallest exactly if its centre is in the convex hull of those
// on its sphere; by Caratheodory, in that of four of them.
void expectSmallest(const std::vector<Eigen::Vector3d>& points, const NodeSphere& sphere) {
  std::vector<Eigen::Vector3d> onSphere;
  for (const auto& p : points) {
    const double distance = (p - sphere.offset).norm();
    ASSERT_LE(distance, sphere.radius * (1 + kTiny));
    if (distance >= sphere.radius * (1 - kRounding)) onSphere.push_back(p);
  }
  EXPECT_TRUE(anyChoice(onSphere.size(),
                        [&](const std::vector<std::size_t>& chosen) {
                          double error = 0;
                          const auto w =
                              weightsOf(onSphere, chosen, sphere.offset, sphere.radius, error);
                          return error < 100 * kRounding && w.minCoeff() > -100 * kRounding;
                        }))
      << onSphere.size() << " on the sphere";
}

// The smallest ball of few points: of all the balls with two, three or four of them on the sphere,
// the least that holds the others.
double bruteForceRadius(const std::vector<Eigen::Vector3d>& points) {
  double best = HUGE_VAL;
  anyChoice(points.size(), [&](const std::vector<std::size_t>& chosen) {
    const Eigen::Vector3d& p0 = points[chosen[0]];
    Eigen::Vector3d centre = p0;
    if (chosen.size() > 1) {
      // Equally far from all chosen: 2 (p_i − p0)·x = |p_i − p0|^2, the solution nearest to p0.
      Eigen::MatrixXd A(static_cast<Eigen::Index>(chosen.size()) - 1, 3);
      Eigen::VectorXd b(A.rows());
      for (Eigen::Index i = 0; i < A.rows(); ++i) {
        const Eigen::Vector3d edge = points[chosen[static_cast<std::size_t>(i) + 1]] - p0;
        A.row(i) = 2 * edge.transpose();
        b[i] = edge.squaredNorm();
      }
      centre += A.completeOrthogonalDecomposition().solve(b);
    }
    const double radius = (p0 - centre).norm();
    if (radius >= best) return false;
    for (const auto& p : points) {
      if ((p - centre).norm() > radius * (1 + kRounding)) return false;
    }
    best = radius;
    return false;
  });
  return best;
}

template <int Bits>
void expectBruteForceForFewChildren(std::uint32_t seed) {
  SCOPED_TRACE("bits " + std::to_string(Bits) + ", seed " + std::to_string(seed));
  std::mt19937 rng(seed);
  for (const Eigen::Vector3d& cell : kCells) {
    const SphereTable table(Bits, cell);
    for (int trial = 0; trial < 12; ++trial) {
      NodeMask<Bits> mask;
      const int children = 1 + trial % 3;
      for (int i = 0; i < children; ++i) mask.set(static_cast<int>(rng() % (1U << (3 * Bits))));
      const double expected = bruteForceRadius(distinct(corners(mask, cell, 1)));
      const double radius = table.sphere(mask, 1, SphereKind::Tight).radius;
      EXPECT_NEAR(radius, expected, kRounding * expected) << "trial " << trial;
    }
  }
}

TEST(SphereTable, FewOf64And512ChildrenGetTheBallOfTheBruteForce) {
  expectBruteForceForFewChildren<2>(21);
  expectBruteForceForFewChildren<3>(22);
}

template <int Bits>
std::vector<NodeMask<Bits>> assortedMasks(std::uint32_t seed) {
  using Mask = NodeMask<Bits>;
  constexpr int kEdge = Mask::kEdge;
  std::mt19937_64 rng(seed);
  std::vector<Mask> all;
  for (int trial = 0; trial < 90; ++trial) {  // random, from half full to nearly empty
    Mask mask;
    for (auto& w : mask.word) {
      w = rng();
      for (int thin = trial % 9; thin > 0; --thin) w &= rng();
    }
    if (!mask.empty()) all.push_back(mask);
  }
  const auto where = [&all](auto&& holds) {
    Mask mask;
    for (int c = 0; c < Mask::kChildren; ++c) {
      if (holds(c & Mask::kLow, (c >> Bits) & Mask::kLow, c >> (2 * Bits))) mask.set(c);
    }
    if (!mask.empty()) all.push_back(mask);
  };
  where([](int, int, int) { return true; });
  where([](int x, int y, int z) { return (x + y + z) % 2 == 0; });
  where([](int x, int y, int z) { return x == y && y == z; });
  where([](int x, int y, int z) { return x == 0 && y == kEdge - 1 && z == 1; });
  where([](int x, int y, int z) { return (x == 0) + (y == 0) + (z == 0) >= 2; });
  where([](int x, int y, int z) { return x % (kEdge - 1) + y % (kEdge - 1) + z == 1; });
  for (int at = 0; at < kEdge; ++at) {  // rows, planes, wedges
    where([at](int, int y, int z) { return y == at && z == kEdge - 1 - at; });
    where([at](int x, int, int z) { return x == at && z == 1; });
    where([at](int x, int y, int) { return x == 0 && y == at; });
    where([at](int x, int, int) { return x == at; });
    where([at](int, int y, int) { return y == at; });
    where([at](int, int, int z) { return z == at; });
    where([at](int x, int y, int z) { return x + y + z == at + 1; });
    where([at](int x, int y, int z) { return x + y + z <= at; });
    where([at](int x, int y, int z) { return 2 * x + y - z > at; });
  }
  std::uniform_real_distribution<double> uniform(-0.5 * kEdge, 1.5 * kEdge);
  for (int trial = 0; trial < 60; ++trial) {  // where a surface passes: shells and parts of balls
    const Eigen::Vector3d centre(uniform(rng), uniform(rng), uniform(rng));
    const double radius = std::abs(uniform(rng)) + 1;
    where([&](int x, int y, int z) {
      const double d = (Eigen::Vector3d(x, y, z) - centre).norm() - radius;
      return trial % 2 == 0 ? std::abs(d) < 0.7 : d < 0;
    });
  }
  return all;
}

template <int Bits>
void expectSmallestForMany(std::uint32_t seed) {
  const auto masks = assortedMasks<Bits>(seed);
  for (const Eigen::Vector3d& cell : kCells) {
    const SphereTable table(Bits, cell);
    for (std::size_t i = 0; i < masks.size(); ++i) {
      SCOPED_TRACE("bits " + std::to_string(Bits) + ", seed " + std::to_string(seed) + ", mask " +
                   std::to_string(i) + ", cell of " + std::to_string(cell.z()));
      for (const int level : {1, 2}) {
        expectSmallest(distinct(corners(masks[i], cell, level)),
                       table.sphere(masks[i], level, SphereKind::Tight));
      }
    }
  }
}

TEST(SphereTable, TightSpheresOf64And512ChildrenAreTheSmallest) {
  expectSmallestForMany<2>(23);
  expectSmallestForMany<3>(24);
}

TEST(EnclosingBall, OfManyPointsOnASphereIsThatSphere) {
  std::mt19937 rng(25);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  const Eigen::Vector3d centre(3, -1, 2);
  for (int i = 0; i < 200; ++i) {
    points.push_back(centre +
                     2.5 * Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized());
  }
  const Ball ball = smallestEnclosingBall(points);
  EXPECT_NEAR(ball.radius, 2.5, kRounding);
  EXPECT_LT((ball.centre - centre).norm(), kRounding);
  points.assign(50, centre);  // all the same
  EXPECT_EQ(smallestEnclosingBall(points).radius, 0.0);
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
