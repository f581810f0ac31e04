/// An edit in stages: which voxels change; masks and links, one box of changes at a time; then
/// depths, one box at a time, in the band around it; counts. What the leaves are is for LeafEdit.

#include "core/voxels/tree_editor.h"

#include <utility>

#include "core/voxels/distance_leaf_edit.h"
#include "core/voxels/edited_voxels.h"
#include "core/voxels/leaf_edit.h"
#include "core/voxels/voxel_leaf_edit.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

constexpr std::size_t kMostSlots = DepthBricks::kPlaceMask / (DepthBricks::kSlotWords / 2);

template <int Bits>
std::unique_ptr<LeafEdit> leafEditOf(VoxelTree::Data& data, EditedVoxels& voxels) {
  if (data.options.leaf == LeafModel::Distance) {
    return std::make_unique<DistanceLeafEdit<Bits>>(data, voxels);
  }
  return std::make_unique<VoxelLeafEdit<Bits>>(data, voxels);
}

std::unique_ptr<LeafEdit> leafEditFor(VoxelTree::Data& data, EditedVoxels& voxels) {
  if (data.bits == 1) return leafEditOf<1>(data, voxels);
  if (data.bits == 2) return leafEditOf<2>(data, voxels);
  return leafEditOf<3>(data, voxels);
}

// Could the tree, with all its voxels inside, need more places than can be linked?
bool mayOutgrowLinks(const VoxelTree::Data& data) {
  std::size_t nodes = 1;  // of level 1
  std::size_t bricks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    nodes *= static_cast<std::size_t>((data.extent[a] >> data.bits) + 1);
    bricks *= static_cast<std::size_t>((data.extent[a] >> 2) + 1);
  }
  if (data.options.leaf == LeafModel::Distance) {
    return data.depth.slots.size() / DepthBricks::kSlotWords + 2 * bricks >= kMostSlots;
  }
  const std::size_t most = leafBytesOf(std::size_t{1} << (3 * data.bits), true, true, false);
  return data.leafBytes.size() + nodes * most >= kWideLeaves;
}

}  // namespace

class TreeEditor::Work {
 public:
  explicit Work(VoxelTree::Data& data)
      : data_(data), voxels_(data.geometry.dims), leaves_(leafEditFor(data, voxels_)) {}
  Work(const Work&) = delete;  // leaves_ refers to voxels_
  Work& operator=(const Work&) = delete;

  /// Label 0 removes.
  EditResult edit(std::span<const Voxel> voxels, std::uint8_t label);
  void reserve(const VoxelBox& box) {
    if (!box.empty()) leaves_->reserve(box);
  }
  void separateLabels();
  void compact();

 private:
  VoxelTree::Data& data_;
  EditedVoxels voxels_;
  std::unique_ptr<LeafEdit> leaves_;
};

EditResult TreeEditor::Work::edit(std::span<const Voxel> voxels, std::uint8_t label) {
  EditResult result;
  for (const Voxel& v : voxels) {
    if (data_.geometry.contains(v[0], v[1], v[2])) continue;
    result.status = EditStatus::OutsideGrid;
    return result;
  }
  const bool possible = voxels_.mark(voxels, label != 0, data_.stats.solidVoxels);
  const std::size_t count = voxels_.count();
  if (possible && count > 0) {
    if (label != 0 && data_.depth.uniformLabel != 0 && data_.depth.uniformLabel != label) {
      separateLabels();
      result.tookMemory = true;
    }
    voxels_.forEachTile([&](const VoxelBox& box) { leaves_->editNodes(box, label); });
    voxels_.forEachTile([&](const VoxelBox& box) { leaves_->editDepths(box, label); });
    data_.stats.surfaceVoxels += static_cast<std::size_t>(voxels_.surfaceChange());
    data_.stats.solidVoxels += label != 0 ? count : std::size_t{0} - count;
    ++data_.edits;
    countBytes(data_);
    const bool grew = leaves_->grew();
    result.tookMemory = result.tookMemory || grew;
  }
  voxels_.forget();
  if (!possible) {
    result.status = EditStatus::WouldBeEmpty;
    return result;
  }
  result.changed = count;
  result.ignored = voxels.size() - count;
  return result;
}

void TreeEditor::Work::separateLabels() {
  if (data_.depth.uniformLabel == 0) return;
  leaves_->separateLabels();
  countBytes(data_);
}

void TreeEditor::Work::compact() {
  leaves_->compact();
  countBytes(data_);
}

// ---- the face ----

Result<TreeEditor> TreeEditor::create(VoxelTree& tree) {
  VoxelTree::Data& data = *tree.data_;
  if (data.options.surfaceOnly) {
    return fail(inputRefused("A tree of surface voxels only cannot be edited.")
                    .inField("surfaceOnly")
                    .advise("Build the tree from all voxels."));
  }
  if (mayOutgrowLinks(data)) {
    return fail(inputRefused("The tree is too large to be edited in place.")
                    .advise("Crop or resample the volume."));
  }
  return TreeEditor(std::make_unique<Work>(data));
}

TreeEditor::TreeEditor(std::unique_ptr<Work> work) noexcept : work_(std::move(work)) {}
TreeEditor::TreeEditor(TreeEditor&&) noexcept = default;
TreeEditor& TreeEditor::operator=(TreeEditor&&) noexcept = default;
TreeEditor::~TreeEditor() = default;

EditResult TreeEditor::remove(std::span<const Voxel> voxels) {
  return work_->edit(voxels, 0);
}

EditResult TreeEditor::add(std::span<const Voxel> voxels, std::uint8_t label) {
  if (label == 0) return {EditStatus::NoLabel, 0, 0, false};
  return work_->edit(voxels, label);
}

void TreeEditor::reserve(const Voxel& lo, const Voxel& hi) {
  work_->reserve({lo, hi});
}

void TreeEditor::separateLabels() {
  work_->separateLabels();
}

void TreeEditor::compact() {
  work_->compact();
}

}  // namespace palpate
