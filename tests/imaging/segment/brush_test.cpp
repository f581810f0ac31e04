/// tool::Brush against distances of centres to the path.

#include <algorithm>
#include <cmath>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

/// The point of the path nearest to p.
Eigen::Vector3d nearestOnPath(const std::vector<Eigen::Vector3d>& path, const Eigen::Vector3d& p) {
  Eigen::Vector3d best = path.front();
  for (std::size_t n = 0; n + 1 < path.size(); ++n) {
    const Eigen::Vector3d along = path[n + 1] - path[n];
    const double length = std::max(along.squaredNorm(), 1e-300);
    const double t = std::clamp((p - path[n]).dot(along) / length, 0.0, 1.0);
    const Eigen::Vector3d at = path[n] + t * along;
    if ((p - at).norm() < (p - best).norm()) best = at;
  }
  return best;
}

/// Through the scan, with points given twice.
std::vector<Eigen::Vector3d> randomPath(Random& random, const Sample& s) {
  std::vector<Eigen::Vector3d> path;
  for (int n = random.whole(1, 4); n > 0; --n) {
    const auto at = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
    path.push_back(somewhereIn_mm(random, s.geometry(), at));
    if (random.chance(20)) path.push_back(path.back());
  }
  return path;
}

Mask stroked(const Sample& s, const Mask& stroke, bool erase) {
  Mask wanted = s.label();
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (stroke[i] != 0) wanted[i] = erase ? 0 : 1;
  }
  return wanted;
}

TEST(Brush, ABallPaintsAndErasesWithinItsRadiusOfThePath) {
  forSamples(500, [](Random& random, Sample& s) {
    tool::Brush tool;
    tool.path_mm = randomPath(random, s);
    tool.radius_mm = random.real(0.3, 5.0);
    tool.erase = random.chance(50);
    Mask stroke(s.size());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Eigen::Vector3d p = centre_mm(s.geometry(), i);
      stroke[i] = (p - nearestOnPath(tool.path_mm, p)).norm() <= tool.radius_mm ? 1 : 0;
    }
    expectEdit(s, tool, randomLimits(random), stroked(s, stroke, tool.erase));
  });
}

/// Across an axis of the scan: the slice that holds the path, within the radius in its plane.
TEST(Brush, ADiskPaintsOneSlice) {
  forSamples(500, [](Random& random, Sample& s) {
    const GridGeometry& g = s.geometry();
    const int axis = random.whole(0, 2);
    tool::Brush tool;
    tool.normal = g.X_PV.linear().col(axis) * (random.chance(50) ? 1.0 : -1.0);
    tool.radius_mm = random.real(0.3, 5.0);
    tool.erase = random.chance(30);
    const int slice = random.whole(0, g.dims[static_cast<std::size_t>(axis)] - 1);
    const double off = random.real(-0.4, 0.4);
    for (int n = random.whole(1, 4); n > 0; --n) {
      Eigen::Vector3d at(random.real(-0.4, g.dims[0] - 0.6), random.real(-0.4, g.dims[1] - 0.6),
                         random.real(-0.4, g.dims[2] - 0.6));
      at[axis] = slice + off;
      tool.path_mm.push_back(at_mm(g, at.x(), at.y(), at.z()));
    }
    Mask stroke(s.size(), 0);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Voxel v = voxelOf(g, i);
      if (std::array{v.i, v.j, v.k}[static_cast<std::size_t>(axis)] != slice) continue;
      Eigen::Vector3d at(v.i, v.j, v.k);
      at[axis] = slice + off;
      const Eigen::Vector3d p = at_mm(g, at.x(), at.y(), at.z());
      stroke[i] = (p - nearestOnPath(tool.path_mm, p)).norm() <= tool.radius_mm ? 1 : 0;
    }
    expectEdit(s, tool, randomLimits(random), stroked(s, stroke, tool.erase));
  });
}

// How thick one voxel is along an oblique normal is not said: no less than the smallest spacing,
// no more than a voxel's extent along it.
TEST(Brush, AnObliqueDiskIsAboutOneVoxelThick) {
  forSamples(400, [](Random& random, Sample& s) {
    const GridGeometry& g = s.geometry();
    tool::Brush tool;
    const Eigen::Vector3d normal = random.point(-1, 1).normalized();
    tool.normal = normal;
    tool.radius_mm = random.real(0.5, 6.0);
    const auto voxel = static_cast<std::size_t>(random.whole(0, static_cast<int>(s.size()) - 1));
    const Eigen::Vector3d middle = somewhereIn_mm(random, g, voxel);
    for (int n = random.whole(1, 9); n > 0; --n) {
      const Eigen::Vector3d off = n == 1 ? Eigen::Vector3d::Zero() : random.point(-4, 4);
      const Eigen::Vector3d at = middle + off - normal * normal.dot(off);
      const auto cell = g.voxelAt(g.X_PV.inverse() * (at * 1e-3));
      if (g.contains(cell[0], cell[1], cell[2])) tool.path_mm.push_back(at);
    }
    const Eigen::Vector3d n_V = g.X_PV.linear().transpose() * normal;
    const double thickest = n_V.cwiseAbs().dot(g.spacing) * 1e3;
    const double thinnest = g.spacing.minCoeff() * 1e3;
    Mask wanted = s.label();
    Mask either(s.size(), 0);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Eigen::Vector3d p = centre_mm(g, i);
      const double away = normal.dot(p - middle);
      const Eigen::Vector3d inPlane = p - normal * away;
      if ((inPlane - nearestOnPath(tool.path_mm, inPlane)).norm() > tool.radius_mm) continue;
      if (std::abs(away) < 0.5 * thinnest - 1e-9) {
        wanted[i] = 1;
      } else if (std::abs(away) < 0.5 * thickest + 1e-9 && wanted[i] == 0) {
        either[i] = 1;
      }
    }
    expectEdit(s, tool, randomLimits(random), wanted, either);
  });
}

