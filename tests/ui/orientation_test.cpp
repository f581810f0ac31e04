#include "ui/orientation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "ui/slice_geometry.h"

namespace palpate::ui {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

TEST(Orientation, NamesThePatientAxes) {
  EXPECT_EQ(orientationLetters({1, 0, 0}), "L");
  EXPECT_EQ(orientationLetters({-2, 0, 0}), "R");
  EXPECT_EQ(orientationLetters({0, 0.1, 0}), "P");
  EXPECT_EQ(orientationLetters({0, -1, 0}), "A");
  EXPECT_EQ(orientationLetters({0, 0, 5}), "H");
  EXPECT_EQ(orientationLetters({0, 0, -5}), "F");
  EXPECT_EQ(orientationLetters({0, 0, 0}), "");
}

TEST(Orientation, AddsASecondLetterFromFifteenDegreesOn) {
  const auto turned = [](double degrees) {
    return Eigen::Vector3d(std::cos(degrees * kDegree), std::sin(degrees * kDegree), 0.0);
  };
  EXPECT_EQ(orientationLetters(turned(14.9)), "L");
  EXPECT_EQ(orientationLetters(turned(15.1)), "LP");
  EXPECT_EQ(orientationLetters(turned(46.0)), "PL");
  EXPECT_EQ(orientationLetters(turned(75.1)), "P");
}

GridGeometry oblique() {
  GridGeometry grid;
  grid.dims = {40, 50, 60};
  grid.spacing = {0.5e-3, 0.7e-3, 2e-3};
  grid.X_PV.linear() = (Eigen::AngleAxisd(20 * kDegree, Eigen::Vector3d::UnitZ()) *
                        Eigen::AngleAxisd(10 * kDegree, Eigen::Vector3d::UnitX()))
                           .toRotationMatrix();
  grid.X_PV.translation() = Eigen::Vector3d(-0.1, 0.05, 0.3);
  return grid;
}

TEST(Slices, LettersOfAnObliqueVolumeAreThoseOfItsAxes) {
  const GridGeometry grid = oblique();
  const auto letters = edgeLetters(grid, slicePlane(grid, View::Axial));
  // Rows run along Rz(20°)·x = (cos 20, sin 20, 0): left, and posterior by sin 20° = 0.34.
  EXPECT_EQ(letters[1], "LP");
  EXPECT_EQ(letters[0], "RA");
  // Columns: Rz(20)·Rx(10)·y = (-sin20·cos10, cos20·cos10, sin10): posterior, right; 0.17 H left
  // out.
  EXPECT_EQ(letters[3], "PR");
  EXPECT_EQ(letters[2], "AL");
}

TEST(Slices, AreShownAsRadiologistsReadThemWhateverTheStorageOrder) {
  GridGeometry grid;
  grid.dims = {10, 11, 12};
  // Stored sagittally: x runs to the feet, y to the front, z to the right.
  Eigen::Matrix3d R;
  R.col(0) = -Eigen::Vector3d::UnitZ();
  R.col(1) = -Eigen::Vector3d::UnitY();
  R.col(2) = R.col(0).cross(R.col(1));
  grid.X_PV.linear() = R;
  const std::array<std::string, 4> axial{"R", "L", "A", "P"};
  const std::array<std::string, 4> coronal{"R", "L", "H", "F"};
  const std::array<std::string, 4> sagittal{"A", "P", "H", "F"};
  EXPECT_EQ(edgeLetters(grid, slicePlane(grid, View::Axial)), axial);
  EXPECT_EQ(edgeLetters(grid, slicePlane(grid, View::Coronal)), coronal);
  EXPECT_EQ(edgeLetters(grid, slicePlane(grid, View::Sagittal)), sagittal);
}

TEST(Slices, ScreenAndVoxelsAreInversesOfEachOther) {
  const GridGeometry grid = oblique();
  for (const View view : {View::Axial, View::Coronal, View::Sagittal}) {
    const SlicePlane plane = slicePlane(grid, view);
    const SliceFit fit = fitSlice(grid, plane, 300, 200, 1.7, {12, -8});
    const Eigen::Vector3d voxel(11.25, 33.5, 7.75);
    const Eigen::Vector2d screen = fit.toScreen(grid, plane, voxel);
    EXPECT_LT((fit.toVoxel(grid, plane, screen, voxel[plane.through]) - voxel).norm(), 1e-9);
    const Eigen::Vector3d p = pointOf(grid, voxel);
    EXPECT_LT((voxelOf(grid, p) - voxel).norm(), 1e-9);
  }
}

TEST(Slices, OneMillimetreIsAsManyPixelsAlongBothAxes) {
  const GridGeometry grid = oblique();  // 0.5 by 0.7 mm voxels
  const SlicePlane plane = slicePlane(grid, View::Axial);
  const SliceFit fit = fitSlice(grid, plane, 400, 400, 1.0, {0, 0});
  const Eigen::Vector2d a = fit.toScreen(grid, plane, {0, 0, 0});
  const Eigen::Vector2d right = fit.toScreen(grid, plane, {10, 0, 0});
  const Eigen::Vector2d down = fit.toScreen(grid, plane, {0, 10, 0});
  EXPECT_NEAR((right - a).norm() / 5.0, (down - a).norm() / 7.0, 1e-9);
  EXPECT_NEAR((right - a).norm() / 5.0, fit.pixelsPerMm, 1e-9);
}

TEST(Slices, TheScaleBarIsRoundAndBetweenFifteenAndFortyPerCent) {
  for (double pixelsPerMm = 0.05; pixelsPerMm < 60.0; pixelsPerMm *= 1.13) {
    const double mm = scaleBarLength_mm(pixelsPerMm, 300);
    EXPECT_LE(mm * pixelsPerMm, 0.4001 * 300) << pixelsPerMm;
    EXPECT_GE(mm * pixelsPerMm, 0.15 * 300) << pixelsPerMm;
    const double lead = mm / std::pow(10.0, std::floor(std::log10(mm) + 1e-9));
    EXPECT_TRUE(std::abs(lead - 1) < 1e-6 || std::abs(lead - 2) < 1e-6 || std::abs(lead - 5) < 1e-6)
        << mm;
  }
}

}  // namespace
}  // namespace palpate::ui
