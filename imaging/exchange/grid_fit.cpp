#include "imaging/exchange/grid_fit.h"

#include <cmath>
#include <cstdio>
#include <string>

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kAdvice =
    "Export the labels on the grid of this case's own scan, or choose the case they were made on.";

using Voxel = std::array<std::int64_t, 3>;

std::string text(const Eigen::Vector3d& v) {
  // To a thousandth of a voxel, and no minus before a zero.
  const Eigen::Vector3d r = (v * 1e3).array().round() / 1e3 + 0.0;
  char buffer[96];
  std::snprintf(buffer, sizeof buffer, "(%.7g, %.7g, %.7g)", r[0], r[1], r[2]);
  return buffer;
}

struct Steps {
  Eigen::Matrix3d whole = Eigen::Matrix3d::Zero();  ///< Columns: a stated axis in case voxels.
  bool fit = true;
  Eigen::Vector3d offending = Eigen::Vector3d::Zero();
};

/// Each stated axis rounded to whole voxels; fits where it is ± one axis of the case, each taken
/// once.
Steps wholeSteps(const StatedGrid& stated, const Eigen::Matrix3d& toVoxels) {
  Steps steps;
  std::array<bool, 3> taken{};
  for (Eigen::Index a = 0; a < 3; ++a) {
    if (stated.dims[static_cast<std::size_t>(a)] == 1) continue;
    const Eigen::Vector3d axis = toVoxels * stated.axes_mm.col(a);
    Eigen::Index along = 0;
    if (axis.allFinite()) axis.cwiseAbs().maxCoeff(&along);
    Eigen::Vector3d whole = Eigen::Vector3d::Zero();
    whole[along] = axis[along] < 0.0 ? -1.0 : 1.0;
    // Far looser than kMaxVoxelOffset, which is asked of the corners below: here only which axis.
    const bool near = axis.allFinite() && (axis - whole).cwiseAbs().maxCoeff() < 0.1;
    if (!near || std::exchange(taken[static_cast<std::size_t>(along)], true)) {
      steps.fit = false;
      steps.offending = axis;
      return steps;
    }
    steps.whole.col(a) = whole;
  }
  return steps;
}

/// The largest distance of a corner from the whole voxel it should be, along any axis, in voxels.
double worstCorner(const StatedGrid& stated, const Eigen::Matrix3d& toVoxels,
                   const Eigen::Vector3d& first, const Steps& steps,
                   const Eigen::Vector3d& wholeFirst) {
  double worst = 0.0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d at;
    for (unsigned a = 0; a < 3; ++a) {
      at[a] = (corner >> a & 1U) != 0 ? stated.dims[a] - 1 : 0;
    }
    const Eigen::Vector3d exact = first + toVoxels * (stated.axes_mm * at);
    worst = std::max(worst, (exact - wholeFirst - steps.whole * at).cwiseAbs().maxCoeff());
  }
  return worst;
}

}  // namespace

StatedGrid statedGrid(const GridGeometry& geometry) {
  StatedGrid stated;
  stated.dims = geometry.dims;
  stated.axes_mm = geometry.X_PV.linear() * (geometry.spacing * 1e3).asDiagonal();
  stated.origin_mm = geometry.X_PV.translation() * 1e3;
  return stated;
}

Result<GridFit> fitToGrid(const StatedGrid& stated, const GridGeometry& geometry,
                          const fs::path& file, const std::string& field) {
  const auto refuse = [&](const char* message, std::string found, std::string expected) {
    return fail(inputRefused(message)
                    .inFile(file.string())
                    .inField(field)
                    .butFound(std::move(found))
                    .wants(std::move(expected))
                    .advise(kAdvice));
  };
  const Eigen::Matrix3d toVoxels =
      (geometry.spacing * 1e3).cwiseInverse().asDiagonal() * geometry.X_PV.linear().transpose();
  const Steps steps = wholeSteps(stated, toVoxels);
  if (!steps.fit) {
    return refuse("The labels have other axes or another spacing than the case's volume.",
                  "an axis of " + text(steps.offending) + " voxels of the case",
                  "axes of one voxel along the volume's own, in any order and sense");
  }
  const Eigen::Vector3d first = toVoxels * (stated.origin_mm - geometry.X_PV.translation() * 1e3);
  // Beyond this no voxel is, and whole numbers stay exact.
  if (!first.allFinite() || first.cwiseAbs().maxCoeff() >= 1e9) {
    return refuse("The labels lie outside the case's volume.", "a position far from the patient",
                  "a position in the volume");
  }
  const Eigen::Vector3d wholeFirst = first.array().round();
  const double worst = worstCorner(stated, toVoxels, first, steps, wholeFirst);
  if (!(worst <= kMaxVoxelOffset)) {
    char found[64];
    std::snprintf(found, sizeof found, "voxels up to %.3g voxels off", worst);
    return refuse("The labels lie between the voxels of the case's volume.", found,
                  "at most 0.01 voxels");
  }
  Eigen::Vector3d last = wholeFirst;
  for (Eigen::Index a = 0; a < 3; ++a) {
    last += steps.whole.col(a) * (stated.dims[static_cast<std::size_t>(a)] - 1);
  }
  const Eigen::Vector3d end(geometry.dims[0] - 1, geometry.dims[1] - 1, geometry.dims[2] - 1);
  if (wholeFirst.cwiseMin(last).minCoeff() < 0.0 ||
      (end - wholeFirst.cwiseMax(last)).minCoeff() < 0.0) {
    return refuse("The labels reach out of the case's volume.",
                  "voxels from " + text(wholeFirst) + " to " + text(last),
                  "from (0, 0, 0) to " + text(end));
  }
  const Eigen::Vector3d strides(1.0, geometry.dims[0],
                                static_cast<double>(geometry.dims[0]) * geometry.dims[1]);
  GridFit fit;
  fit.first = std::llround(strides.dot(wholeFirst));
  for (Eigen::Index a = 0; a < 3; ++a) {
    fit.step[static_cast<std::size_t>(a)] = std::llround(strides.dot(steps.whole.col(a)));
  }
  return fit;
}

}  // namespace palpate
