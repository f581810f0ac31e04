#include "core/collision/point_shell.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace palpate {
namespace {

TriangleMesh box(const Eigen::Vector3d& half) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c) {
    mesh.vertices.emplace_back((c & 1 ? half.x() : -half.x()), (c & 2 ? half.y() : -half.y()),
                               (c & 4 ? half.z() : -half.z()));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

TriangleMesh ball(double radius, int rings) {
  TriangleMesh mesh;
  mesh.vertices.emplace_back(0, 0, radius);
  const int around = 2 * rings;
  for (int r = 1; r < rings; ++r) {
    const double theta = M_PI * r / rings;
    for (int a = 0; a < around; ++a) {
      const double phi = 2 * M_PI * a / around;
      mesh.vertices.emplace_back(radius * std::sin(theta) * std::cos(phi),
                                 radius * std::sin(theta) * std::sin(phi),
                                 radius * std::cos(theta));
    }
  }
  mesh.vertices.emplace_back(0, 0, -radius);
  const auto at = [around](int r, int a) {
    return static_cast<std::uint32_t>(1 + (r - 1) * around + a % around);
  };
  const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (int a = 0; a < around; ++a) {
    mesh.triangles.push_back({0, at(1, a), at(1, a + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, a), at(r + 1, a), at(r + 1, a + 1)});
      mesh.triangles.push_back({at(r, a), at(r + 1, a + 1), at(r, a + 1)});
    }
    mesh.triangles.push_back({at(rings - 1, a), last, at(rings - 1, a + 1)});
  }
  return mesh;
}

// Random points of the surface, area by area.
void expectCovered(const TriangleMesh& mesh, const PointShell& shell, double spacing) {
  constexpr std::uint32_t kSeed = 77;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<double> uniform(0, 1);
  double worst = 0;
  for (const auto& t : mesh.triangles) {
    for (int trial = 0; trial < 200; ++trial) {
      double u = uniform(rng);
      double v = uniform(rng);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Eigen::Vector3d a = mesh.vertices[t[0]];
      const Eigen::Vector3d p = a + u * (mesh.vertices[t[1]] - a) + v * (mesh.vertices[t[2]] - a);
      double nearest = HUGE_VAL;
      for (const auto& q : shell.points_T()) nearest = std::min(nearest, (q - p).norm());
      worst = std::max(worst, nearest);
    }
  }
  EXPECT_LE(worst, spacing);
  EXPECT_GT(worst, 0.3 * spacing) << "far more points than asked for";
}

TEST(PointShellFromMesh, NoPointOfTheSurfaceIsFartherThanTheSpacing) {
  struct Case {
    TriangleMesh mesh;
    double spacing;
  };
  const Case cases[] = {
      {box({10e-3, 6e-3, 4e-3}), 1e-3},      // faces much larger than the spacing
      {ball(3e-3, 24), 1e-3},                // triangles smaller than the spacing
      {box({20e-3, 0.2e-3, 0.2e-3}), 1e-3},  // long slivers
      {box({1e-3, 1e-3, 1e-3}), 30e-3},      // spacing larger than the body
  };
  for (const Case& c : cases) {
    const auto shell = PointShell::fromMesh(c.mesh, c.spacing);
    ASSERT_TRUE(shell);
    if (c.spacing < 10e-3) {
      expectCovered(c.mesh, *shell, c.spacing);
    }
    EXPECT_EQ(shell->points_T().size(), shell->normals_T().size());
  }
}

TEST(PointShellFromMesh, PointsOfOneSideKeepTheirDistance) {
  const double spacing = 0.5e-3;
  const auto shell = PointShell::fromMesh(ball(3e-3, 60), spacing);
  ASSERT_TRUE(shell);
  for (std::size_t i = 0; i < shell->size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (shell->normals_T()[i].dot(shell->normals_T()[j]) <= 0) continue;
      ASSERT_GE((shell->points_T()[i] - shell->points_T()[j]).norm(), 0.75 * spacing * (1 - 1e-12));
    }
  }
}

