#pragma once
/// What an edit of a tree asks of its leaves, voxels or distances. Internal to TreeEditor.
///
/// An edit (tree_editor.cpp) marks the changes in EditedVoxels; then, for one box of them after the
/// other, editNodes(); then, for one after the other again, editDepths(): depths reach over the
/// edges of boxes, so they are measured when all nodes are there. Boxes hold changes, and are at
/// most EditedVoxels::kTile³ voxels. Label 0 removes what changes, any other adds it.
///
/// Two leaf models: voxel_leaf_edit.h, distance_leaf_edit.h. Both read from the tree, when made,
/// which voxels are inside, and keep references to the tree's arrays and to the EditedVoxels. One
/// thread, that of the editor. Counts of bytes and of voxels are the editor's to keep.

#include <cstdint>

#include "core/voxels/voxel_box.h"

namespace palpate {

class LeafEdit {
 public:
  LeafEdit() = default;
  LeafEdit(const LeafEdit&) = delete;
  LeafEdit& operator=(const LeafEdit&) = delete;
  virtual ~LeafEdit() = default;

  /// Masks and links of the box, on all levels. Takes memory only past what was reserved: grew().
  virtual void editNodes(const VoxelBox& box, std::uint8_t label) = 0;
  /// Depths, labels and clearances, in the box and the band around it. Memory as above.
  virtual void editDepths(const VoxelBox& box, std::uint8_t label) = 0;
  /// Did one of these take memory since this was asked?
  [[nodiscard]] virtual bool grew() noexcept = 0;

  /// Takes the memory for all edits within the box, which is not empty.
  virtual void reserve(const VoxelBox& box) = 0;
  /// Gives each voxel a label of its own, in a tree that has but one. Takes memory.
  virtual void separateLabels() = 0;
  /// Puts the tree's arrays in order, without garbage. Takes memory.
  virtual void compact() = 0;
};

}  // namespace palpate
