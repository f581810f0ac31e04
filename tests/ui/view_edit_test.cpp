/// Tools in the views: rays, projections and steps, against what they mean in space.

#include "ui/view_edit.h"

#include <gtest/gtest.h>

#include <iostream>
#include <random>

#include "imaging/segment/apply.h"
#include "imaging/segment/nearest_label.h"
#include "imaging/segment/recipe.h"

namespace palpate::ui {
namespace {

Camera someCamera(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Camera camera;
  camera.target_mm = 50.0 * Eigen::Vector3d(unit(random), unit(random), unit(random));
  camera.q_PC =
      Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized();
  camera.distance_mm = 300.0 + 100.0 * unit(random);
  return camera;
}

TEST(ViewEdit, WhatTheSceneDrawsIsWhatScissorsCut) {
  std::mt19937 random(20261126);
  std::cout << "seed 20261126\n";
  const Rect area{300, 48, 700, 708};
  std::uniform_real_distribution<double> place(-60.0, 60.0);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = someCamera(random);
    const Eigen::Vector3d p =
        camera.target_mm + Eigen::Vector3d(place(random), place(random), place(random));
    // As the picture is drawn: the camera's own matrices, float.
    const Eigen::Vector3d origin = camera.target_mm;
    const double aspect = static_cast<double>(area.w / area.h);
    const Eigen::Vector4f seen =
        camera.projection(aspect) * camera.view(origin) * (p - origin).cast<float>().homogeneous();
    const Eigen::Vector2d pixel(
        static_cast<double>(area.x) +
            0.5 * (1.0 + static_cast<double>(seen.x() / seen.w())) * static_cast<double>(area.w),
        static_cast<double>(area.y) +
            0.5 * (1.0 - static_cast<double>(seen.y() / seen.w())) * static_cast<double>(area.h));
    const Eigen::Vector3d cut = sceneView(camera) * p.homogeneous();
    ASSERT_GT(cut.z(), 0.0);
    const Eigen::Vector2d uv = sceneAngles(camera, area, pixel);
    EXPECT_LT((uv - cut.head<2>() / cut.z()).norm(), 1e-4) << i;
  }
}

LabelGrid randomLabels(std::mt19937& random) {
  LabelGrid grid;
  grid.geometry.dims = {9, 7, 11};
  grid.geometry.spacing = Eigen::Vector3d(1.0, 0.5, 2.0) * 1e-3;
  grid.geometry.X_PV.linear() =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  grid.geometry.X_PV.translation() = Eigen::Vector3d(0.01, -0.02, 0.03);
  grid.labels.resize(grid.geometry.voxelCount());
  for (auto& label : grid.labels) label = random() % 12 == 0 ? 1 + random() % 2 : 0;
  return grid;
}

/// Slab test of one voxel's box; the distance where the ray enters, or nothing.
std::optional<double> entry(const GridGeometry& g, int i, int j, int k, const Eigen::Vector3d& from,
                            const Eigen::Vector3d& along) {
  double near = 0.0, far = 1e9;
  const Eigen::Vector3d centre = g.centre_V(i, j, k);
  for (int a = 0; a < 3; ++a) {
    const double t0 = (centre[a] - 0.5 * g.spacing[a] - from[a]) / along[a];
    const double t1 = (centre[a] + 0.5 * g.spacing[a] - from[a]) / along[a];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  // What a ray only grazes may be stepped over.
  if (far - near < 0.3 * g.spacing.minCoeff()) return {};
  return near;
}

TEST(ViewEdit, ARayMeetsTheFirstLabelledVoxelThatIsShown) {
  std::mt19937 random(7);
  std::cout << "seed 7\n";
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const LabelGrid labels = randomLabels(random);
    const GridGeometry& g = labels.geometry;
    const Eigen::Vector3d eye(60 * unit(random), 60 * unit(random), 60 * unit(random));
    const Eigen::Vector3d middle = g.X_PV * g.centre_V(4, 3, 5) * 1e3;
    const Eigen::Vector3d ray =
        middle + 3.0 * Eigen::Vector3d(unit(random), unit(random), unit(random)) - eye;
    const Eigen::Vector3d from = g.X_PV.inverse() * (eye * 1e-3);
    const Eigen::Vector3d along = (g.X_PV.linear().transpose() * ray).normalized();
    if (g.contains(g.voxelAt(from)[0], g.voxelAt(from)[1], g.voxelAt(from)[2])) continue;
    double nearest = 1e9;
    bool grazed = false;
    Eigen::Vector3d expected = Eigen::Vector3d::Zero();
    for (int k = 0; k < g.dims[2]; ++k) {
      for (int j = 0; j < g.dims[1]; ++j) {
        for (int x = 0; x < g.dims[0]; ++x) {
          if (labels.at(x, j, k) != 1) continue;  // 2 is hidden
          const auto t = entry(g, x, j, k, from, along);
          if (!t || *t >= nearest) continue;
          nearest = *t;
          expected = g.X_PV * g.centre_V(x, j, k) * 1e3;
        }
      }
    }
    const auto hit = firstLabelled(labels, {2}, eye, ray);
    if (hit && nearest < 1e9 && (*hit - expected).norm() > 1e-9) grazed = true;
    if (nearest > 1e8) continue;
    ASSERT_TRUE(hit) << i;
    // A grazed voxel in front may be found too; it has to be labelled and shown.
    const auto v = g.voxelAt(g.X_PV.inverse() * (*hit * 1e-3));
    EXPECT_EQ(labels.at(v[0], v[1], v[2]), 1) << i;
    if (grazed) {
      const auto t = (g.X_PV.inverse() * (*hit * 1e-3) - from).dot(along);
      EXPECT_LT(t, nearest + g.spacing.maxCoeff()) << i;
    } else {
      ++hits;
    }
  }
  EXPECT_GT(hits, 50);
}

TEST(ViewEdit, TheNearestVoxelOfALabelIsTheNearest) {
  std::mt19937 random(11);
  std::cout << "seed 11\n";
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    const LabelGrid labels = randomLabels(random);
    const GridGeometry& g = labels.geometry;
    const Eigen::Vector3d p =
        g.X_PV * g.centre_V(8 * unit(random), 6 * unit(random), 10 * unit(random)) * 1e3;
    double nearest = 2.0;
    std::optional<double> expected;
    for (int k = 0; k < g.dims[2]; ++k) {
      for (int j = 0; j < g.dims[1]; ++j) {
        for (int x = 0; x < g.dims[0]; ++x) {
          if (labels.at(x, j, k) != 2) continue;
          const double d = (g.X_PV * g.centre_V(x, j, k) * 1e3 - p).norm();
          if (d <= nearest) expected = nearest = d;
        }
      }
    }
    const auto on = nearestOf(labels, 2, p, 2.0);
    ASSERT_EQ(on.has_value(), expected.has_value()) << i;
    if (!on) continue;
    ++found;
    EXPECT_NEAR((*on - p).norm(), *expected, 1e-9) << i;
  }
  EXPECT_GT(found, 50);
}

