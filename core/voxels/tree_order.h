#pragma once
/// The arrays of an edited tree put in order, and labels made separate: what takes memory. Internal
/// to TreeEditor.

#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// Nodes breadth-first, bytes and slots in the order of what links to them, nothing else.
template <int Bits>
void putInOrder(VoxelTree::Data& data);

/// Gives each voxel of a tree with voxel leaves a label of its own, all the one label.
template <int Bits>
void labelLeaves(VoxelTree::Data& data);

}  // namespace palpate
