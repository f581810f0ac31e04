#pragma once
/// The edit of distance leaves: a node of level 1 has a mask of cells and links to nothing; depths,
/// labels and clearances lie in bricks beside the tree (depth_bricks.h, brick_edit.h). Internal to
/// TreeEditor.

#include <cstdint>

#include "core/voxels/brick_edit.h"
#include "core/voxels/edited_voxels.h"
#include "core/voxels/leaf_edit.h"
#include "core/voxels/node_groups.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

template <int Bits>
class DistanceLeafEdit final : public LeafEdit {
 public:
  /// Both must outlive this; `voxels` gets those of the tree.
  DistanceLeafEdit(VoxelTree::Data& data, EditedVoxels& voxels);

  void editNodes(const VoxelBox& box, std::uint8_t label) override;
  void editDepths(const VoxelBox& box, std::uint8_t label) override;
  [[nodiscard]] bool grew() noexcept override;
  void reserve(const VoxelBox& box) override;
  void separateLabels() override;
  void compact() override;

 private:
  VoxelTree::Data& data_;
  const EditedVoxels& voxels_;
  NodeGroups<Bits> groups_;
  BrickEdit bricks_;
};

}  // namespace palpate