/// Every tool with a preview makes a step as soon as it has what it needs, and none before.
TEST(SegmentState, AStepOnlyWhenNothingIsMissing) {
  SegmentPanelState state;
  state.label = "bone";
  for (std::size_t kind = 0; kind < kTools; ++kind) {
    state.kind = static_cast<ToolKind>(kind);
    state.forget();
    state.islands = 2;
    state.other.clear();
    const auto needs = [&] {
      return gestureOf(state) != Gesture::None || state.kind == ToolKind::Combine;
    };
    EXPECT_EQ(stepOf(state).has_value(), !needs()) << kind;
    state.parts = {"bone", "mandible"};
    state.picks = {{{1, 2, 3}, 0}, {{4, 5, 6}, 1}};
    state.box_mm = {Eigen::Vector3d(9, 0, 1), Eigen::Vector3d(0, 5, 2)};
    state.other = "brain";
    const bool drawn = gestureOf(state) == Gesture::Stroke || gestureOf(state) == Gesture::Outline;
    const auto step = stepOf(state);
    EXPECT_EQ(step.has_value(), !drawn) << kind;
    EXPECT_EQ(step && recipeText({*step}).empty(), false);
  }
  state.kind = ToolKind::Box;
  const auto box = std::get<tool::Box>(stepOf(state)->tool);
  EXPECT_EQ(box.low_mm, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(box.high_mm, Eigen::Vector3d(9, 5, 2));
}

TEST(SegmentState, EscapeDropsWhatIsDrawnAndAFinishedStepDoesNot) {
  SegmentPanelState state;
  EXPECT_FALSE(state.abandon());
  state.kind = ToolKind::Brush;
  state.drawingIn = View::Axial;
  state.stroke_mm = {Eigen::Vector3d::Zero()};
  state.picks.push_back({Eigen::Vector3d::Zero(), 0});
  state.forgetPicks();
  EXPECT_TRUE(state.picks.empty());
  EXPECT_EQ(state.stroke_mm.size(), 1U);
  EXPECT_TRUE(state.abandon());
  EXPECT_TRUE(state.stroke_mm.empty());
  EXPECT_FALSE(state.drawingIn);
  EXPECT_TRUE(state.abandoned);
}

TEST(SegmentState, SplitNeedsTwoPartsWithSeeds) {
  SegmentPanelState state;
  state.label = "bone";
  state.kind = ToolKind::Split;
  state.parts = {"bone", "mandible", ""};
  state.picks = {{{1, 2, 3}, 0}};
  EXPECT_FALSE(stepOf(state));
  state.picks.push_back({{4, 5, 6}, 1});
  ASSERT_TRUE(stepOf(state));
  EXPECT_EQ(std::get<tool::Split>(stepOf(state)->tool).seeds[1].label, "mandible");
  state.picks.push_back({{7, 8, 9}, 2});  // a part without a name
  EXPECT_FALSE(stepOf(state));
}

}  // namespace
}  // namespace palpate::ui
