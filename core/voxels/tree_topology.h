#pragma once
/// From a dense occupancy of items to the levels of the N-tree.

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/voxels/voxel_bits.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

struct TreeTopology {
  int levels = 0;
  std::vector<TreeLevel> level;  ///< [1] .. [levels].
  /// Address of every node of a level, in nodes of that level; same order as the masks.
  std::vector<std::vector<std::array<std::int32_t, 3>>> address;
  std::size_t leaves = 0;
};

/// @param occupied  at least one item is set.
/// Refuses more than 2^32 − 2 nodes or leaves in a level.
[[nodiscard]] Result<TreeTopology> buildTopology(int bits, const VoxelBits& occupied);

/// The same from one byte an item, x fastest.
[[nodiscard]] Result<TreeTopology> buildTopology(int bits,
                                                 const std::array<std::int32_t, 3>& extent,
                                                 const std::vector<std::uint8_t>& occupied);

}  // namespace palpate
