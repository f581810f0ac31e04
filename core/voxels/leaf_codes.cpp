#include "core/voxels/leaf_codes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>

#include "core/voxels/banded_distance.h"
#include "core/voxels/outward_normal.h"
#include "core/voxels/square_view.h"

namespace palpate {
namespace {

constexpr std::int32_t kSlab = 64;   // slices measured at a time; whole nodes for every tree
constexpr std::size_t kChunk = 512;  // nodes that share a buffer
constexpr std::size_t kMost = kWideLeaves - 1;

using Address = std::array<std::int32_t, 3>;

// The nodes of level 1 by the slab that holds them, in order within.
std::vector<std::vector<std::uint32_t>> bySlab(const std::vector<Address>& nodes, int edge,
                                               std::int32_t slices) {
  std::vector<std::vector<std::uint32_t>> slabs(
      static_cast<std::size_t>((slices + kSlab - 1) / kSlab));
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    slabs[static_cast<std::size_t>(nodes[n][2] * edge / kSlab)].push_back(
        static_cast<std::uint32_t>(n));
  }
  return slabs;
}

struct Chunk {
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint32_t> link;
};

template <int Bits>
class LeafFiller {
 public:
  using Mask = NodeMask<Bits>;
  LeafFiller(const LabelGrid& grid, const DepthPalette& palette, std::uint8_t oneLabel,
             bool withNormals, const TreeTopology& topology)
      : grid_(grid),
        palette_(palette),
        oneLabel_(oneLabel),
        withNormals_(withNormals),
        topology_(topology) {}

  void fill(const SquareView& view, std::span<const std::uint32_t> nodes, Chunk& out) const {
    NodeLeaves leaves;
    for (const std::uint32_t n : nodes) {
      leaves.clear();
      const Address& at = topology_.address[1][n];
      forEachChild(Mask::load(topology_.level[1].masks.data(), n), [&](int c) {
        const std::int32_t i = at[0] * Mask::kEdge + (c & Mask::kLow);
        const std::int32_t j = at[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow);
        const std::int32_t k = at[2] * Mask::kEdge + (c >> (2 * Bits));
        leaves.codes.push_back(palette_.codeOf(view.at(i, j, k)));
        if (oneLabel_ == 0) leaves.labels.push_back(grid_.at(i, j, k));
        if (withNormals_) leaves.normals.push_back(encodeNormal(normalAt(view, {i, j, k})));
      });
      out.link.push_back(appendLeaves(leaves, out.bytes));
    }
  }

 private:
  // As the query finds it in a tree that has all voxels.
  [[nodiscard]] Eigen::Vector3d normalAt(const SquareView& view, const Address& voxel) const {
    const GridGeometry& g = grid_.geometry;
    return outwardNormal(
        neighbourhoodOf(voxel, g.dims,
                        [&](const Address& at) {
                          const float square = view.at(at[0], at[1], at[2]);
                          return square > 0.0f
                                     ? kEmptyValue
                                     : static_cast<double>(palette_.value(palette_.codeOf(square)));
                        }),
        g.spacing);
  }

  const LabelGrid& grid_;
  const DepthPalette& palette_;
  std::uint8_t oneLabel_;
  bool withNormals_;
  const TreeTopology& topology_;
};

template <int Bits>
Result<void> fillFor(const LabelGrid& grid, const VoxelBits& solid, const DepthPalette& palette,
                     std::uint8_t oneLabel, bool withNormals, TreeTopology& topology,
                     LargeArray<std::uint8_t>& bytes, const Progress& progress) {
  const LeafFiller<Bits> filler(grid, palette, oneLabel, withNormals, topology);
  const auto slabs = bySlab(topology.address[1], NodeMask<Bits>::kEdge, grid.geometry.dims[2]);
  BandedDistance distance(solid, palette);
  std::vector<float> square;
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    progress(0.4 + 0.5 * static_cast<double>(s) / static_cast<double>(slabs.size()),
             "Measuring depths");
    if (progress.cancelled()) return fail(cancelled());
    if (slabs[s].empty()) continue;
    const auto first = static_cast<std::int32_t>(s) * kSlab;
    const std::int32_t last = std::min(first + kSlab, grid.geometry.dims[2]);
    // Normals look one slice farther.
    const std::int32_t from = std::max(first - 1, 0);
    const std::int32_t to = std::min(last + 1, grid.geometry.dims[2]);
    distance.slab(from, to, square);
    const SquareView view{
        square.data(), {0, 0, from}, {solid.extent[0], solid.extent[1], to - from}};
    const std::span<const std::uint32_t> nodes(slabs[s]);
    std::vector<Chunk> chunks((nodes.size() + kChunk - 1) / kChunk);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks.size()), [&](const auto& range) {
      for (std::size_t c = range.begin(); c != range.end(); ++c) {
        const std::size_t begin = c * kChunk;
        filler.fill(view, nodes.subspan(begin, std::min(kChunk, nodes.size() - begin)), chunks[c]);
      }
    });
    std::size_t node = 0;
    for (const Chunk& chunk : chunks) {
      if (bytes.size() + chunk.bytes.size() > kMost) {
        return fail(inputRefused("The tree would have more depths than can be linked.")
                        .butFound(std::to_string(topology.leaves) + " voxels")
                        .advise("Select fewer labels, or crop or resample the volume."));
      }
      const auto start = static_cast<std::uint32_t>(bytes.size());
      bytes.append(chunk.bytes.data(), chunk.bytes.size());
      for (const std::uint32_t link : chunk.link) {
        topology.level[1].firstChild[nodes[node++]] = start + link;
      }
    }
  }
  return {};
}

}  // namespace

std::uint32_t appendLeaves(const NodeLeaves& leaves, std::vector<std::uint8_t>& bytes) {
  const bool wide = std::any_of(leaves.codes.begin(), leaves.codes.end(),
                                [](std::uint16_t c) { return c >= DepthPalette::kNarrow; });
  const std::size_t start = bytes.size();
  bytes.resize(start + leafCodeBytes(leaves.codes.size(), wide), 0);
  std::size_t bit = 0;
  for (const std::uint16_t code : leaves.codes) {
    const std::uint32_t word = static_cast<std::uint32_t>(code) << (bit % 8);
    for (std::size_t b = 0; word >> (8 * b) != 0; ++b) {
      std::uint8_t& byte = bytes[start + bit / 8 + b];
      byte = static_cast<std::uint8_t>(byte | (word >> (8 * b) & 255U));
    }
    bit += wide ? 12 : 6;
  }
  bytes.insert(bytes.end(), leaves.labels.begin(), leaves.labels.end());
  const auto* normals = reinterpret_cast<const std::uint8_t*>(leaves.normals.data());
  bytes.insert(bytes.end(), normals, normals + leaves.normals.size() * sizeof(UnitNormal));
  return static_cast<std::uint32_t>(start) | (wide ? kWideLeaves : 0U);
}

Result<void> fillLeaves(const LabelGrid& grid, const VoxelBits& solid, const DepthPalette& palette,
                        std::uint8_t oneLabel, int bits, bool withNormals, TreeTopology& topology,
                        LargeArray<std::uint8_t>& bytes, const Progress& progress) {
  switch (bits) {
    case 1:
      return fillFor<1>(grid, solid, palette, oneLabel, withNormals, topology, bytes, progress);
    case 2:
      return fillFor<2>(grid, solid, palette, oneLabel, withNormals, topology, bytes, progress);
    default:
      return fillFor<3>(grid, solid, palette, oneLabel, withNormals, topology, bytes, progress);
  }
}

}  // namespace palpate
