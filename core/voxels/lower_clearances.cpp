#include "core/voxels/lower_clearances.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/voxels/clearance_edit.h"
#include "core/voxels/clearance_word.h"
#include "core/voxels/distance_window.h"

namespace palpate {

// Values fall at most a cell's diagonal from an added voxel where a cell may be in the region
// afterwards that was not before: deeper inside, cells are in it all over.
void lowerClearances(DepthBricks& bricks, const VoxelBox& added) noexcept {
  const DepthPalette& palette = bricks.palette;
  const Extent3 reach = DistanceWindow::reachOf(palette, DistanceWindow::Band::Outside);
  std::array<float, 3> edge;
  SpaceBox region;
  float around = 0;  // what the slopes may add, by cells
  for (std::size_t a = 0; a < 3; ++a) {
    edge[a] = std::sqrt(palette.weight()[a]);
    const std::int32_t steps = reach[a] + 1;
    region.lo[a] = edge[a] * static_cast<float>(added.lo[a] - steps);
    region.hi[a] = edge[a] * static_cast<float>(added.hi[a] - 1 + steps);
    around += edge[a];
  }
  const auto blockBox = [&edge](const Extent3& block, std::int32_t cells) {
    SpaceBox b;
    for (std::size_t a = 0; a < 3; ++a) {
      b.lo[a] = edge[a] * static_cast<float>(block[a] * cells);
      b.hi[a] = b.lo[a] + edge[a] * static_cast<float>(cells);
    }
    return b;
  };
  constexpr float kMost = ClearanceWord::kBoundBias;
  const float coarseReach = kMost / ClearanceWord::kCoarseSteps + 16.0f * around;
  const float blockReach = kMost / ClearanceWord::kBlockSteps + 4.0f * around;
  const float brickReach = kMost / ClearanceWord::kBrickSteps + 4.0f * around;
  Extent3 at;
  for (at[2] = 0; at[2] < bricks.blocks[2]; ++at[2]) {
    for (at[1] = 0; at[1] < bricks.blocks[1]; ++at[1]) {
      for (at[0] = 0; at[0] < bricks.blocks[0]; ++at[0]) {
        std::uint32_t& coarse = bricks.coarse[bricks.blockAt(at[0], at[1], at[2])];
        const SpaceBox block = blockBox(at, DepthBricks::kCoarseEdge);
        const float gap = gapBetween(block, region);
        if ((coarse & ClearanceWord::kLink) == 0) {
          if (gap > coarseReach) continue;
          coarse = loweredClearance(coarse, ClearanceWord::kCoarseSteps, block, region);
          continue;
        }
        if (gap > blockReach) continue;
        const std::size_t first = std::size_t{coarse & ~ClearanceWord::kLink} * 64;
        for (std::int32_t child = 0; child < 64; ++child) {
          std::uint32_t& word = bricks.words[first + static_cast<std::size_t>(child)];
          const SpaceBox small = blockBox(
              {at[0] * 4 + (child & 3), at[1] * 4 + (child >> 2 & 3), at[2] * 4 + (child >> 4)},
              DepthBricks::kEdge);
          if ((word & ClearanceWord::kLink) == 0) {
            word = loweredClearance(word, ClearanceWord::kBlockSteps, small, region);
          } else if (gap <= brickReach) {
            std::uint32_t& own = bricks.slots[DepthBricks::placeOf(word) + DepthBricks::kRows];
            own = loweredClearance(own, ClearanceWord::kBrickSteps, small, region);
          }
        }
      }
    }
  }
}

}  // namespace palpate
