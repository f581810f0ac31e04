#pragma once
/// What the builder knows of each block of 16³ cells, between its stages. Internal to the build.

#include <array>
#include <cstdint>
#include <vector>

#include "core/voxels/lattice_clearance.h"
#include "core/voxels/region_site.h"

namespace palpate {

/// One bit a 4³ block: bit x | y << 2 | z << 4, like a node of the 64-tree.
struct BrickPlan {
  std::uint64_t bricks = 0;  ///< Holds a present cell.
  std::uint64_t wide = 0;    ///< Its codes need twelve bits.
  std::uint64_t deep = 0;    ///< Saturated all over: shares a brick.
  bool near = false;         ///< Has words though it may have no brick.
  std::uint32_t wordBlock = 0;
  std::uint32_t firstSlot = 0;

  // Child after child, of the children with bricks of their own.
  std::vector<std::uint32_t> rows;  ///< kSlotWords a slot.
  std::vector<RegionSite> sites;    ///< Of their mixed cells.
  std::vector<std::uint16_t> siteCount;
  std::vector<std::uint64_t> fullCells;  ///< Cells inside all over, a bit each.
  std::vector<std::uint32_t> label;      ///< As in DepthBricks; bytes count from 0 in this block.
  std::vector<std::uint8_t> labelBytes;

  std::vector<LatticeBound> lattice;  ///< 64 where `near`, else one for the block.
};

}  // namespace palpate
