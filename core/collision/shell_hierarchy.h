#pragma once
/// The hierarchy over a shell's points: a sixteen-ary tree of spheres without a pointer.
///
/// Points are put into an order in which every run of kGroup·16^j points is compact; such a run is
/// the node of level j, so a node's points and children follow from its number alone: node i of
/// level j holds ranks [i·kGroup·16^j, (i+1)·kGroup·16^j), its children are nodes 16i .. 16i+15 of
/// level j−1. Only centres and radii are stored.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/collision/body_tree.h"
#include "core/collision/point_shell.h"
#include "core/collision/shell_blocks.h"

namespace palpate {

/// A sphere around some points, frame T, metres.
struct ShellSphere {
  double c[3] = {0, 0, 0};
  double r = 0;
};

struct ShellHierarchy {
  static constexpr std::size_t kGroup = 16;  ///< Points in a node of level 0.
  static constexpr std::size_t kArity = 16;

  std::vector<std::uint32_t> order;             ///< rank -> shell index
  std::vector<double> x, y, z;                  ///< Points by rank, T, metres.
  std::vector<std::vector<ShellSphere>> level;  ///< [0] groups .. back(): one root.

  [[nodiscard]] std::size_t size() const noexcept { return order.size(); }
  /// Points in one node of a level.
  [[nodiscard]] static std::size_t pointsPerNode(std::size_t level) noexcept {
    return kGroup << (4 * level);
  }
};

/// Deterministic: same points, same hierarchy. At least one point.
[[nodiscard]] ShellHierarchy buildShellHierarchy(const std::vector<Eigen::Vector3d>& points_T);

class ThinnedShells;

/// What a PointShell owns.
struct PointShell::Data {
  std::vector<Eigen::Vector3d> points_T, normals_T;
  double reach = 0.0;
  ShellHierarchy hierarchy;
  ShellBlocks blocks;             ///< The same, side by side.
  std::optional<VoxelBody> body;  ///< Of a voxel body: its own trees.
  std::shared_ptr<ThinnedShells> thinned;
};

}  // namespace palpate
