#pragma once
/// The leaf model at one point: which item holds it, is it inside, how deep, which way is out.
///
/// Every method of ContactFinder ends here with the same arithmetic, so their contact sets are
/// equal by construction wherever culling is conservative. Works in V, metres, in double; a point
/// is located by p / spacing as GridGeometry::voxelAt does it. Nothing allocates.

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/collision/contact.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// A rigid pose as plain numbers: rows of the rotation, translation.
struct QueryPose {
  double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double t[3] = {0, 0, 0};

  [[nodiscard]] static QueryPose of(const Eigen::Isometry3d& X) noexcept {
    QueryPose pose;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) pose.r[i][j] = X(i, j);
      pose.t[i] = X(i, 3);
    }
    return pose;
  }
  void apply(double x, double y, double z, double out[3]) const noexcept {
    for (int i = 0; i < 3; ++i) out[i] = ((r[i][0] * x + r[i][1] * y) + r[i][2] * z) + t[i];
  }
};

using Item = std::array<std::int32_t, 3>;

/// Index of the node of `level` that holds an item of the tree's extent, or kNoNode.
template <int Bits>
[[nodiscard]] std::uint32_t findNode(const VoxelTree::Data& tree, const Item& item,
                                     int level) noexcept {
  using Mask = NodeMask<Bits>;
  std::uint32_t node = 0;
  for (int l = tree.levels; l > level; --l) {
    const TreeLevel& at = tree.level[static_cast<std::size_t>(l)];
    const int shift = Bits * (l - 1);
    const int child = Mask::child((item[0] >> shift) & Mask::kLow, (item[1] >> shift) & Mask::kLow,
                                  (item[2] >> shift) & Mask::kLow);
    const Mask mask = Mask::load(at.masks.data(), node);
    if (!mask.test(child)) return kNoNode;
    node = at.firstChild[node] + static_cast<std::uint32_t>(mask.rank(child));
  }
  return node;
}

/// Remembers the last node that it found: points in the order of the hierarchy mostly share it.
template <int Bits>
class LeafTest {
 public:
  explicit LeafTest(const VoxelTree::Data& tree) noexcept
      : tree_(tree), nodeLevel_(tree.options.leaf == LeafModel::Distance ? tree.brickLevel : 1) {}

  /// The item that holds p_V; false outside the tree's extent (and for what is not finite).
  [[nodiscard]] bool locate(const double p[3], Item& item) const noexcept;

  /// True when p_V is in contact; then fills everything of `contact` but shellIndex.
  [[nodiscard]] bool evaluate(const double p[3], Contact& contact) noexcept;

  /// The contact that stands for a node where descent was cut: the plane through the node's leaf
  /// nearest to p_V. Depth may be 0. `node` is an index at `level` >= 1, `item` an item in it.
  void evaluateCut(const double p[3], const Item& item, std::uint32_t node, int level,
                   Contact& contact) const noexcept;

 private:
  [[nodiscard]] std::uint32_t nodeOf(const Item& item) noexcept;
  [[nodiscard]] bool evaluateVoxel(const double p[3], const Item& item, Contact& c) noexcept;
  [[nodiscard]] bool evaluateDistance(const double p[3], const Item& item, Contact& c) noexcept;
  void planeOfVoxel(const double p[3], const Item& item, std::uint32_t leaf,
                    Contact& c) const noexcept;
  /// The trilinear value at p, which lies in (or is drawn to) the cell; the gradient is in V.
  [[nodiscard]] double interpolate(const double p[3], const Item& cell, std::uint32_t brick,
                                   double gradient[3], std::uint8_t& label) const noexcept;
  void fillDistance(const double p[3], double value, const double gradient[3], std::uint8_t label,
                    Contact& c) const noexcept;

  const VoxelTree::Data& tree_;
  int nodeLevel_;
  Item key_{-1, -1, -1};
  std::uint32_t node_ = kNoNode;
};

extern template class LeafTest<1>;
extern template class LeafTest<2>;
extern template class LeafTest<3>;

}  // namespace palpate
