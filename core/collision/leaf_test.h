#pragma once
/// The leaf model at one point: which item holds it, is it inside, how deep, which way is out.
///
/// For points one at a time; fast_query.h does many of distance leaves at once with the same
/// operations in the same order, so that every method of ContactFinder gives the same bits
/// wherever culling is conservative. Voxel leaves are located in double as GridGeometry::voxelAt
/// does it, distance leaves in single precision as CellPose does it. Nothing allocates.

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/collision/cell_pose.h"
#include "core/collision/contact.h"
#include "core/voxels/outward_normal.h"
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

/// A shell point where the pose puts it.
struct PlacedPoint {
  double p[3] = {0, 0, 0};  ///< V, metres.
  float u[3] = {0, 0, 0};   ///< Cells; distance leaves only.
};

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

/// Depth and unit normal of a voxel, remembered from step to step: a sliding tool meets the same
/// voxels again and again, and the normal takes 27 look-ups. Never changes a result.
struct VoxelMemo {
  static constexpr std::size_t kEntries = 4096;
  struct Entry {
    std::uint64_t voxel = ~std::uint64_t{0};
    double n[3] = {0, 0, 1};
    double depth = 0;  ///< D, metres.
  };
  std::vector<Entry> entry = std::vector<Entry>(kEntries);
  std::uint64_t edits = 0;  ///< Of the tree, when this was true of it.

  [[nodiscard]] Entry& at(std::uint64_t voxel) noexcept {
    return entry[voxel * 0x9E3779B97F4A7C15ULL >> 52];
  }
  /// Forgets everything where the tree has been edited since.
  void follow(std::uint64_t treeEdits) noexcept {
    if (edits == treeEdits) return;
    for (Entry& e : entry) e.voxel = ~std::uint64_t{0};
    edits = treeEdits;
  }
};

/// What the bricks say at a point, in the units of the arithmetic.
struct DistanceSample {
  float value = 0;                ///< Steps of depth times kFractionOne, > 0 outside.
  float gradient[3] = {0, 0, 0};  ///< The same a cell.
};

/// Remembers the last node that it found for each of the eight parities of addresses: points in the
/// order of the hierarchy mostly share one, and the voxels around a voxel lie in at most eight.
template <int Bits>
class LeafTest {
 public:
  LeafTest(const VoxelTree::Data& tree, VoxelMemo& memo) noexcept;

  /// The item that holds a point; false outside the tree's extent (and for what is not finite).
  [[nodiscard]] bool locate(const PlacedPoint& point, Item& item) const noexcept;

  /// True when the point is in contact; then fills everything of `contact` but shellIndex.
  [[nodiscard]] bool evaluate(const PlacedPoint& point, Contact& contact) noexcept;

  /// The contact that stands for a node where descent was cut: the plane through the node's leaf
  /// nearest to the point. Depth may be 0. `node` is an index at `level` >= 1, `item` an item in
  /// it.
  void evaluateCut(const PlacedPoint& point, const Item& item, std::uint32_t node, int level,
                   Contact& contact) noexcept;

  /// A contact of distance leaves from its depth (metres) and normal as the queries have them.
  void fillDistance(const PlacedPoint& point, float depth, const float normal[3],
                    Contact& contact) const noexcept;

 private:
  struct Known {
    Item address{-1, -1, -1};
    std::uint32_t node = kNoNode;
    NodeMask<Bits> mask;     // empty where there is no node
    std::uint32_t link = 0;  // of voxel leaves
  };
  [[nodiscard]] const Known& nodeOf(const Item& item) noexcept;
  [[nodiscard]] bool codeOf(const Item& voxel, std::uint16_t& code, std::uint8_t& label) noexcept;
  void depthsAlong(const Item& first, int count, double* depth) noexcept;
  [[nodiscard]] Neighbourhood depthsAround(const Item& voxel) noexcept;
  [[nodiscard]] bool evaluateVoxel(const PlacedPoint& point, const Item& item, Contact& c) noexcept;
  [[nodiscard]] bool evaluateDistance(const PlacedPoint& point, const Item& item,
                                      Contact& c) noexcept;
  void planeOfVoxel(const PlacedPoint& point, const Item& item, std::uint16_t code,
                    std::uint8_t label, Contact& c) noexcept;
  void remember(const Item& item, std::uint16_t code, VoxelMemo::Entry& entry) noexcept;
  [[nodiscard]] DistanceSample interpolate(const Item& cell, const float f[3]) const noexcept;
  [[nodiscard]] std::uint8_t labelAt(const PlacedPoint& point) const noexcept;

  const VoxelTree::Data& tree_;
  VoxelMemo& memo_;
  double unit_;          // the smallest spacing, metres
  float metresPerStep_;  // of DistanceSample::value
  float edge_[3];        // of a cell, smallest spacings
  std::array<Known, 8> known_;
};

extern template class LeafTest<1>;
extern template class LeafTest<2>;
extern template class LeafTest<3>;

}  // namespace palpate
