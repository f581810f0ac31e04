#pragma once
/// The contact query of distance leaves with many points at a time. Internal to ContactFinder.
///
/// The shell's spheres are tested against clearances sixteen at a time, level by level; the points
/// of the leaves that are left against the bricks. Bits are the same at every vector width: the
/// operations are those of single lanes in one order, without fused multiply-add.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/collision/cell_pose.h"
#include "core/collision/packed_contacts.h"
#include "core/collision/shell_blocks.h"
#include "core/voxels/depth_bricks.h"

namespace palpate {

/// The weight along x is a whole number of these, so that products with depths in steps are exact.
inline constexpr std::int32_t kFractionOne = 16384;

/// Metres in one step of depth times one weight. @param unit  the smallest spacing, metres.
[[nodiscard]] inline float metresPerStepOf(const DepthPalette& palette, double unit) noexcept {
  return static_cast<float>(unit / (static_cast<double>(palette.stepsPerUnit()) * kFractionOne));
}

struct FastWork {
  const DepthBricks* bricks = nullptr;
  const ShellBlocks* shell = nullptr;
  std::array<float, 3> lastCell{};            ///< Highest cell along each axis.
  float depthLimit = 0;                       ///< Saturated depths are this, metres.
  float metresPerStep = 0;                    ///< Of a value in the bricks' steps and the weights'.
  std::vector<std::uint32_t> frontier, next;  ///< Nodes of one level.
  std::uint32_t tests = 0;

  /// Both must outlive this. Allocates; the queries do not.
  void prepare(const DepthBricks& depth, const std::array<std::int32_t, 3>& cells,
               const ShellBlocks& blocks, double unit);
};

/// All contacts, by rank. `everyPoint`: without the shell's spheres, which changes nothing but the
/// time.
void findFast(FastWork& work, const CellPose& pose, bool everyPoint, PackedContacts& out) noexcept;

/// The name of the vector instructions in use.
[[nodiscard]] const char* fastQueryTarget() noexcept;

}  // namespace palpate
