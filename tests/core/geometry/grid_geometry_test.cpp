#include "core/geometry/grid_geometry.h"

#include <gtest/gtest.h>

#include "core/geometry/triangle_mesh.h"

namespace palpate {
namespace {

GridGeometry oblique() {
  GridGeometry grid;
  grid.dims = {5, 7, 3};
  grid.spacing = {0.4e-3, 0.5e-3, 1.2e-3};
  grid.X_PV = Eigen::Translation3d(0.1, -0.2, 0.3) *
              Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  return grid;
}

TEST(GridGeometry, VoxelBoxesAreHalfOpen) {
  const GridGeometry grid = oblique();
  const Eigen::Vector3d half = 0.5 * grid.spacing;
  const Eigen::Vector3d centre = grid.centre_V(2, 3, 1);
  using Voxel = std::array<std::int32_t, 3>;
  EXPECT_EQ(grid.voxelAt(centre), (Voxel{2, 3, 1}));
  EXPECT_EQ(grid.voxelAt(centre - 0.999 * half), (Voxel{2, 3, 1}));
  EXPECT_EQ(grid.voxelAt(centre + 1.001 * half), (Voxel{3, 4, 2}));
  EXPECT_EQ(grid.voxelAt(Eigen::Vector3d(-1, -1, -1)), (Voxel{-2, -2, -2}));
}

TEST(GridGeometry, CornersFollowTheDirection) {
  const GridGeometry grid = oblique();
  const auto corners = grid.cornerCentres_P();
  EXPECT_LT((corners[0] - grid.X_PV.translation()).norm(), 1e-15);
  EXPECT_LT((corners[7] - grid.X_PV * grid.centre_V(4, 6, 2)).norm(), 1e-15);
  GridGeometry moved = grid;
  moved.X_PV.translation().x() += 1e-3;
  EXPECT_NEAR(grid.cornerDistance(moved), 1e-3, 1e-12);
}

TEST(TriangleMesh, ClosedTetrahedronHasItsVolumeAndAnOpenOneIsSeen) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  EXPECT_TRUE(isClosed(mesh));
  EXPECT_NEAR(signedVolume(mesh), 1.0 / 6.0, 1e-15);
  mesh.triangles.pop_back();
  EXPECT_FALSE(isClosed(mesh));
  mesh.triangles.push_back({0, 2, 3});  // the right face, turned inside out
  EXPECT_FALSE(isClosed(mesh));
}

}  // namespace
}  // namespace palpate