/// Half a voxel's extent along the normal on either side; a path off the plane of its first point
/// counts by its foot, a normal by its direction.
TEST(Brush, AnObliqueDiskIsAsThickAsAVoxelAlongItsNormal) {
  forSamples(400, [](Random& random, Sample& s) {
    const GridGeometry& g = s.geometry();
    tool::Brush tool;
    const Eigen::Vector3d normal = random.point(-1, 1).normalized();
    tool.normal = normal * random.real(0.1, 9.0);
    tool.radius_mm = random.real(0.2, 4.0);
    tool.path_mm = randomPath(random, s);
    const Eigen::Vector3d first = tool.path_mm.front();
    std::vector<Eigen::Vector3d> feet;
    for (const Eigen::Vector3d& p : tool.path_mm) {
      feet.emplace_back(p - normal * normal.dot(p - first));
    }
    const Eigen::Vector3d n_V = g.X_PV.linear().transpose() * normal;
    const double half = 0.5e3 * n_V.cwiseAbs().dot(g.spacing);
    Mask stroke(s.size(), 0);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Eigen::Vector3d p = centre_mm(g, i);
      const double away = normal.dot(p - first);
      const Eigen::Vector3d foot = p - normal * away;
      const bool in = (foot - nearestOnPath(feet, foot)).norm() <= tool.radius_mm;
      stroke[i] = in && std::abs(away) < half ? 1 : 0;
    }
    expectEdit(s, tool, randomLimits(random), stroked(s, stroke, false));
  });
}

TEST(Brush, ADiskReachesItsRimAndLiesInOneOfTwoSlices) {
  for (const double z : {4.0, 4.5}) {
    Sample s = plainSample({9, 9, 9}, {1, 1, 1});
    tool::Brush tool{.radius_mm = 3.0};
    tool.path_mm = {{4, 4, z}};
    tool.normal = Eigen::Vector3d(0, 0, 1);
    const auto after = applied(s, tool);
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_EQ(voxelsOf(after->labels, kValue), 29U) << "pairs with i² + j² <= 9, at " << z;
  }
}

TEST(Brush, TheNormalIsADirection) {
  Sample s = plainSample({9, 9, 9}, {1, 1, 1});
  tool::Brush tool{.radius_mm = 3.2};
  tool.path_mm = {{4, 4, 4}};
  tool.normal = Eigen::Vector3d(0, 0, 1);
  const auto one = applied(s, tool);
  tool.normal = Eigen::Vector3d(0, 0, -7);
  const auto seven = applied(s, tool);
  ASSERT_TRUE(one) << sentence(one.error());
  ASSERT_TRUE(seven) << sentence(seven.error());
  EXPECT_TRUE(sameLabels(one->labels, seven->labels));
  EXPECT_EQ(voxelsOf(one->labels, kValue), 37U) << "pairs with i² + j² <= 10";
}

TEST(Brush, AWholeRadiusReachesItsSurface) {
  for (const int radius : {1, 3, 5, 9}) {
    Sample s = plainSample({41, 41, 41}, {1, 1, 1});
    tool::Brush tool{.radius_mm = static_cast<double>(radius)};
    tool.path_mm = {{20, 20, 20}};
    const auto after = applied(s, tool);
    ASSERT_TRUE(after) << sentence(after.error());
    std::size_t expected = 0;
    for (int k = -20; k <= 20; ++k)
      for (int j = -20; j <= 20; ++j)
        for (int i = -20; i <= 20; ++i) {
          const bool in = i * i + j * j + k * k <= radius * radius;
          expected += in ? 1 : 0;
          ASSERT_EQ(after->labels.at(20 + i, 20 + j, 20 + k), in ? kValue : 0)
              << i << " " << j << " " << k << " within " << radius;
        }
    EXPECT_EQ(voxelsOf(after->labels, kValue), expected);
  }
}

TEST(Brush, AStrokeHasNoGaps) {
  Sample s = plainSample({101, 21, 21}, {1, 1, 1});
  tool::Brush tool{.radius_mm = 2.0};
  tool.path_mm = {{0, 10, 10}, {100, 10, 10}};
  const auto after = applied(s, tool);
  ASSERT_TRUE(after);
  EXPECT_EQ(voxelsOf(after->labels, kValue), 101U * 13U) << "13 pairs with i² + j² <= 4";
}

/// What a seed or a pick is refused for, a stroke is not: drawn over the edge, it paints up to it.
TEST(Brush, AStrokeMayLeaveTheScan) {
  Sample s = plainSample({9, 5, 5}, {1, 1, 1});
  for (const bool disk : {false, true}) {
    tool::Brush tool{.radius_mm = 0.6};
    tool.path_mm = {{4, 2, 2}, {30, 2, 2}};
    if (disk) tool.normal = Eigen::Vector3d(0, 0, 1);
    const auto after = applied(s, tool);
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_EQ(voxelsOf(after->labels, kValue), 5U);
    EXPECT_EQ(after->labels.at(8, 2, 2), kValue);
    EXPECT_EQ(after->labels.at(3, 2, 2), 0);
  }
}

}  // namespace
}  // namespace palpate::test
