#include "imaging/rigid_geometry.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

namespace palpate {
namespace fs = std::filesystem;

Result<GridGeometry> rigidGeometry(const std::array<std::int32_t, 3>& dims,
                                   const FoundAffine& affine, const fs::path& file,
                                   const char* field, bool& flipSlices) {
  const auto refuse = [&](const std::string& message, const std::string& found) {
    return fail(inputRefused(message)
                    .inFile(file.string())
                    .inField(field)
                    .butFound(found)
                    .wants("three orthogonal axes of non-zero length")
                    .advise("Resample the image to an orthogonal grid in the program that made it, "
                            "then import that."));
  };
  if (!affine.axes_mm.allFinite() || !affine.origin_mm.allFinite()) {
    return refuse("The position of the voxels in the patient is not a number.", "NaN or infinity");
  }
  const Eigen::Vector3d spacing_mm = affine.axes_mm.colwise().norm();
  if (!(spacing_mm.minCoeff() > 0.0)) {
    return refuse("The spacing of the voxels is zero.", "0 mm");
  }
  Eigen::Matrix3d axes = affine.axes_mm;
  for (int a = 0; a < 3; ++a) axes.col(a) /= spacing_mm[a];
  const double shear =
      std::max({std::abs(axes.col(0).dot(axes.col(1))), std::abs(axes.col(0).dot(axes.col(2))),
                std::abs(axes.col(1).dot(axes.col(2)))});
  // Headers store six or seven digits; a rounding of 1e-4 rad moves a corner 250 mm away by less
  // than half a voxel of any scanner, and anything above it is a real shear.
  if (shear > 1e-4) {
    char angle[64];
    std::snprintf(angle, sizeof angle, "axes %.4g degrees off square",
                  std::asin(std::min(shear, 1.0)) * 180.0 / std::numbers::pi);
    return refuse("The voxel axes are sheared, which Palpate does not show.", angle);
  }
  Eigen::Vector3d origin_mm = affine.origin_mm;
  flipSlices = axes.determinant() < 0.0;
  if (flipSlices) {
    origin_mm += affine.axes_mm.col(2) * (dims[2] - 1);
    axes.col(2) = -axes.col(2);
  }
  GridGeometry geometry;
  geometry.dims = dims;
  geometry.spacing = spacing_mm * 1e-3;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
  geometry.X_PV.linear() = svd.matrixU() * svd.matrixV().transpose();
  if ((geometry.X_PV.linear() - axes).cwiseAbs().maxCoeff() < 1e-12) {
    geometry.X_PV.linear() = axes;  // already a rotation: keep its very bits
  }
  geometry.X_PV.translation() = origin_mm * 1e-3;
  return geometry;
}

}  // namespace palpate
