#pragma once
/// The contact query of distance leaves with many points at a time. Internal to ContactFinder.
///
/// The shell's spheres are tested against clearances sixteen at a time, level by level; the points
/// of the leaves that are left against the bricks. Bits are the same at every vector width: the
/// operations are those of single lanes in one order, without fused multiply-add. They are the same
/// at every number of threads too: each thread has a run of the leaves and writes where that run's
/// contacts may go, and the runs are then moved together in the order of the leaves.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/collision/cell_pose.h"
#include "core/collision/packed_contacts.h"
#include "core/collision/query_workers.h"
#include "core/collision/shell_blocks.h"
#include "core/voxels/depth_bricks.h"

namespace palpate {

/// The weight along x is a whole number of these, so that products with depths in steps are exact.
inline constexpr std::int32_t kFractionOne = 16384;

/// Metres in one step of depth times one weight. @param unit  the smallest spacing, metres.
[[nodiscard]] inline float metresPerStepOf(const DepthPalette& palette, double unit) noexcept {
  return static_cast<float>(unit / (static_cast<double>(palette.stepsPerUnit()) * kFractionOne));
}

/// From how many live leaves on the other threads help: where they are awake, and where they must
/// be woken. Measured with two threads on a virtual machine: a leaf takes 28 ns; a round of awake
/// threads costs 0.4 to 1 µs, and as much to bring the contacts together as a third of what it
/// saves; one that wakes them 11 µs, and they come 20 to 40 µs late.
inline constexpr std::size_t kLeavesToShare = 512;
inline constexpr std::size_t kLeavesToWake = 3072;

/// The nodes above the leaves that were live with radii grown by a margin: for as long as the shell
/// has moved by less, no other can hold a contact.
struct NearbyNodes {
  /// Smallest spacings. More lasts for more steps and lets more nodes in at each of them.
  static constexpr float kMargin = 1.0f;

  bool wanted = false;  ///< QueryOptions::coherence.
  bool known = false;
  CellPose at;  ///< Where `node` was found.
  std::size_t count = 0;
  std::vector<std::uint32_t> node;

  /// May `node` be used at this pose? @param edge  of a cell along each axis, smallest spacings.
  [[nodiscard]] bool hold(const CellPose& pose, const float edge[3], double reach) const noexcept;
};

struct FastWork {
  const DepthBricks* bricks = nullptr;
  const ShellBlocks* shell = nullptr;
  std::array<float, 3> lastCell{};            ///< Highest cell along each axis.
  float depthLimit = 0;                       ///< Saturated depths are this, metres.
  float metresPerStep = 0;                    ///< Of a value in the bricks' steps and the weights'.
  std::vector<std::uint32_t> frontier, next;  ///< Nodes of one level.
  std::uint32_t tests = 0;
  bool wideBefore = false;  ///< The last step ended among wide bricks: a guess for this one.
  QueryWorkers* workers = nullptr;  ///< None: one thread.
  NearbyNodes nearby;

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
