#pragma once
/// Clearances after voxels were added: all that space stores of its distance to the contact region
/// falls to what bounds the distance to the new region too. Internal to TreeEditor.
///
/// Looks at every block of 16³ cells of the grid, and at the blocks and bricks of those that are
/// near enough for a bound to change. Takes no memory.

#include "core/voxels/depth_bricks.h"
#include "core/voxels/voxel_box.h"

namespace palpate {

/// @param added  a box of voxels, of the label grid, around all that were added.
void lowerClearances(DepthBricks& bricks, const VoxelBox& added) noexcept;

}  // namespace palpate
