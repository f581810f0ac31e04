#pragma once
/// The shell's hierarchy side by side, as vectors read it: sixteen sibling spheres, sixteen points.
///
/// The same nodes and ranks as ShellHierarchy, in single precision and relative to the middle of
/// the shell, so that a tool far from its frame's origin loses nothing. Radii hold what the
/// rounding of a centre lost.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace palpate {

struct ShellHierarchy;

/// Sixteen children of one node. Places without a child never touch anything (radius −1e9).
struct alignas(64) SphereBlock {
  float x[16], y[16], z[16], r[16];  ///< T less the middle, metres.
};

/// Sixteen points of one leaf node. Places without a point lie far from everything.
struct alignas(64) PointBlock {
  float x[16], y[16], z[16];  ///< T less the middle, metres.
  std::uint32_t index[16];    ///< Of the shell.
};

struct ShellBlocks {
  /// A descent begins at the finest level of at most so many nodes: a few spheres too many cost
  /// less than a level.
  static constexpr std::size_t kStart = 64;

  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< T, metres.
  double reach = 0.0;                                ///< Of any point from the middle, metres.
  std::vector<PointBlock> leaf;                      ///< One a node of level 0.
  std::vector<std::vector<SphereBlock>> level;       ///< [l][n]: nodes 16n .. 16n + 15 of level l.
  std::vector<std::size_t> count;                    ///< Nodes of a level.
  std::size_t start = 0;                             ///< The level where a descent begins.
};

/// About the middle of the box of the hierarchy's points, or about a given one (T, metres).
[[nodiscard]] ShellBlocks buildShellBlocks(const ShellHierarchy& hierarchy);
[[nodiscard]] ShellBlocks buildShellBlocks(const ShellHierarchy& hierarchy,
                                           const Eigen::Vector3d& middle);

}  // namespace palpate
