#include "core/voxels/tree_topology.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace palpate {
namespace {

using Address = std::array<std::int32_t, 3>;

template <int Bits>
NodeMask<Bits> maskOf(const Address& node, const VoxelBits& below) {
  constexpr int kEdge = NodeMask<Bits>::kEdge;
  NodeMask<Bits> mask;
  const std::int32_t x = node[0] * kEdge;
  const int endZ = std::min(kEdge, below.extent[2] - node[2] * kEdge);
  const int endY = std::min(kEdge, below.extent[1] - node[1] * kEdge);
  for (int z = 0; z < endZ; ++z) {
    for (int y = 0; y < endY; ++y) {
      const std::uint64_t* row = below.row(node[1] * kEdge + y, node[2] * kEdge + z);
      // A node's row lies within one word, for the edge divides 64.
      const std::uint64_t bits = row[x >> 6] >> (x & 63) & ((1U << kEdge) - 1U);
      const int at = NodeMask<Bits>::child(0, y, z);
      mask.word[static_cast<std::size_t>(at) >> 6] |= bits << (at & 63);
    }
  }
  return mask;
}

// Masks and links of one level, and the addresses of the level below.
template <int Bits>
std::size_t fillLevel(const std::vector<Address>& nodes, const VoxelBits& below, TreeLevel& level,
                      std::vector<Address>* children) {
  using Mask = NodeMask<Bits>;
  level.masks.assign(nodes.size() * Mask::kBytes, 0);
  level.firstChild.assign(nodes.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      maskOf<Bits>(nodes[n], below).store(level.masks.data(), n);
    }
  });
  std::size_t next = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    level.firstChild[n] = static_cast<std::uint32_t>(next);
    next += static_cast<std::size_t>(Mask::load(level.masks.data(), n).count());
  }
  if (children == nullptr) return next;
  children->resize(next);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      std::size_t at = level.firstChild[n];
      forEachChild(Mask::load(level.masks.data(), n), [&](int c) {
        (*children)[at++] = {nodes[n][0] * Mask::kEdge + (c & Mask::kLow),
                             nodes[n][1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                             nodes[n][2] * Mask::kEdge + (c >> (2 * Bits))};
      });
    }
  });
  return next;
}

template <int Bits>
Result<TreeTopology> build(const VoxelBits& occupied) {
  TreeTopology tree;
  const std::int32_t longest = *std::max_element(occupied.extent.begin(), occupied.extent.end());
  tree.levels = 1;
  while ((std::int64_t{1} << (Bits * tree.levels)) < longest) ++tree.levels;

  const auto levels = static_cast<std::size_t>(tree.levels);
  std::vector<VoxelBits> boxes(levels);  // [l]: which boxes of level l hold anything, l > 0
  for (std::size_t l = 1; l < levels; ++l) {
    boxes[l] = coarser(l == 1 ? occupied : boxes[l - 1], Bits);
  }
  tree.level.resize(levels + 1);
  tree.address.resize(levels + 1);
  tree.address[levels] = {{0, 0, 0}};
  for (std::size_t l = levels; l >= 1; --l) {
    const std::size_t below =
        fillLevel<Bits>(tree.address[l], l == 1 ? occupied : boxes[l - 1], tree.level[l],
                        l == 1 ? nullptr : &tree.address[l - 1]);
    if (below >= kNoNode) {
      return fail(inputRefused("The tree would have more nodes in one level than can be addressed.")
                      .butFound(std::to_string(below))
                      .wants("fewer than 4294967295")
                      .advise("Select fewer labels, or crop or resample the volume."));
    }
    if (l == 1) tree.leaves = below;
  }
  return tree;
}

}  // namespace

Result<TreeTopology> buildTopology(int bits, const VoxelBits& occupied) {
  switch (bits) {
    case 1:
      return build<1>(occupied);
    case 2:
      return build<2>(occupied);
    default:
      return build<3>(occupied);
  }
}

Result<TreeTopology> buildTopology(int bits, const std::array<std::int32_t, 3>& extent,
                                   const std::vector<std::uint8_t>& occupied) {
  std::array<std::uint8_t, 256> any;
  any.fill(1);
  any[0] = 0;
  return buildTopology(bits, packBits(extent, occupied, any));
}

}  // namespace palpate
