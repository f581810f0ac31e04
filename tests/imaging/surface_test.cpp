#include "imaging/surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/geometry/triangle_mesh.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

/// A ball in voxel coordinates (spacings differ, so it is an ellipsoid in millimetres).
LabelGrid ballGrid(std::array<std::int32_t, 3> dims, Eigen::Vector3d centre, double radius) {
  LabelGrid grid;
  grid.geometry = test::obliqueGeometry(dims[0], dims[1], dims[2]);
  grid.labels.resize(grid.geometry.voxelCount());
  for (std::int32_t k = 0; k < dims[2]; ++k)
    for (std::int32_t j = 0; j < dims[1]; ++j)
      for (std::int32_t i = 0; i < dims[0]; ++i) {
        const bool inside = (Eigen::Vector3d(i, j, k) - centre).norm() <= radius;
        grid.labels[grid.geometry.index(i, j, k)] = inside ? 4 : 0;
      }
  return grid;
}

/// The chunks as one mesh, vertices of equal bits made one.
TriangleMesh welded(const std::vector<SurfaceChunk>& chunks) {
  TriangleMesh mesh;
  std::map<std::array<float, 3>, std::uint32_t> known;
  for (const SurfaceChunk& chunk : chunks) {
    std::vector<std::uint32_t> index;
    for (std::size_t v = 0; v < chunk.vertices_mm.size(); v += 3) {
      const std::array<float, 3> p{chunk.vertices_mm[v], chunk.vertices_mm[v + 1],
                                   chunk.vertices_mm[v + 2]};
      const auto [at, isNew] = known.emplace(p, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (isNew) mesh.vertices.emplace_back(p[0], p[1], p[2]);
      index.push_back(at->second);
    }
    for (std::size_t t = 0; t < chunk.triangles.size(); t += 3) {
      mesh.triangles.push_back({index[chunk.triangles[t]], index[chunk.triangles[t + 1]],
                                index[chunk.triangles[t + 2]]});
    }
  }
  return mesh;
}

TEST(Surface, BallIsClosedAcrossChunksAndOfTheRightVolume) {
  const LabelGrid grid = ballGrid({70, 70, 70}, {34.5, 34.5, 34.5}, 25.0);
  for (const int step : {1, 2}) {
    const auto chunks = meshLabel(grid, 4, step);
    ASSERT_TRUE(chunks);
    EXPECT_GE(chunks->size(), 8U);
    const TriangleMesh mesh = welded(*chunks);
    EXPECT_TRUE(isClosed(mesh)) << "step " << step;
    const double expected =
        4.0 / 3.0 * std::numbers::pi * 25.0 * 25.0 * 25.0 * grid.geometry.spacing.prod() * 1e9;
    // Positive: counter-clockwise from outside. 2 %: a voxelised ball against the ball itself.
    EXPECT_NEAR(signedVolume(mesh), expected, 0.02 * expected) << "step " << step;
  }
}

TEST(Surface, NormalsPointOutAndAreSmooth) {
  LabelGrid grid = ballGrid({64, 64, 64}, {31.5, 31.5, 31.5}, 24.0);
  grid.geometry.spacing = Eigen::Vector3d::Constant(1e-3);
  const auto chunks = meshLabel(grid, 4, 1);
  ASSERT_TRUE(chunks);
  const Eigen::Vector3d centre_mm =
      grid.geometry.X_PV * grid.geometry.centre_V(31.5, 31.5, 31.5) * 1e3;
  double worst = 0.0;
  double sum = 0.0;
  std::size_t count = 0;
  for (const SurfaceChunk& chunk : *chunks) {
    for (std::size_t v = 0; v < chunk.vertices_mm.size(); v += 3, ++count) {
      const Eigen::Vector3d p(chunk.vertices_mm[v], chunk.vertices_mm[v + 1],
                              chunk.vertices_mm[v + 2]);
      const Eigen::Vector3d n(chunk.normals[v], chunk.normals[v + 1], chunk.normals[v + 2]);
      EXPECT_NEAR(n.norm(), 1.0, 1e-5);
      const double angle = std::acos(std::min(1.0, n.dot((p - centre_mm).normalized())));
      worst = std::max(worst, angle);
      sum += angle;
      // The surface stays within half a voxel of the ball.
      EXPECT_NEAR((p - centre_mm).norm(), 24.0, 0.6);
    }
  }
  // A blocky mask has normals up to 55 degrees off; smoothed ones stay near the true ones.
  EXPECT_LT(worst * 180.0 / std::numbers::pi, 25.0);
  EXPECT_LT(sum / static_cast<double>(count) * 180.0 / std::numbers::pi, 6.0);
}

TEST(Surface, FlatFaceStaysWhereTheVoxelsEnd) {
  LabelGrid grid;
  grid.geometry.dims = {40, 40, 40};
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  for (std::int32_t k = 0; k < 20; ++k)
    for (std::int32_t j = 0; j < 40; ++j)
      for (std::int32_t i = 0; i < 40; ++i) grid.labels[grid.geometry.index(i, j, k)] = 1;
  const auto chunks = meshLabel(grid, 1, 1);
  ASSERT_TRUE(chunks);
  bool seen = false;
  for (const SurfaceChunk& chunk : *chunks) {
    for (std::size_t v = 0; v < chunk.vertices_mm.size(); v += 3) {
      const float x = chunk.vertices_mm[v];
      const float y = chunk.vertices_mm[v + 1];
      if (x < 5 || x > 34 || y < 5 || y > 34 || chunk.vertices_mm[v + 2] < 10) continue;
      seen = true;
      EXPECT_NEAR(chunk.vertices_mm[v + 2], 19.5, 1e-3);  // between centres 19 and 20
      EXPECT_NEAR(chunk.normals[v + 2], 1.0, 1e-5);
    }
  }
  EXPECT_TRUE(seen);
}

TEST(Surface, LabelAtTheBorderOfTheScanIsClosed) {
  const LabelGrid grid = ballGrid({33, 20, 31}, {0.0, 19.0, 15.0}, 12.0);
  for (const int step : {1, 2}) {
    const auto chunks = meshLabel(grid, 4, step);
    ASSERT_TRUE(chunks);
    EXPECT_TRUE(isClosed(welded(*chunks))) << "step " << step;
  }
}

TEST(Surface, OneChunkAgainEqualsTheWhole) {
  LabelGrid grid = ballGrid({70, 40, 40}, {34, 20, 20}, 15.0);
  grid.labels[grid.geometry.index(40, 20, 34)] = 0;
  const auto chunks = meshLabel(grid, 4, 1);
  ASSERT_TRUE(chunks);
  for (const SurfaceChunk& chunk : *chunks) {
    const auto again = meshLabelChunk(grid, 4, 1, chunk.chunk);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->vertices_mm, chunk.vertices_mm);
    EXPECT_EQ(again->normals, chunk.normals);
    EXPECT_EQ(again->triangles, chunk.triangles);
  }
}

