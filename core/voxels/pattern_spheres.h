#pragma once
/// The bounding spheres of the occupancy patterns that occur in one tree, computed once, so that a
/// descent does one look-up a node (paper 3.1: "directly indexing into a table").
///
/// Of the 2^64 or 2^512 patterns a tree holds at most as many as it has nodes; those are hashed.
/// Eight children need no hash: a table over all 256. Immutable; any thread may read it. Building
/// takes memory and, for many patterns, TBB's help; looking up takes neither.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxels/node_mask.h"
#include "core/voxels/sphere_table.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// A node's sphere wherever the node is and however it is turned.
struct PatternSphere {
  /// Offset from the node's centre along the tree's axes, in edges of a child.
  std::array<double, 3> offset{0, 0, 0};
  /// Metres, if a child were one leaf cell: at level l times 2^(Bits·(l−1)).
  double radius = 0.0;
};

class PatternSpheres {
 public:
  PatternSpheres() = default;
  /// @param cell   edges of a leaf cell, metres.
  /// @param level  [1] .. [levels]; [0] is not read.
  PatternSpheres(int bits, const Eigen::Vector3d& cell, SphereKind kind,
                 std::span<const TreeLevel> level);

  /// Bits must be those of the tree. A pattern that is not in the tree gets the whole node's
  /// sphere.
  template <int Bits>
  [[nodiscard]] const PatternSphere& of(const NodeMask<Bits>& mask) const noexcept;
  /// Of a whole node.
  [[nodiscard]] const PatternSphere& full() const noexcept { return sphere_[0]; }
  /// How many spheres there are, the whole node's among them.
  [[nodiscard]] std::size_t size() const noexcept { return sphere_.size(); }

 private:
  template <int Bits>
  void fill(const SphereTable& table, SphereKind kind, std::span<const TreeLevel> level);
  template <int Bits>
  [[nodiscard]] std::size_t slotOf(const NodeMask<Bits>& mask) const noexcept;

  std::vector<PatternSphere> sphere_ = std::vector<PatternSphere>(1);  ///< [0]: the whole node.
  std::vector<std::uint64_t> pattern_;  ///< A mask's words for every sphere.
  std::vector<std::uint32_t> slot_;     ///< Open addressing, a power of two: sphere, 0 is free.
};

}  // namespace palpate