TEST(PointShellFromMesh, NormalsPointOutAndBothFacesOfABladeAreCovered) {
  const auto round = PointShell::fromMesh(ball(5e-3, 40), 0.4e-3);
  ASSERT_TRUE(round);
  for (std::size_t i = 0; i < round->size(); ++i) {
    EXPECT_GT(round->normals_T()[i].dot(round->points_T()[i].normalized()), 0.99);
    EXPECT_NEAR(round->normals_T()[i].norm(), 1.0, 1e-12);
  }
  const auto blade = PointShell::fromMesh(box({5e-3, 5e-3, 0.05e-3}), 1e-3);
  ASSERT_TRUE(blade);
  int up = 0;
  int down = 0;
  for (const auto& n : blade->normals_T()) {
    up += n.z() > 0.9 ? 1 : 0;
    down += n.z() < -0.9 ? 1 : 0;
  }
  EXPECT_GT(up, 80);
  EXPECT_GT(down, 80);
}

TEST(PointShellFromMesh, TheSameMeshGivesTheSamePoints) {
  const auto a = PointShell::fromMesh(ball(3e-3, 24), 0.7e-3);
  const auto b = PointShell::fromMesh(ball(3e-3, 24), 0.7e-3);
  ASSERT_TRUE(a && b);
  ASSERT_EQ(a->size(), b->size());
  for (std::size_t i = 0; i < a->size(); ++i) EXPECT_EQ(a->points_T()[i], b->points_T()[i]);
  double reach = 0;
  for (const auto& p : a->points_T()) reach = std::max(reach, p.norm());
  EXPECT_EQ(a->reach(), reach);
}

TEST(PointShellFromMesh, BadMeshesAreRefusedByName) {
  const auto message = [](const TriangleMesh& mesh, double spacing) {
    const auto shell = PointShell::fromMesh(mesh, spacing);
    return shell ? std::string() : shell.error().message;
  };
  const TriangleMesh good = box({1e-3, 1e-3, 1e-3});
  EXPECT_EQ(message(good, 0), "The spacing of the shell's points is not a positive length.");
  EXPECT_EQ(message(good, NAN), "The spacing of the shell's points is not a positive length.");
  EXPECT_EQ(message(good, 1e-9), "The spacing of the shell's points is too small for this mesh.");
  EXPECT_EQ(message({}, 1e-3), "The mesh has no triangles.");
  TriangleMesh open = good;
  open.triangles.pop_back();
  EXPECT_EQ(message(open, 1e-3), "The mesh is not closed, so it has no outside.");
  TriangleMesh flipped = good;
  for (auto& t : flipped.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(message(flipped, 1e-3), "The triangles of the mesh face inwards.");
  TriangleMesh wild = good;
  wild.vertices[3].x() = INFINITY;
  EXPECT_EQ(message(wild, 1e-3), "The mesh has a vertex that is not finite.");
  TriangleMesh stray = good;
  stray.triangles[0][1] = 99;
  EXPECT_EQ(message(stray, 1e-3), "A triangle of the mesh names a vertex that is not there.");
}

TEST(PointShellFromPoints, KeepsTheOrderAndNormalises) {
  const auto shell = PointShell::fromPoints({{3, 0, 0}, {0, 4, 0}}, {{0, 0, 2}, {1e-3, 0, 0}});
  ASSERT_TRUE(shell);
  EXPECT_EQ(shell->points_T()[1], Eigen::Vector3d(0, 4, 0));
  EXPECT_EQ(shell->normals_T()[0], Eigen::Vector3d::UnitZ());
  EXPECT_EQ(shell->normals_T()[1], Eigen::Vector3d::UnitX());
  EXPECT_EQ(shell->reach(), 4.0);
}

TEST(PointShellFromPoints, BadPointsAreRefusedByName) {
  const auto message = [](std::vector<Eigen::Vector3d> p, std::vector<Eigen::Vector3d> n) {
    const auto shell = PointShell::fromPoints(std::move(p), std::move(n));
    return shell ? std::string() : shell.error().message;
  };
  EXPECT_EQ(message({}, {}), "The point shell has no points.");
  EXPECT_EQ(message({{0, 0, 0}}, {}), "The point shell does not have one normal for every point.");
  EXPECT_EQ(message({{0, 0, 0}, {0, NAN, 0}}, {{0, 0, 1}, {0, 0, 1}}),
            "Point 1 of the shell is not finite.");
  EXPECT_EQ(message({{0, 0, 0}}, {{0, 0, 0}}),
            "The normal of point 0 of the shell has no direction.");
}

}  // namespace
}  // namespace palpate
