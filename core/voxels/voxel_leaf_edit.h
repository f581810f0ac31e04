#pragma once
/// The edit of voxel leaves: a node of level 1 has a mask of voxels and links to their codes and
/// labels (leaf_codes.h). Internal to TreeEditor.
///
/// Depths are codes of the palette, so they are compared and replaced as codes, a node at a time:
///  - where voxels went, a depth is the least of what it was and the distance to these;
///  - where voxels came, depths can only grow that were the distance to these; nodes with such
///    depths, or with new voxels, are measured anew.
/// Both look only at nodes that are near enough for a depth of theirs to change: narrow ones
/// (codes of six bits) are left out from a few voxels on.
///
/// Lengths: steps of the grid; squares in smallest spacings, as the palette's. What an edit needs
/// is taken when this is made: a window of distances and a list of the nodes that may lie in it.
/// The tree's arrays may grow: see LeafEdit.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/voxels/distance_window.h"
#include "core/voxels/edited_voxels.h"
#include "core/voxels/leaf_edit.h"
#include "core/voxels/leaf_store.h"
#include "core/voxels/node_groups.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

template <int Bits>
class VoxelLeafEdit final : public LeafEdit {
 public:
  /// Both must outlive this; `voxels` gets those of the tree.
  VoxelLeafEdit(VoxelTree::Data& data, EditedVoxels& voxels);

  void editNodes(const VoxelBox& box, std::uint8_t label) override;
  void editDepths(const VoxelBox& box, std::uint8_t label) override;
  [[nodiscard]] bool grew() noexcept override;
  void reserve(const VoxelBox& box) override;
  void separateLabels() override;
  void compact() override;

 private:
  using Mask = NodeMask<Bits>;
  using Address = std::array<std::int32_t, 3>;
  struct FoundNode {
    Address at;
    std::uint32_t node;
  };

  void readVoxels(EditedVoxels& voxels) const;
  void fillTables();
  VoxelBox findNodes(const VoxelBox& box);
  void carve(const VoxelBox& box);
  void fill(const VoxelBox& box);
  void readCodes(std::uint32_t node, std::size_t count) noexcept {
    leaves_.readCodes(data_.level[1].firstChild[node], static_cast<int>(count), ranks_.data());
  }
  void readSquares(const Address& at, const Mask& mask, float beyond) noexcept;
  void codeSquares(std::size_t count) noexcept;
  void writeNode(const FoundNode& found, const Mask& mask, std::size_t count);

  VoxelTree::Data& data_;
  const DepthPalette& palette_;
  const EditedVoxels& voxels_;
  Extent3 dims_;
  Extent3 reach_;  // steps that a depth may depend on
  NodeGroups<Bits> groups_;
  LeafStore<Bits> leaves_;
  DistanceWindow window_;
  std::vector<std::uint16_t> codeOfSquare_;  // where squares are whole numbers

  // Of the box at work:
  std::vector<FoundNode> found_;  // as many as the window may hold
  // Of the node at work, by child, and by rank: codes, squares of the window, codes of these.
  typename LeafStore<Bits>::Node node_;
  std::array<std::uint16_t, LeafStore<Bits>::kRanks> ranks_;
  std::array<float, Mask::kChildren> square_;
  std::array<std::uint16_t, Mask::kChildren> codeOf_;
};

}  // namespace palpate
