#include "core/voxels/distance_leaf_edit.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/voxels/edited_nodes.h"
#include "core/voxels/tree_order.h"

namespace palpate {

template <int Bits>
DistanceLeafEdit<Bits>::DistanceLeafEdit(VoxelTree::Data& data, EditedVoxels& voxels)
    : data_(data), voxels_(voxels), groups_(data), bricks_(data.depth, data.extent, voxels) {}

template <int Bits>
void DistanceLeafEdit<Bits>::editNodes(const VoxelBox& box, std::uint8_t /*label*/) {
  TreeLevel& level = data_.level[1];
  std::array<std::int32_t, 3> lo;
  std::array<std::int32_t, 3> hi;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = std::max(box.lo[a] - 1, 0) >> Bits;
    hi[a] = std::min(box.hi[a] - 1, data_.extent[a] - 1) >> Bits;
  }
  std::array<std::int32_t, 3> at;
  for (at[2] = lo[2]; at[2] <= hi[2]; ++at[2]) {
    for (at[1] = lo[1]; at[1] <= hi[1]; ++at[1]) {
      for (at[0] = lo[0]; at[0] <= hi[0]; ++at[0]) {
        const NodeMask<Bits> mask = cellMask<Bits>(voxels_.solid(), data_.extent, at);
        std::uint32_t node = groups_.find(at);
        if (node == kNoNode) {
          if (mask.empty()) continue;
          node = groups_.insert(at);
        }
        mask.store(level.masks.data(), node);
        if (mask.empty()) groups_.remove(at);
      }
    }
  }
}

template <int Bits>
void DistanceLeafEdit<Bits>::editDepths(const VoxelBox& box, std::uint8_t label) {
  bricks_.edit(box, label);
}

template <int Bits>
bool DistanceLeafEdit<Bits>::grew() noexcept {
  return groups_.grew() | bricks_.grew();  // both forget
}

template <int Bits>
void DistanceLeafEdit<Bits>::reserve(const VoxelBox& box) {
  reserveGroups(groups_, data_.levels, box.grown({1, 1, 1}, voxels_.dims()));
  bricks_.reserve(box);
}

template <int Bits>
void DistanceLeafEdit<Bits>::separateLabels() {
  bricks_.separateLabels();
}

template <int Bits>
void DistanceLeafEdit<Bits>::compact() {
  putInOrder<Bits>(data_);
  groups_.restart();
  bricks_.restart();
}

template class DistanceLeafEdit<1>;
template class DistanceLeafEdit<2>;
template class DistanceLeafEdit<3>;

}  // namespace palpate
