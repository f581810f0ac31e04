#pragma once
/// Free space inside the solid that nothing can get into: cavities without a way in, and which of
/// them may be filled without a contact from outside ever noticing.
///
/// Two free voxels are connected when they share a face, an edge or a corner (26 neighbours). That
/// is the safe choice: a point can slip from one to the other along an edge, for the trilinear
/// value between them may be zero there, and a component of what is not negative in a cell always
/// has a corner of its own (a trilinear function has no maximum inside). So no point gets from one
/// component to another, in either leaf model, without being in contact on its way. With six
/// neighbours there would be more cavities, and some with a way in. What lies outside the grid is
/// free, and so is every free voxel at its border.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/voxels/voxel_box.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

struct SealedCavity {
  std::size_t voxels = 0;
  VoxelBox box;
  std::uint8_t wall = 0;  ///< The label before its first voxel.
};

/// Voxels of a cavity along x.
struct CavityRun {
  std::size_t first = 0;  ///< Linear index in the grid.
  std::uint32_t count = 0;
  std::uint32_t cavity = 0;
};

struct SealedCavities {
  std::vector<SealedCavity> cavity;  ///< In the order of their first voxels.
  std::vector<CavityRun> runs;       ///< Of all, by ascending index.
};

/// Which label values are solid; 0 never is.
using SolidLabels = std::array<bool, 256>;

[[nodiscard]] SealedCavities findSealedCavities(const LabelGrid& grid, const SolidLabels& solid);

/// How deep below the surface that can be reached contacts stay the same, in smallest spacings:
/// a tool deeper than this is past the middle of a sheet of one voxel, and the steps of a
/// simulation are short enough that it does not get there (simulation.h).
inline constexpr double kReachedDepth = 0.5;

/// Of the cavities wanted, those that can be filled with their wall so that every contact less deep
/// than kReachedDepth below the rest of the surface keeps depth, normal and label, bit for bit: of
/// no voxel that such a contact reads does the nearest free voxel lie in such a cavity. Walls thin
/// enough for that (voxel leaves read farther than distance leaves) keep the cavities behind them.
/// Parallel inside; the same result at any number of threads.
[[nodiscard]] std::vector<bool> fillableCavities(const LabelGrid& grid, const SolidLabels& solid,
                                                 const SealedCavities& cavities,
                                                 std::vector<bool> wanted, LeafModel leaf);

}  // namespace palpate