TEST(Surface, AnEditChangesOnlyChunksNearIt) {
  LabelGrid grid = ballGrid({100, 40, 40}, {50, 20, 20}, 18.0);
  const auto before = meshLabel(grid, 4, 1);
  grid.labels[grid.geometry.index(50, 20, 38)] = 0;
  const auto after = meshLabel(grid, 4, 1);
  ASSERT_TRUE(before && after);
  ASSERT_EQ(before->size(), after->size());
  std::size_t changed = 0;
  for (std::size_t c = 0; c < before->size(); ++c) {
    if ((*before)[c].vertices_mm == (*after)[c].vertices_mm) continue;
    ++changed;
    const auto& chunk = (*after)[c].chunk;
    const std::array<int, 3> edited{50, 20, 38};
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(edited[a], chunk[a] * 32 - 1 - 5);
      EXPECT_LE(edited[a], chunk[a] * 32 + 31 + 5);
    }
  }
  EXPECT_GE(changed, 1U);
}

TEST(Surface, EmptyLabelGivesNothingAndWrongStepIsRefused) {
  const LabelGrid grid = ballGrid({10, 10, 10}, {5, 5, 5}, 3.0);
  const auto none = meshLabel(grid, 9, 1);
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
  EXPECT_FALSE(meshLabel(grid, 4, 3));
}

TEST(Surface, StopsWhenCancelled) {
  CancelToken token;
  token.cancel();
  Progress progress;
  progress.cancel = &token;
  const auto chunks = meshLabel(ballGrid({10, 10, 10}, {5, 5, 5}, 3.0), 4, 1, progress);
  ASSERT_FALSE(chunks);
  EXPECT_EQ(chunks.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace palpate
