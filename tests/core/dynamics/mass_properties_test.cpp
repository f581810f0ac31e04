#include "core/dynamics/mass_properties.h"

#include <gtest/gtest.h>

#include "tests/core/dynamics/shapes.h"

namespace palpate {
namespace {

using test::box;
using test::prism;
using test::sphere;

TEST(MassProperties, OfABoxAreItsClosedFormWhereverItStands) {
  const Eigen::Vector3d size(0.02, 0.03, 0.05);
  for (const Eigen::Vector3d& centre :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.4, -1.2, 3.0)}) {
    const auto m = massPropertiesOf(box(size, centre), 2000.0);
    ASSERT_TRUE(m);
    const double mass = 2000.0 * size.prod();
    const Eigen::Vector3d s2 = size.cwiseAbs2();
    const Eigen::Vector3d I =
        mass / 12.0 * Eigen::Vector3d(s2.y() + s2.z(), s2.x() + s2.z(), s2.x() + s2.y());
    EXPECT_NEAR(m->mass, mass, 1e-12 * mass);
    EXPECT_LT((m->p_TC - centre).norm(), 1e-14);
    EXPECT_LT((m->I_C - Eigen::Matrix3d(I.asDiagonal())).norm(), 1e-11 * I.norm());
  }
}

// The inscribed polyhedron is smaller than the sphere; the error falls fourfold with each split.
TEST(MassProperties, OfASphereConvergeToItsClosedForm) {
  const double r = 0.01, density = 7800.0;
  const double mass = density * 4.0 / 3.0 * M_PI * r * r * r;
  const double inertia = 0.4 * mass * r * r;
  const Eigen::Vector3d centre(0.1, 0.0, -0.2);
  double before = 1.0;
  for (int times = 2; times <= 4; ++times) {
    const auto m = massPropertiesOf(sphere(r, times, centre), density);
    ASSERT_TRUE(m);
    EXPECT_LT((m->p_TC - centre).norm(), 1e-12);
    const double error = std::abs(m->I_C(1, 1) - inertia) / inertia;
    EXPECT_LT(error, 0.3 * before);
    EXPECT_LT(std::abs(m->I_C(0, 1)), 1e-6 * inertia);
    before = error;
  }
  EXPECT_LT(before, 0.005);
}

// A regular n-gon of corner radius R: area n/2·R²·sin(2π/n), polar second moment of area
// A·R²·(2 + cos(2π/n))/6.
TEST(MassProperties, OfAPrismAreItsClosedForm) {
  const double R = 0.004, h = 0.12, density = 7800.0;
  const int n = 24;
  const auto m = massPropertiesOf(prism(R, h, n, {0, 0, 0.06}), density);
  ASSERT_TRUE(m);
  const double area = 0.5 * n * R * R * std::sin(2.0 * M_PI / n);
  const double mass = density * area * h;
  const double axial = mass * R * R * (2.0 + std::cos(2.0 * M_PI / n)) / 6.0;
  EXPECT_NEAR(m->mass, mass, 1e-12 * mass);
  EXPECT_NEAR(m->p_TC.z(), 0.06, 1e-14);
  EXPECT_NEAR(m->I_C(2, 2), axial, 1e-11 * axial);
  EXPECT_NEAR(m->I_C(0, 0), 0.5 * axial + mass * h * h / 12.0, 1e-11 * mass * h * h);
}

TEST(MassProperties, RefuseAnOpenMesh) {
  TriangleMesh open = box({1, 1, 1}, {0, 0, 0});
  open.triangles.pop_back();
  const auto m = massPropertiesOf(open, 1000.0);
  ASSERT_FALSE(m);
  EXPECT_EQ(m.error().message, "The mesh is not closed, so it encloses no mass.");
}

TEST(MassProperties, RefuseAMeshTurnedInsideOut) {
  TriangleMesh inside = box({1, 1, 1}, {0, 0, 0});
  for (auto& t : inside.triangles) std::swap(t[1], t[2]);
  const auto m = massPropertiesOf(inside, 1000.0);
  ASSERT_FALSE(m);
  EXPECT_EQ(m.error().message, "The mesh encloses no volume.");
  EXPECT_EQ(m.error().advice, "Turn its triangles so that they face outwards.");
}

TEST(MassProperties, RefuseADensityThatIsNone) {
  const auto m = massPropertiesOf(box({1, 1, 1}, {0, 0, 0}), 0.0);
  ASSERT_FALSE(m);
  EXPECT_EQ(m.error().field, "density");
}

// The mesh of the same box is the oracle, at an oblique pose and with voxels that are no cubes.
TEST(MassProperties, OfVoxelsAreThoseOfTheMeshAroundThem) {
  LabelGrid grid;
  grid.geometry.dims = {9, 8, 7};
  grid.geometry.spacing = {0.5e-3, 0.7e-3, 1.1e-3};
  grid.geometry.X_PV = Eigen::Translation3d(0.1, -0.2, 0.05) *
                       Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  for (int k = 1; k < 5; ++k) {
    for (int j = 2; j < 8; ++j) {
      for (int i = 3; i < 6; ++i) grid.labels[grid.geometry.index(i, j, k)] = 7;
    }
  }
  const Eigen::Vector3d size(3 * 0.5e-3, 6 * 0.7e-3, 4 * 1.1e-3);
  const Eigen::Vector3d centre = grid.geometry.spacing.cwiseProduct(Eigen::Vector3d(4, 4.5, 2.5));
  TriangleMesh mesh = test::box(size, centre);
  for (auto& v : mesh.vertices) v = grid.geometry.X_PV * v;
  const auto voxels = massPropertiesOf(grid, 1900.0);
  const auto solid = massPropertiesOf(mesh, 1900.0);
  ASSERT_TRUE(voxels);
  ASSERT_TRUE(solid);
  EXPECT_NEAR(voxels->mass, solid->mass, 1e-12 * solid->mass);
  EXPECT_LT((voxels->p_TC - solid->p_TC).norm(), 1e-14);
  EXPECT_LT((voxels->I_C - solid->I_C).norm(), 1e-12 * solid->I_C.norm());
}

TEST(MassProperties, RefuseAnEmptyGridOfVoxels) {
  LabelGrid grid;
  grid.geometry.dims = {2, 2, 2};
  grid.labels.assign(8, 0);
  const auto none = massPropertiesOf(grid, 1900.0);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "The body has no solid voxel.");
  grid.labels[3] = 1;
  EXPECT_EQ(massPropertiesOf(grid, 0.0).error().field.value_or(""), "density");
}

}  // namespace
}  // namespace palpate
