#include "core/trade/reference_shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate {
namespace {

constexpr KnownShape kAll[] = {KnownShape::Sphere, KnownShape::Plane, KnownShape::Cylinder,
                               KnownShape::Wedge, KnownShape::Torus};

class KnownShapes : public testing::TestWithParam<KnownShape> {};
INSTANTIATE_TEST_SUITE_P(All, KnownShapes, testing::ValuesIn(kAll),
                         [](const auto& row) { return std::string(nameOf(row.param)); });

/// Places in the cube that are not where two faces are equally near.
std::vector<Eigen::Vector3d> places(const ReferenceShape& shape, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> in(-30e-3, 30e-3);
  std::vector<Eigen::Vector3d> found;
  while (found.size() < static_cast<std::size_t>(count)) {
    const Eigen::Vector3d p(in(random), in(random), in(random));
    const double d = shape.distance(p);
    const Eigen::Vector3d foot = p - d * shape.normal(p);
    if (std::abs(shape.distance(foot)) < 1e-9) found.push_back(p);
  }
  return found;
}

TEST_P(KnownShapes, TheDistanceIsThatOfTheNearestOfManySurfacePoints) {
  const auto shape = closedForm(GetParam());
  // Surface points by marching along a dense fan of rays: nothing of the closed form but its sign.
  std::vector<Eigen::Vector3d> surface;
  constexpr double kStep = 0.5e-3;
  for (double x = -40e-3; x <= 40e-3; x += kStep) {
    for (double y = -40e-3; y <= 40e-3; y += kStep) {
      double before = shape->distance({x, y, 40e-3});
      for (double z = 40e-3; z >= -60e-3; z -= kStep) {
        const double now = shape->distance({x, y, z});
        if ((now < 0.0) != (before < 0.0)) {
          double low = z, high = z + kStep;
          for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            ((shape->distance({x, y, middle}) < 0.0) == (now < 0.0) ? low : high) = middle;
          }
          surface.emplace_back(x, y, low);
        }
        before = now;
      }
    }
  }
  ASSERT_GT(surface.size(), 1000U);
  for (const Eigen::Vector3d& p : places(*shape, 60)) {
    double nearest = 1.0;
    for (const auto& s : surface) nearest = std::min(nearest, (p - s).norm());
    const double d = std::abs(shape->distance(p));
    EXPECT_LE(d, nearest + 1e-9) << p.transpose();
    // Rays along z meet steep walls sparsely.
    if (std::abs(shape->normal(p).z()) > 0.5) {
      EXPECT_GT(d, nearest - 0.5e-3) << p.transpose();
    }
  }
}

TEST_P(KnownShapes, TheNormalIsTheGradient) {
  const auto shape = closedForm(GetParam());
  constexpr double kH = 1e-6;
  for (const Eigen::Vector3d& p : places(*shape, 200)) {
    Eigen::Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d e = kH * Eigen::Vector3d::Unit(axis);
      gradient[axis] = (shape->distance(p + e) - shape->distance(p - e)) / (2.0 * kH);
    }
    if (std::abs(gradient.norm() - 1.0) > 1e-3) continue;  // on a ridge of the distance
    EXPECT_LT((gradient - shape->normal(p)).norm(), 1e-3) << p.transpose();
  }
}

TEST_P(KnownShapes, TheTopIsOnTheSurfaceAndFreeAbove) {
  const auto shape = closedForm(GetParam());
  const Eigen::Vector3d top = topOf(GetParam());
  EXPECT_NEAR(shape->distance(top), 0.0, 1e-15);
  EXPECT_NEAR(shape->distance(top + 5e-3 * Eigen::Vector3d::UnitZ()), 5e-3, 1e-12);
}

TEST_P(KnownShapes, VoxelsBelongWhereTheirCentresAre) {
  const LabelGrid grid = voxelsOf(GetParam(), 1e-3);
  const auto shape = closedForm(GetParam());
  EXPECT_EQ(grid.geometry.dims, (std::array<std::int32_t, 3>{64, 64, 64}));
  for (std::int32_t i = 0; i < 64; ++i) {
    const Eigen::Vector3d p = grid.geometry.X_PV * grid.geometry.centre_V(i, 33, 40);
    EXPECT_EQ(grid.at(i, 33, 40) != 0, shape->distance(p) < 0.0);
  }
  EXPECT_EQ(grid.geometry.X_PV.translation().x(), -31.5e-3);
  EXPECT_EQ(knownShapeNamed(nameOf(GetParam())), GetParam());
}

TEST(KnownShape, AnUnknownNameIsRefusedWithTheList) {
  const auto none = knownShapeNamed("cube");
  ASSERT_FALSE(none);
  EXPECT_EQ(sentence(none.error()),
            "There is no shape of that name. Field: --shape. Found: cube. Expected: sphere, plane, "
            "cylinder, wedge or torus. Choose one of these.");
}

}  // namespace
}  // namespace palpate
