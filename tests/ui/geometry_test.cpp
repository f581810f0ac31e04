/// Shapes and sections against closed forms.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/ui/synthetic_case.h"
#include "ui/arrow_shapes.h"
#include "ui/camera.h"
#include "ui/grey_normals.h"
#include "ui/scene_overlay.h"
#include "ui/slice_view.h"
#include "ui/smooth_normals.h"
#include "ui/volume_textures.h"

namespace palpate::ui {
namespace {

TEST(Sections, ABallIsCutInACircle) {
  const Instrument burr = test::syntheticBurr();  // ball of 3 mm, centre 3 mm up the shaft
  PlacedMesh placed{&burr.mesh_T.vertices, &burr.mesh_T.triangles, Eigen::Isometry3d::Identity()};
  placed.X_PT.translation() = Eigen::Vector3d(0.010, 0.020, 0.030);
  GridGeometry grid;
  grid.dims = {64, 64, 64};
  const auto segments = crossSection(placed, grid, 2, 33.0);  // voxels of 1 mm: through the centre
  ASSERT_GE(segments.size(), 16U);
  for (const auto& s : segments) {
    for (const Eigen::Vector3d& p : s) {
      EXPECT_NEAR(p.z(), 33.0, 1e-9);
      // A polygon of 32 sides (1 - cos(π/32) = 0.5 %) through a profile cut every π/13 (0.7 %).
      EXPECT_NEAR(std::hypot(p.x() - 10.0, p.y() - 20.0), 3.0, 0.04);
    }
  }
  EXPECT_TRUE(crossSection(placed, grid, 2, 20.0).empty());
}

TEST(Shapes, ArrowsAreAsLongAsToldAndFaceOutwards) {
  const Eigen::Vector3d along = Eigen::Vector3d(1, 2, -0.5).normalized();
  const DrawableMesh arrow = arrowShape({5, 6, 7}, along, 40.0, 1.5);
  double far = 0.0;
  TriangleMesh mesh;
  for (std::size_t v = 0; v < arrow.interleaved.size(); v += 6) {
    const Eigen::Vector3d p(arrow.interleaved[v], arrow.interleaved[v + 1],
                            arrow.interleaved[v + 2]);
    far = std::max(far, (p - Eigen::Vector3d(5, 6, 7)).dot(along));
    mesh.vertices.push_back(p);
  }
  for (std::size_t t = 0; t < arrow.triangles.size(); t += 3) {
    mesh.triangles.push_back({arrow.triangles[t], arrow.triangles[t + 1], arrow.triangles[t + 2]});
  }
  EXPECT_NEAR(far, 40.0, 1e-4);
  EXPECT_GT(signedVolume(mesh), 0.0);
}

TEST(Shapes, NormalsAreSmoothOnABallAndSharpOnACube) {
  TriangleMesh cube;
  for (int i = 0; i < 8; ++i) cube.vertices.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  cube.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const DrawableMesh sharp = drawable(cube, 0.7);
  for (std::size_t v = 0; v < sharp.interleaved.size(); v += 6) {
    const Eigen::Vector3f n(sharp.interleaved[v + 3], sharp.interleaved[v + 4],
                            sharp.interleaved[v + 5]);
    EXPECT_NEAR(n.cwiseAbs().maxCoeff(), 1.0F, 1e-5F);
  }
}

TEST(Camera, FramesWhatItIsTold) {
  Camera camera;
  camera.frame({-100, -80, -60}, {100, 80, 60}, 1.2);
  const Eigen::Matrix4f clip = camera.projection(1.2) * camera.view(Eigen::Vector3d::Zero());
  const Eigen::Vector4f centre = clip * Eigen::Vector4f(0, 0, 0, 1);
  EXPECT_NEAR(centre.x() / centre.w(), 0.0, 1e-4);
  // A little below the middle, so that instruments have room above.
  EXPECT_LT(centre.y(), 0.0F);
  EXPECT_GT(centre.y() / centre.w(), -0.2F);
  // The head stays up, and the patient's left is seen on the right from the front.
  const Eigen::Vector4f head = clip * Eigen::Vector4f(0, 0, 60, 1);
  const Eigen::Vector4f left = clip * Eigen::Vector4f(100, 0, 0, 1);
  EXPECT_GT(head.y() / head.w(), 0.1F);
  EXPECT_GT(left.x() / left.w(), 0.1F);
}

TEST(Camera, OrbitingKeepsTheDistanceAndNeverTurnsOver) {
  Camera camera;
  camera.frame({-1, -1, -1}, {1, 1, 1}, 1.0);
  const double before = (camera.eye_mm() - camera.target_mm).norm();
  for (int i = 0; i < 200; ++i) camera.orbit(0.05, 0.09);
  EXPECT_NEAR((camera.eye_mm() - camera.target_mm).norm(), before, 1e-9);
  EXPECT_GT((camera.q_PC * Eigen::Vector3d::UnitY()).z(), 0.0) << "the head points up";
}

TEST(Hand, ThePixelsOfTheMouseAreTheMillimetresOfTheView) {
  Camera camera;
  camera.lookFrom({0, -1, 0});  // from the front: right of the view is the patient's left
  camera.distance_mm = 300;
  const double mm = camera.millimetresPerPixel(700);
  const Eigen::Vector3d right = handMotion(camera, 10, 0, 0, 700);
  EXPECT_NEAR(right.x(), 10 * mm * 1e-3, 1e-12);
  const Eigen::Vector3d up = handMotion(camera, 0, -10, 0, 700);
  EXPECT_NEAR(up.z(), 10 * mm * 1e-3, 1e-12);
  const Eigen::Vector3d in = handMotion(camera, 0, 0, 2, 700);
  EXPECT_NEAR(in.y(), 2e-3, 1e-12) << "into the view, towards the patient's back";
}

TEST(Bricks, HoldTheLargestValueOfTheirVoxelsAndRim) {
  const Volume head = test::syntheticHead(21);  // not a multiple of the brick
  const auto [count, most] = brickMaxima(head, 8);
  EXPECT_EQ(count, (std::array<int, 3>{3, 3, 3}));
  for (int k = 0; k < head.geometry.dims[2]; ++k) {
    for (int j = 0; j < head.geometry.dims[1]; ++j) {
      for (int i = 0; i < head.geometry.dims[0]; ++i) {
        const float value = static_cast<float>(head.value(head.geometry.index(i, j, k)));
        // Interpolation reaches one voxel: every brick within one of it covers it.
        for (const int d : {-1, 0, 1}) {
          const auto b = [&](int v, int n) { return std::clamp((v + d) / 8, 0, n - 1); };
          const auto at = static_cast<std::size_t>((b(k, 3) * 3 + b(j, 3)) * 3 + b(i, 3));
          ASSERT_GE(most[at], value);
        }
      }
    }
  }
}

/// A linear ramp in an oblique grid: the gradient is known everywhere.
Volume ramp(const Eigen::Vector3d& slope_P) {
  Volume volume;
  volume.type = VoxelType::Float32;
  volume.geometry.dims = {12, 10, 8};
  volume.geometry.spacing = {1e-3, 2e-3, 3e-3};
  volume.geometry.X_PV.linear() =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (int k = 0; k < 8; ++k) {
    for (int j = 0; j < 10; ++j) {
      for (int i = 0; i < 12; ++i) {
        const Eigen::Vector3d p = volume.geometry.X_PV * volume.geometry.centre_V(i, j, k);
        volume.float32.push_back(static_cast<float>(slope_P.dot(p)));
      }
    }
  }
  return volume;
}

TEST(GreyNormals, TheGradientOfARampIsItsSlope) {
  const Eigen::Vector3d slope(3000, -2000, 500);
  const Volume volume = ramp(slope);
  const Eigen::Vector3d p = volume.geometry.X_PV * volume.geometry.centre_V(5.3, 4.8, 3.1);
  EXPECT_LT((greyGradient_P(volume, p) - slope).norm(), 1e-3 * slope.norm());
  EXPECT_EQ(greyGradient_P(volume, p + Eigen::Vector3d(1, 1, 1)), Eigen::Vector3d::Zero());
}

TEST(GreyNormals, PointOutOfTheLabelAndYieldToItWhereTheyDisagree) {
  const Eigen::Vector3d slope(0, 0, 1000);
  Volume volume = ramp(slope);
  const Eigen::Vector3d p = volume.geometry.X_PV * volume.geometry.centre_V(5, 5, 4) * 1e3;
  SurfaceChunk chunk;
  // A label that is brighter inside (outward is down the ramp), one darker, one across.
  const Eigen::Vector3d tilted = Eigen::Vector3d(0.5, 0, -1).normalized();
  for (const Eigen::Vector3d& n :
       {tilted, Eigen::Vector3d(-tilted), Eigen::Vector3d::UnitX().eval()}) {
    for (int c = 0; c < 3; ++c) chunk.vertices_mm.push_back(static_cast<float>(p[c]));
    for (int c = 0; c < 3; ++c) chunk.normals.push_back(static_cast<float>(n[c]));
  }
  std::vector<SurfaceChunk> chunks{chunk};
  shadeByGrey(chunks, volume);
  EXPECT_LT(chunks[0].normals[2], -0.97F);
  EXPECT_GT(chunks[0].normals[5], 0.97F);
  EXPECT_FLOAT_EQ(chunks[0].normals[6], 1.0F);
}

TEST(StartingWindow, OfACtIsTheUsualOneUnlessItWouldShowNothing) {
  Volume ct = test::syntheticHead(24);
  ASSERT_EQ(ct.modality, "CT");
  EXPECT_EQ(startingWindow(ct), (std::array<double, 2>{400.0, 2000.0}));
  // All of it below the window, as where a scanner's own units are stored.
  for (std::size_t i = 0; i < ct.int16.size(); ++i) {
    ct.int16[i] = static_cast<std::int16_t>(-1024 + static_cast<int>(i % 200));
  }
  const auto [level, width] = startingWindow(ct);
  EXPECT_NEAR(level, -924.0, 5.0);
  EXPECT_NEAR(width, 198.0, 8.0);
}

}  // namespace
}  // namespace palpate::ui
