#pragma once
/// Where the voxels of another file lie on a case's own grid, or why they do not lie on it.
///
/// Labels are never resampled: a voxel is placed where its centre is within kMaxVoxelOffset of a
/// centre of the case's grid. Axes may run the other way and in another order, and the file may
/// cover a part of the volume.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>

#include "core/base/error.h"
#include "core/geometry/grid_geometry.h"

namespace palpate {

/// In voxels of the case. Files keep six or more digits of millimetres, and a voxel of 0.1 mm one
/// metre from the origin still rounds to less; what is further off was made for another scan.
inline constexpr double kMaxVoxelOffset = 0.01;

/// A box of voxels as a file states it: patient frame, LPS, millimetres. An axis of one voxel has
/// no direction to check.
struct StatedGrid {
  std::array<std::int32_t, 3> dims{1, 1, 1};
  Eigen::Matrix3d axes_mm = Eigen::Matrix3d::Identity();  ///< Columns, one voxel each.
  Eigen::Vector3d origin_mm = Eigen::Vector3d::Zero();    ///< Centre of the first voxel.
};

/// The grid's own statement.
[[nodiscard]] StatedGrid statedGrid(const GridGeometry& geometry);

/// Stated voxel (i, j, k) is the case's voxel first + i·step[0] + j·step[1] + k·step[2], where
/// `first` and the steps are linear indices.
struct GridFit {
  std::int64_t first = 0;
  std::array<std::int64_t, 3> step{0, 0, 0};
  [[nodiscard]] std::size_t index(std::int32_t i, std::int32_t j, std::int32_t k) const noexcept {
    return static_cast<std::size_t>(first + i * step[0] + j * step[1] + k * step[2]);
  }
};

/// Refuses, in the words of `file` and `field` (what states the position: a tag or a key), a box
/// with other axes or spacing, between the case's voxels, or reaching out of the volume.
[[nodiscard]] Result<GridFit> fitToGrid(const StatedGrid& stated, const GridGeometry& geometry,
                                        const std::filesystem::path& file,
                                        const std::string& field);

}  // namespace palpate
