#include "core/collision/body_tree.h"

#include <algorithm>

#include "core/voxels/node_mask.h"
#include "core/voxels/tree_topology.h"

namespace palpate {
namespace {

using Address = std::array<std::int32_t, 3>;

// The box of the surface voxels. The tree is over it, not over the grid: air around a body would
// only add levels.
struct Box {
  Address lo{}, extent{};
};

Box boxOf(std::span<const Address> voxels) {
  Box box{voxels[0], {}};
  Address hi = voxels[0];
  for (const Address& v : voxels) {
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = std::min(box.lo[a], v[a]);
      hi[a] = std::max(hi[a], v[a]);
    }
  }
  for (std::size_t a = 0; a < 3; ++a) box.extent[a] = hi[a] - box.lo[a] + 1;
  return box;
}

// Calls f(leaf, address in the box) for every leaf.
template <int Bits, class F>
void forEachLeaf(const TreeTopology& topology, F&& f) {
  using Mask = NodeMask<Bits>;
  std::size_t leaf = 0;
  for (std::size_t n = 0; n < topology.address[1].size(); ++n) {
    const Address& at = topology.address[1][n];
    forEachChild(Mask::load(topology.level[1].masks.data(), n), [&](int c) {
      f(leaf++, Address{at[0] * Mask::kEdge + (c & Mask::kLow),
                        at[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                        at[2] * Mask::kEdge + (c >> (2 * Bits))});
    });
  }
}

template <int Bits>
Result<BodyTree> buildTree(const Box& box, const std::vector<std::uint8_t>& occupied,
                           const GridGeometry& grid, std::span<const Address> voxels,
                           const std::vector<std::uint32_t>& rankOf) {
  auto topology = buildTopology(Bits, box.extent, occupied);
  if (!topology) return fail(topology.error());
  BodyTree tree;
  tree.levels = topology->levels;
  tree.rank.resize(topology->leaves);
  forEachLeaf<Bits>(*topology, [&](std::size_t leaf, const Address& at) {
    const Address voxel{at[0] + box.lo[0], at[1] + box.lo[1], at[2] + box.lo[2]};
    const auto found = std::lower_bound(
        voxels.begin(), voxels.end(), voxel, [&grid](const Address& a, const Address& b) {
          return grid.index(a[0], a[1], a[2]) < grid.index(b[0], b[1], b[2]);
        });
    tree.rank[leaf] = rankOf[static_cast<std::size_t>(found - voxels.begin())];
  });
  tree.level = std::move(topology->level);
  return tree;
}

}  // namespace

Result<VoxelBody> buildVoxelBody(const GridGeometry& grid, std::span<const Address> voxels,
                                 std::span<const Eigen::Vector3d> points_T,
                                 std::span<const std::uint32_t> order) {
  const Box box = boxOf(voxels);
  GridGeometry inBox;
  inBox.dims = box.extent;
  std::vector<std::uint8_t> occupied(inBox.voxelCount(), 0);
  for (const Address& v : voxels) {
    occupied[inBox.index(v[0] - box.lo[0], v[1] - box.lo[1], v[2] - box.lo[2])] = 1;
  }
  std::vector<std::uint32_t> rankOf(order.size());
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    rankOf[order[rank]] = static_cast<std::uint32_t>(rank);
  }

  VoxelBody body;
  body.spacing = grid.spacing;
  body.axes_T = grid.X_PV.linear();
  body.origin_T = grid.X_PV * grid.centre_V(box.lo[0] - 0.5, box.lo[1] - 0.5, box.lo[2] - 0.5);
  // Points were rounded in the grid's frame, node centres will be from the box's corner: what they
  // differ by, and 2^-40 of the lengths involved for what turning them will round.
  const Eigen::Vector3d diagonal =
      Eigen::Vector3d(box.extent[0], box.extent[1], box.extent[2]).cwiseProduct(grid.spacing);
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    Eigen::Vector3d fromCorner;
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      fromCorner[a] = (voxels[i][axis] - box.lo[axis] + 0.5) * grid.spacing[a];
    }
    const double off = (body.origin_T + body.axes_T * fromCorner - points_T[i]).norm();
    body.slack = std::max(body.slack, off);
  }
  body.slack += 0x1p-40 * (body.origin_T.norm() + diagonal.norm());

  auto tree8 = buildTree<1>(box, occupied, grid, voxels, rankOf);
  if (!tree8) return fail(tree8.error());
  auto tree64 = buildTree<2>(box, occupied, grid, voxels, rankOf);
  if (!tree64) return fail(tree64.error());
  auto tree512 = buildTree<3>(box, occupied, grid, voxels, rankOf);
  if (!tree512) return fail(tree512.error());
  body.tree = {std::move(*tree8), std::move(*tree64), std::move(*tree512)};
  return body;
}

}  // namespace palpate
