#pragma once
/// What the leaves of a tree with voxel leaves carry: a depth each, in six or twelve bits, and a
/// label where there are several.
///
/// A node of level 1 links to its leaves' bytes: the codes (depth_palette.h) of its voxels in
/// order of rank, six bits each, or twelve where one of them needs that (kWideLeaves in the link),
/// padded to whole bytes; then a label a voxel, unless all voxels have the same. Normals are not
/// stored, for they follow from the depths around a voxel; only a surface-only tree, which lacks
/// those, has a UnitNormal a voxel at the end.

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "core/base/large_array.h"
#include "core/base/progress.h"
#include "core/voxels/depth_palette.h"
#include "core/voxels/label_grid.h"
#include "core/voxels/tree_topology.h"
#include "core/voxels/unit_normal.h"
#include "core/voxels/voxel_bits.h"

namespace palpate {

inline constexpr std::uint32_t kWideLeaves = 1U << 31;

/// Bytes that the codes of so many voxels take.
[[nodiscard]] constexpr std::size_t leafCodeBytes(std::size_t count, bool wide) noexcept {
  return (count * (wide ? 12 : 6) + 7) / 8;
}

/// The code of the voxel of this rank in a node with this link.
[[nodiscard]] inline std::uint16_t leafCode(const LargeArray<std::uint8_t>& bytes,
                                            std::uint32_t link, int rank) noexcept {
  const bool wide = (link & kWideLeaves) != 0;
  const std::size_t bit = static_cast<std::size_t>(rank) * (wide ? 12 : 6);
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + (link & ~kWideLeaves) + bit / 8, sizeof word);
  return static_cast<std::uint16_t>(word >> (bit % 8) & (wide ? 4095U : 63U));
}
/// Its label, where labels differ. `count`: voxels of the node.
[[nodiscard]] inline std::uint8_t leafLabel(const LargeArray<std::uint8_t>& bytes,
                                            std::uint32_t link, int count, int rank) noexcept {
  return bytes[(link & ~kWideLeaves) +
               leafCodeBytes(static_cast<std::size_t>(count), (link & kWideLeaves) != 0) +
               static_cast<std::size_t>(rank)];
}

/// The bytes of a node of so many voxels.
[[nodiscard]] constexpr std::size_t leafBytesOf(std::size_t count, bool wide, bool labelled,
                                                bool withNormals) noexcept {
  return leafCodeBytes(count, wide) + (labelled ? count : 0) +
         (withNormals ? count * sizeof(UnitNormal) : 0);
}
/// The normal of a voxel of a surface-only tree.
[[nodiscard]] inline UnitNormal leafNormal(const LargeArray<std::uint8_t>& bytes,
                                           std::uint32_t link, int count, int rank,
                                           bool labelled) noexcept {
  UnitNormal normal;
  const std::size_t before =
      leafBytesOf(static_cast<std::size_t>(count), (link & kWideLeaves) != 0, labelled, false);
  std::memcpy(&normal,
              bytes.data() + (link & ~kWideLeaves) + before +
                  static_cast<std::size_t>(rank) * sizeof normal,
              sizeof normal);
  return normal;
}

/// What one node's voxels carry, in order of rank.
struct NodeLeaves {
  std::vector<std::uint16_t> codes;
  std::vector<std::uint8_t> labels;  ///< Empty where all are the same.
  std::vector<UnitNormal> normals;   ///< Of a surface-only tree.

  void clear() {
    codes.clear();
    labels.clear();
    normals.clear();
  }
};

/// Appends one node's bytes; gives its link.
[[nodiscard]] std::uint32_t appendLeaves(const NodeLeaves& leaves,
                                         std::vector<std::uint8_t>& bytes);

/// Fills `bytes` and the links of level 1, which are the number of voxels before on entry.
/// @param oneLabel  0 where labels differ. `withNormals`: for a surface-only tree. Cancelled where
/// progress says so.
[[nodiscard]] Result<void> fillLeaves(const LabelGrid& grid, const VoxelBits& solid,
                                      const DepthPalette& palette, std::uint8_t oneLabel, int bits,
                                      bool withNormals, TreeTopology& topology,
                                      LargeArray<std::uint8_t>& bytes, const Progress& progress);

}  // namespace palpate
