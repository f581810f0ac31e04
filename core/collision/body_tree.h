#pragma once
/// The implicit sphere trees of a voxel body's surface, in the body's own frame.
///
/// What the world's VoxelTree is to the anatomy: masks and links of an N-tree over the body's
/// surface voxels. Level, centre and sphere of a node are computed during the descent, with the
/// body's axes turned once a query (paper 3.2). Immutable; any thread may read it.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/grid_geometry.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

struct BodyTree {
  int levels = 0;
  std::vector<TreeLevel> level;     ///< [1] .. [levels]; links of level 1 count leaves.
  std::vector<std::uint32_t> rank;  ///< Leaf -> rank of its shell point in ShellHierarchy::order.
};

struct VoxelBody {
  /// One for each branching, by bits − 1: a shell does not know which trees it will meet. All
  /// three are a few bytes a surface voxel.
  std::array<BodyTree, 3> tree;
  Eigen::Vector3d spacing = Eigen::Vector3d::Ones();     ///< Edges of a voxel, metres.
  Eigen::Matrix3d axes_T = Eigen::Matrix3d::Identity();  ///< Columns: the grid's x, y, z in T.
  /// Lower corner of the box of surface voxels, where addresses count from; T, metres.
  Eigen::Vector3d origin_T = Eigen::Vector3d::Zero();
  double slack = 0.0;  ///< Metres: more than a shell point can be off its voxel's centre.
};

/// @param voxels  the surface voxels in ascending linear order, at least one: as many as points.
/// @param order   rank -> index of the shell point (ShellHierarchy::order).
/// Refuses what buildTopology refuses.
[[nodiscard]] Result<VoxelBody> buildVoxelBody(const GridGeometry& grid,
                                               std::span<const std::array<std::int32_t, 3>> voxels,
                                               std::span<const Eigen::Vector3d> points_T,
                                               std::span<const std::uint32_t> order);

}  // namespace palpate
