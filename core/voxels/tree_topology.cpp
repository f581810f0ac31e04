#include "core/voxels/tree_topology.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace palpate {
namespace {

using Address = std::array<std::int32_t, 3>;

// Which boxes of one level hold anything, dense.
struct Flags {
  Address extent{};
  std::vector<std::uint8_t> set;
  [[nodiscard]] std::size_t index(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(extent[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(extent[0]) +
           static_cast<std::size_t>(x);
  }
};

Flags coarser(const Address& extent, const std::vector<std::uint8_t>& set, int bits) {
  Flags fine{extent, {}};
  Flags out;
  for (std::size_t a = 0; a < 3; ++a) {
    out.extent[a] = ((extent[a] - 1) >> bits) + 1;
  }
  out.set.assign(static_cast<std::size_t>(out.extent[0]) * static_cast<std::size_t>(out.extent[1]) *
                     static_cast<std::size_t>(out.extent[2]),
                 0);
  tbb::parallel_for(tbb::blocked_range<std::int32_t>(0, out.extent[2]), [&](const auto& range) {
    const std::int32_t zEnd = std::min(range.end() << bits, extent[2]);
    for (std::int32_t z = range.begin() << bits; z < zEnd; ++z) {
      for (std::int32_t y = 0; y < extent[1]; ++y) {
        const std::uint8_t* row = set.data() + fine.index(0, y, z);
        std::uint8_t* to = out.set.data() + out.index(0, y >> bits, z >> bits);
        for (std::int32_t x = 0; x < extent[0]; ++x) to[x >> bits] |= row[x];
      }
    }
  });
  return out;
}

template <int Bits>
NodeMask<Bits> maskOf(const Address& node, const Flags& dims,
                      const std::vector<std::uint8_t>& set) {
  constexpr int kEdge = NodeMask<Bits>::kEdge;
  NodeMask<Bits> mask;
  for (int z = 0; z < kEdge; ++z) {
    const std::int32_t cz = node[2] * kEdge + z;
    if (cz >= dims.extent[2]) break;
    for (int y = 0; y < kEdge; ++y) {
      const std::int32_t cy = node[1] * kEdge + y;
      if (cy >= dims.extent[1]) break;
      for (int x = 0; x < kEdge; ++x) {
        const std::int32_t cx = node[0] * kEdge + x;
        if (cx >= dims.extent[0]) break;
        if (set[dims.index(cx, cy, cz)] != 0) mask.set(NodeMask<Bits>::child(x, y, z));
      }
    }
  }
  return mask;
}

// Masks and links of one level, and the addresses of the level below.
template <int Bits>
std::size_t fillLevel(const std::vector<Address>& nodes, const Flags& below,
                      const std::vector<std::uint8_t>& belowSet, TreeLevel& level,
                      std::vector<Address>* children) {
  using Mask = NodeMask<Bits>;
  level.masks.assign(nodes.size() * Mask::kBytes, 0);
  level.firstChild.assign(nodes.size(), 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      maskOf<Bits>(nodes[n], below, belowSet).store(level.masks.data(), n);
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
Result<TreeTopology> build(const Address& extent, const std::vector<std::uint8_t>& occupied) {
  TreeTopology tree;
  const std::int32_t longest = *std::max_element(extent.begin(), extent.end());
  tree.levels = 1;
  while ((std::int64_t{1} << (Bits * tree.levels)) < longest) ++tree.levels;

  const auto levels = static_cast<std::size_t>(tree.levels);
  std::vector<Flags> flags(levels);  // [l]: boxes of level l; [0] only for its extent
  flags[0].extent = extent;
  for (std::size_t l = 1; l < levels; ++l) {
    flags[l] = coarser(flags[l - 1].extent, l == 1 ? occupied : flags[l - 1].set, Bits);
  }
  tree.level.resize(levels + 1);
  tree.address.resize(levels + 1);
  tree.address[levels] = {{0, 0, 0}};
  for (std::size_t l = levels; l >= 1; --l) {
    const auto& set = l == 1 ? occupied : flags[l - 1].set;
    const std::size_t below = fillLevel<Bits>(tree.address[l], flags[l - 1], set, tree.level[l],
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

Result<TreeTopology> buildTopology(int bits, const std::array<std::int32_t, 3>& extent,
                                   const std::vector<std::uint8_t>& occupied) {
  switch (bits) {
    case 1:
      return build<1>(extent, occupied);
    case 2:
      return build<2>(extent, occupied);
    default:
      return build<3>(extent, occupied);
  }
}

}  // namespace palpate
