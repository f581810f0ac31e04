#include "core/voxels/tree_order.h"

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/voxels/leaf_codes.h"
#include "core/voxels/node_mask.h"

namespace palpate {
namespace {

template <int Bits>
void orderNodes(VoxelTree::Data& data) {
  using Mask = NodeMask<Bits>;
  std::vector<std::uint32_t> nodes{0};  // of one level, in order
  for (auto l = static_cast<std::size_t>(data.levels); l >= 1; --l) {
    const TreeLevel& old = data.level[l];
    TreeLevel level;
    level.masks.resize(nodes.size() * Mask::kBytes);
    if (!old.firstChild.empty()) level.firstChild.resize(nodes.size());
    std::vector<std::uint32_t> below;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Mask mask = Mask::load(old.masks.data(), nodes[n]);
      mask.store(level.masks.data(), n);
      if (old.firstChild.empty()) continue;
      const std::uint32_t first = old.firstChild[nodes[n]];
      if (l == 1) {
        level.firstChild[n] = first;
        continue;
      }
      level.firstChild[n] = static_cast<std::uint32_t>(below.size());
      for (int c = 0; c < mask.count(); ++c) below.push_back(first + static_cast<std::uint32_t>(c));
    }
    data.level[l] = std::move(level);
    nodes = std::move(below);
  }
}

// `labelled`: the bytes have labels; `label`: not 0, they get this one.
template <int Bits>
void orderLeaves(VoxelTree::Data& data, bool labelled, std::uint8_t label) {
  using Mask = NodeMask<Bits>;
  TreeLevel& level = data.level[1];
  LargeArray<std::uint8_t> bytes;
  for (std::size_t n = 0; n < level.firstChild.size(); ++n) {
    const auto count = static_cast<std::size_t>(Mask::load(level.masks.data(), n).count());
    if (count == 0) continue;  // garbage
    const std::uint32_t link = level.firstChild[n];
    const auto place = static_cast<std::uint32_t>(bytes.size());
    const std::size_t size = leafBytesOf(count, (link & kWideLeaves) != 0, labelled, false);
    bytes.append(data.leafBytes.data() + (link & ~kWideLeaves), size);
    if (label != 0) {
      bytes.resize(bytes.size() + count);
      std::fill(bytes.end() - count, bytes.end(), label);
    }
    level.firstChild[n] = place | (link & kWideLeaves);
  }
  data.leafBytes = std::move(bytes);
}

void orderBricks(DepthBricks& d) {
  LargeArray<std::uint32_t> slots;
  LargeArray<std::uint8_t> labelBytes;
  slots.append(d.slots.data(), DepthBricks::kSlotWords);  // far outside everywhere
  std::unordered_map<std::size_t, std::uint32_t> shared;
  for (std::size_t w = 0; w < d.words.size(); ++w) {
    if ((d.words[w] & ClearanceWord::kLink) == 0) continue;
    const std::uint32_t link = d.words[w] & ~ClearanceWord::kLink;
    const bool wide = (link & DepthBricks::kWide) != 0;
    const std::size_t place = DepthBricks::placeOf(link);
    const auto append = [&] {
      const std::size_t slot = slots.size() / DepthBricks::kSlotWords;
      slots.append(&d.slots[place], (wide ? 2 : 1) * DepthBricks::kSlotWords);
      return DepthBricks::linkTo(slot, wide);
    };
    if (d.codeAt(link, 0, 0, 0) > d.palette.deepestCode()) {
      const auto [at, fresh] = shared.try_emplace(place, 0);
      if (fresh) at->second = append();
      d.words[w] = ClearanceWord::kLink | at->second;
    } else {
      d.words[w] = ClearanceWord::kLink | append();
    }
    if (d.uniformLabel != 0 || (d.label[w] & DepthBricks::kOneLabel) != 0) continue;
    const std::uint32_t entry = d.label[w];
    d.label[w] = static_cast<std::uint32_t>(labelBytes.size() / DepthBricks::kLabelBytes);
    labelBytes.append(&d.labelBytes[std::size_t{entry} * DepthBricks::kLabelBytes],
                      DepthBricks::kLabelBytes);
  }
  d.slots = std::move(slots);
  d.labelBytes = std::move(labelBytes);
  const auto tight = [](auto& array) { array = std::remove_reference_t<decltype(array)>(array); };
  tight(d.words);
  tight(d.label);
}

}  // namespace

template <int Bits>
void putInOrder(VoxelTree::Data& data) {
  orderNodes<Bits>(data);
  if (data.options.leaf == LeafModel::Voxel) {
    orderLeaves<Bits>(data, data.depth.uniformLabel == 0, 0);
  } else {
    orderBricks(data.depth);
  }
}

template <int Bits>
void labelLeaves(VoxelTree::Data& data) {
  orderLeaves<Bits>(data, false, data.depth.uniformLabel);
  data.depth.uniformLabel = 0;
}

template void putInOrder<1>(VoxelTree::Data&);
template void putInOrder<2>(VoxelTree::Data&);
template void putInOrder<3>(VoxelTree::Data&);
template void labelLeaves<1>(VoxelTree::Data&);
template void labelLeaves<2>(VoxelTree::Data&);
template void labelLeaves<3>(VoxelTree::Data&);

}  // namespace palpate
