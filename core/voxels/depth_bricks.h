#pragma once
/// The depths of distance leaves, and how far space is from them, on the nodes of the tree.
///
/// Two block sizes carry them: 4³ cells and 16³ cells (levels 1 and 2 of the 64-tree, 2 and 4 of
/// the octree; a 512-tree's nodes of 8³ and 64³ cells hold whole blocks of these). A word for
/// every block says what is there:
///  - `coarse`, a word for every 16³ block of the grid: a link to the block's 64 words, or a
///    clearance (clearance_word.h) where nothing is near;
///  - `words`, 64 for every 16³ block that holds bricks or is near one: a link to a brick, or a
///    clearance;
///  - a brick: codes of the 5³ corners of 4³ cells (depth_palette.h), five codes of six bits a
///    32-bit row, and the brick's own clearance. A *wide* brick, where a code takes twelve bits,
///    has a second slot with the upper six.
/// Where no cell of a block can be in contact there is no brick; bricks deeper than saturation all
/// over are shared, one for each of some directions outwards. Clearances bound the distance to the
/// contact region from below everywhere in their block (site_search.h).

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/base/large_array.h"
#include "core/base/progress.h"
#include "core/voxels/clearance_word.h"
#include "core/voxels/depth_palette.h"
#include "core/voxels/label_grid.h"
#include "core/voxels/voxel_bits.h"

namespace palpate {

struct DepthBricks {
  static constexpr int kEdge = 4;         ///< Cells along a brick.
  static constexpr int kCoarseEdge = 16;  ///< Cells along a block of 64 words.
  static constexpr std::size_t kRows = 25;
  static constexpr std::size_t kSlotWords = 26;           ///< Rows, then the clearance.
  static constexpr std::uint32_t kWide = 1U << 30;        ///< In a link to a brick.
  static constexpr std::uint32_t kPlaceMask = kWide - 1;  ///< Of a slot's first word, by two.
  static constexpr std::size_t kLabelBytes = 128;         ///< Labels of 5³ corners, padded.
  static constexpr std::uint32_t kOneLabel = 1U << 31;    ///< In `label`: the low byte is it.

  std::array<std::int32_t, 3> blocks{0, 0, 0};  ///< Of 16³ cells along x, y, z.
  LargeArray<std::uint32_t> coarse;             ///< x fastest.
  LargeArray<std::uint32_t> firstWord;  ///< Beside it, for points: of the block's words, else 0.
  LargeArray<std::uint32_t> words;      ///< The first 64 are zero: no brick anywhere.
  LargeArray<std::uint32_t> slots;      ///< Slot 0 is far outside everywhere.
  DepthPalette palette;

  std::uint8_t uniformLabel = 0;    ///< Not 0: the only label; `label` is empty.
  LargeArray<std::uint32_t> label;  ///< Beside `words`: the only label of a brick, or which bytes.
  LargeArray<std::uint8_t> labelBytes;

  [[nodiscard]] std::size_t blockAt(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(blocks[0]) +
           static_cast<std::size_t>(x);
  }
  /// Place in `words` of the 4³ block that holds a cell; below 64 where there are no words.
  [[nodiscard]] std::size_t wordAt(const std::array<std::int32_t, 3>& cell) const noexcept {
    const auto child =
        static_cast<std::size_t>((cell[0] >> 2 & 3) | (cell[1] & 12) | (cell[2] & 12) << 2);
    return firstWord[blockAt(cell[0] >> 4, cell[1] >> 4, cell[2] >> 4)] + child;
  }
  /// The link of the brick that holds a cell; 0 (the far slot) where there is none.
  [[nodiscard]] std::uint32_t linkAt(const std::array<std::int32_t, 3>& cell) const noexcept {
    const std::uint32_t word = words[wordAt(cell)];
    return (word & ClearanceWord::kLink) != 0 ? word & ~ClearanceWord::kLink : 0;
  }
  /// A link (without the link bit) to the slot of this number, and where a link's slot begins.
  [[nodiscard]] static constexpr std::uint32_t linkTo(std::size_t slot, bool wide) noexcept {
    return static_cast<std::uint32_t>(slot * (kSlotWords / 2)) | (wide ? kWide : 0U);
  }
  [[nodiscard]] static constexpr std::size_t placeOf(std::uint32_t link) noexcept {
    return std::size_t{link & kPlaceMask} * 2;
  }
  /// The code of corner (x, y, z), 0..4 each, of a linked brick.
  [[nodiscard]] std::uint16_t codeAt(std::uint32_t link, int x, int y, int z) const noexcept {
    const std::uint32_t* row = &slots[placeOf(link) + static_cast<std::size_t>(y + 5 * z)];
    std::uint32_t code = *row >> (6 * x) & 63U;
    if ((link & kWide) != 0) code |= (row[kSlotWords] >> (6 * x) & 63U) << 6;
    return static_cast<std::uint16_t>(code);
  }
  /// The label of corner (x, y, z) of the brick at this place in `words`; 0 outside.
  [[nodiscard]] std::uint8_t labelOf(std::size_t word, int x, int y, int z) const noexcept {
    if (uniformLabel != 0) return uniformLabel;
    if ((label[word] & kOneLabel) != 0) return static_cast<std::uint8_t>(label[word] & 255U);
    return labelBytes[label[word] * kLabelBytes + static_cast<std::size_t>(x + 5 * (y + 5 * z))];
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return coarse.bytes() + firstWord.bytes() + words.bytes() + slots.bytes() + label.bytes() +
           labelBytes.bytes();
  }
};

/// The label of all voxels inside, or 0 where there are several.
[[nodiscard]] std::uint8_t onlyLabelOf(const LabelGrid& grid, const VoxelBits& solid);

/// Bricks for every present cell, clearances for all of space. `solid` are the voxels inside,
/// `cells` the cells of the tree (extent one less). Cancelled where progress says so; refuses more
/// bricks than can be linked.
[[nodiscard]] Result<DepthBricks> buildDepthBricks(const LabelGrid& grid, const VoxelBits& solid,
                                                   const VoxelBits& cells,
                                                   const Progress& progress);

}  // namespace palpate
