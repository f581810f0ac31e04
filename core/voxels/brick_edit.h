#pragma once
/// The edit of the bricks of distance leaves: depths, labels and clearances, block by block of 4³
/// cells (depth_bricks.h). Internal to TreeEditor.
///
///  - Where voxels went, a depth inside is the least of what it was and the distance to these, and
///    values outside are measured near them; a brick without a voxel inside goes.
///  - Where voxels came, bricks in the band around them are measured whole, and clearances fall.
/// Bricks deeper than saturation are shared as built; one that gets a depth above that is given
/// codes of its own.
///
/// Lengths: steps of the grid; squares in smallest spacings, as the palette's. What an edit needs
/// is taken when this is made: windows of distances. The bricks' arrays may grow past what was
/// reserved: grew(). One thread, that of the editor.

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/voxels/brick_store.h"
#include "core/voxels/distance_window.h"
#include "core/voxels/edited_voxels.h"

namespace palpate {

class BrickEdit {
 public:
  /// @param extent  cells of the tree along x, y, z. `bricks` and `voxels`, which gets the voxels
  /// inside, must outlive this.
  BrickEdit(DepthBricks& bricks, const Extent3& extent, EditedVoxels& voxels);

  /// In and around a box of changes. Label 0 removes.
  void edit(const VoxelBox& box, std::uint8_t label);
  [[nodiscard]] bool grew() noexcept { return store_.grew(); }

  /// Takes the memory for all edits within the box, which is not empty.
  void reserve(const VoxelBox& box);
  /// Gives each brick a label of its own. Takes memory.
  void separateLabels() { store_.separateLabels(); }
  /// After the arrays were put in order.
  void restart() { store_.restart(); }

 private:
  using Address = std::array<std::int32_t, 3>;  // of a block

  void readVoxels(EditedVoxels& voxels);
  [[nodiscard]] bool hasVoxels(const Address& block) const noexcept;
  void carve(const Address& block, const VoxelBox& box);
  void fill(const Address& block);
  void measure(const Address& block);
  void editLabels(const Address& block, std::size_t word, std::uint8_t label);

  DepthBricks& bricks_;
  const DepthPalette& palette_;
  const EditedVoxels& voxels_;
  Extent3 dims_, extent_;          // voxels and cells along x, y, z
  Extent3 deepReach_, nearReach_;  // steps of a depth and of a distance outside
  BrickStore store_;
  DistanceWindow window_, near_, one_;  // of the band, of what is outside near, of a brick

  // Of the brick at work:
  BrickStore::Codes codes_;
  BrickStore::Labels labels_;
};

}  // namespace palpate
