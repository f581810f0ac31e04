#pragma once
/// Bounding spheres of a node as a function of its occupancy mask, computed from geometry.
///
/// A node is a box of `edge` leaf cells a side, cells of any aspect. Spheres are given relative to
/// the node: offset from its centre and radius, both for a node whose children have the size of
/// one cell; the caller scales them with the level (paper 3.1: "scale/offset").
///
/// Tight spheres are the smallest enclosing spheres of the occupied children's boxes, for every
/// pattern. Eight children: from a table over the 255 patterns. 64 and 512 children: computed from
/// the extreme corners of the pattern, a microsecond a node; a query looks them up instead
/// (pattern_spheres.h).

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "core/voxels/node_mask.h"

namespace palpate {

struct NodeSphere {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< From the node's centre, metres.
  double radius = 0.0;                               ///< Metres.
};

/// Which sphere stands for a node (design: "tight spheres", "side offset").
enum class SphereKind : std::uint8_t {
  Full,        ///< The cube's own: s·2^(N·L−1)·√3, centred.
  SideOffset,  ///< Centre shifted to the occupied side, radius reduced as far as it encloses.
  Tight,       ///< The smallest that encloses the occupied children.
};

/// Immutable; any thread may read it. Source: paper 3.1, figure 2, with the design's errata.
class SphereTable {
 public:
  SphereTable() : SphereTable(1, Eigen::Vector3d::Ones()) {}
  /// @param bits  per axis and level: 1, 2 or 3.
  /// @param cell  edges of a leaf cell, metres.
  SphereTable(int bits, const Eigen::Vector3d& cell);

  /// The sphere of a node at `level` >= 1 with this mask, which is not empty; Bits must be those of
  /// the table. Takes no memory.
  template <int Bits>
  [[nodiscard]] NodeSphere sphere(const NodeMask<Bits>& mask, int level,
                                  SphereKind kind) const noexcept;
  /// The sphere of a whole box of level `level` (0: one leaf cell).
  [[nodiscard]] double fullRadius(int level) const noexcept {
    return fullRadius_[static_cast<std::size_t>(level)];
  }
  [[nodiscard]] const Eigen::Vector3d& cell() const noexcept { return cell_; }
  /// The table itself, for a node of two cells a side: pattern 1..255.
  [[nodiscard]] const NodeSphere& tight8(std::uint8_t pattern) const noexcept {
    return tight_[pattern];
  }
  [[nodiscard]] const NodeSphere& side8(std::uint8_t pattern) const noexcept {
    return side_[pattern];
  }

 private:
  struct Box {
    std::array<int, 3> lo, hi;  // occupied children, inclusive
  };
  template <int Bits>
  [[nodiscard]] static Box occupied(const NodeMask<Bits>& mask) noexcept;

  Eigen::Vector3d cell_;
  std::array<NodeSphere, 256> tight_;
  std::array<NodeSphere, 256> side_;
  std::array<double, 32> fullRadius_{};
};

}  // namespace palpate
