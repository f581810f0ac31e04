#include "core/voxels/voxel_leaf_edit.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "core/voxels/edited_nodes.h"
#include "core/voxels/tree_order.h"

namespace palpate {
namespace {

using Band = DistanceWindow::Band;

// The code of an added voxel until its depth is found: none inside has this.
constexpr std::uint16_t kNoDepth = DepthPalette::kFarCode;

}  // namespace

template <int Bits>
VoxelLeafEdit<Bits>::VoxelLeafEdit(VoxelTree::Data& data, EditedVoxels& voxels)
    : data_(data),
      palette_(data.depth.palette),
      voxels_(voxels),
      dims_(voxels.dims()),
      reach_(DistanceWindow::reachOf(palette_, Band::Both)),
      groups_(data),
      leaves_(data.leafBytes, data.depth.uniformLabel == 0),
      window_(palette_, dims_, EditedVoxels::tileWith(reach_, Mask::kEdge), Band::Both) {
  fillTables();
  readVoxels(voxels);
}

template <int Bits>
void VoxelLeafEdit<Bits>::fillTables() {
  if (palette_.weight() == std::array<float, 3>{1, 1, 1}) {
    const auto squares = static_cast<std::size_t>(palette_.deepSquare()) + 2;  // to the cap
    for (std::size_t n = 0; n < squares; ++n) {
      codeOfSquare_.push_back(palette_.codeOf(-static_cast<float>(n)));
    }
  }
  std::size_t nodes = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t voxels = std::min(EditedVoxels::kTile + 2 * reach_[a], dims_[a]);
    nodes *= static_cast<std::size_t>((voxels + Mask::kEdge - 2) / Mask::kEdge + 1);
  }
  found_.reserve(nodes);
}

template <int Bits>
void VoxelLeafEdit<Bits>::readVoxels(EditedVoxels& voxels) const {
  const Address all{dims_[0] >> Bits, dims_[1] >> Bits, dims_[2] >> Bits};
  groups_.visit({0, 0, 0}, all, [&](const Address& at, std::uint32_t node) {
    forEachChild(Mask::load(data_.level[1].masks.data(), node), [&](int c) {
      voxels.include(at[0] * Mask::kEdge + (c & Mask::kLow),
                     at[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                     at[2] * Mask::kEdge + (c >> (2 * Bits)));
    });
  });
}

// ---- masks and links ----

// Codes of new voxels are to come.
template <int Bits>
void VoxelLeafEdit<Bits>::editNodes(const VoxelBox& box, std::uint8_t label) {
  TreeLevel& level = data_.level[1];
  Address at;
  for (at[2] = box.lo[2] >> Bits; at[2] <= (box.hi[2] - 1) >> Bits; ++at[2]) {
    for (at[1] = box.lo[1] >> Bits; at[1] <= (box.hi[1] - 1) >> Bits; ++at[1]) {
      for (at[0] = box.lo[0] >> Bits; at[0] <= (box.hi[0] - 1) >> Bits; ++at[0]) {
        const Mask mask = voxelMask<Bits>(voxels_.solid(), at);
        std::uint32_t node = groups_.find(at);
        const Mask old = node == kNoNode ? Mask{} : Mask::load(level.masks.data(), node);
        if (mask.word == old.word) continue;
        const int before = old.count();
        std::uint32_t link = 0;
        if (before > 0) {
          link = level.firstChild[node];
          leaves_.read(old, link, node_);
        }
        if (mask.empty()) {
          leaves_.drop(link);
          mask.store(level.masks.data(), node);
          level.firstChild[node] = 0;
          groups_.remove(at);
          continue;
        }
        forEachChild(mask, [&](int c) {
          if (old.test(c)) return;
          node_.code[static_cast<std::size_t>(c)] = kNoDepth;
          node_.label[static_cast<std::size_t>(c)] = label;
        });
        if (node == kNoNode) node = groups_.insert(at);
        mask.store(level.masks.data(), node);
        level.firstChild[node] = leaves_.write(mask, link, before, node_);
      }
    }
  }
}

// ---- depths ----

template <int Bits>
void VoxelLeafEdit<Bits>::editDepths(const VoxelBox& box, std::uint8_t label) {
  label != 0 ? fill(box) : carve(box);
}

// The nodes of level 1 that may have a depth that a change in the box makes other, and the box
// around them: a depth is other only where it was no less than the distance to the change.
template <int Bits>
VoxelBox VoxelLeafEdit<Bits>::findNodes(const VoxelBox& box) {
  const VoxelBox band = box.grown(reach_, dims_);
  const Address lo{band.lo[0] >> Bits, band.lo[1] >> Bits, band.lo[2] >> Bits};
  const Address hi{(band.hi[0] - 1) >> Bits, (band.hi[1] - 1) >> Bits, (band.hi[2] - 1) >> Bits};
  const std::array<float, 3>& weight = palette_.weight();
  // Where all narrow codes are outside, narrow nodes only hold voxels without a depth yet.
  const auto lastNarrow =
      std::min<std::uint16_t>(DepthPalette::kNarrow - 1, palette_.deepestCode());
  const float narrow = std::max(0.0f, -palette_.square(lastNarrow));
  VoxelBox all{dims_, {0, 0, 0}};
  found_.clear();
  groups_.visit(lo, hi, [&](const Address& at, std::uint32_t node) {
    float gap = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::int32_t below = box.lo[a] - (at[a] * Mask::kEdge + Mask::kEdge - 1);
      const std::int32_t above = at[a] * Mask::kEdge - (box.hi[a] - 1);
      const auto d = static_cast<float>(std::max({0, below, above}));
      gap += weight[a] * (d * d);
    }
    const bool wide = (data_.level[1].firstChild[node] & kWideLeaves) != 0;
    if (gap > (wide ? palette_.deepSquare() : narrow)) return;
    found_.push_back({at, node});
    for (std::size_t a = 0; a < 3; ++a) {
      all.lo[a] = std::min(all.lo[a], at[a] * Mask::kEdge);
      all.hi[a] = std::max(all.hi[a], (at[a] + 1) * Mask::kEdge);
    }
  });
  return all.grown({0, 0, 0}, dims_);
}

// The window's squares of a node's voxels by rank; `beyond` where the window does not reach.
template <int Bits>
void VoxelLeafEdit<Bits>::readSquares(const Address& at, const Mask& mask, float beyond) noexcept {
  const VoxelBox& box = window_.box();
  const std::int32_t x = at[0] * Mask::kEdge;
  const bool within = x >= box.lo[0] && x + Mask::kEdge <= box.hi[0];
  std::size_t rank = 0;
  for (int row = 0; row < Mask::kEdge * Mask::kEdge; ++row) {
    const int c = row * Mask::kEdge;
    auto bits =
        static_cast<std::uint32_t>(mask.word[static_cast<std::size_t>(c) >> 6] >> (c & 63)) &
        ((1U << Mask::kEdge) - 1U);
    if (bits == 0) continue;
    const std::int32_t j = at[1] * Mask::kEdge + (row & Mask::kLow);
    const std::int32_t k = at[2] * Mask::kEdge + (row >> Bits);
    if (within && box.contains(box.lo[0], j, k) && bits == (1U << Mask::kEdge) - 1U) {
      std::memcpy(&square_[rank], window_.row(j, k) + (x - box.lo[0]), Mask::kEdge * sizeof(float));
      rank += Mask::kEdge;
      continue;
    }
    for (; bits != 0; bits &= bits - 1) {
      const std::int32_t i = x + std::countr_zero(bits);
      square_[rank++] = box.contains(i, j, k) ? window_.at(i, j, k) : beyond;
    }
  }
}

// Codes of the depths with these squares; the far end of the window's stands for all beyond.
template <int Bits>
void VoxelLeafEdit<Bits>::codeSquares(std::size_t count) noexcept {
  if (codeOfSquare_.empty()) {
    for (std::size_t r = 0; r < count; ++r) codeOf_[r] = palette_.codeOf(-square_[r]);
    return;
  }
  for (std::size_t r = 0; r < count; ++r) {
    codeOf_[r] = codeOfSquare_[static_cast<std::size_t>(static_cast<std::int32_t>(square_[r]))];
  }
}

template <int Bits>
void VoxelLeafEdit<Bits>::writeNode(const FoundNode& found, const Mask& mask, std::size_t count) {
  std::uint32_t& link = data_.level[1].firstChild[found.node];
  const auto voxels = static_cast<int>(count);
  std::fill_n(&ranks_[count], 3, std::uint16_t{0});
  if (leaves_.writeCodes(link, voxels, ranks_.data())) return;
  leaves_.read(mask, link, node_);  // for its labels
  std::size_t rank = 0;
  forEachChild(mask, [&](int c) { node_.code[static_cast<std::size_t>(c)] = ranks_[rank++]; });
  link = leaves_.write(mask, link, voxels, node_);
}

// Depths are at most the distance to what was removed.
template <int Bits>
void VoxelLeafEdit<Bits>::carve(const VoxelBox& box) {
  const VoxelBox around = findNodes(box);
  if (found_.empty()) return;
  window_.measureTo(voxels_.changed(), box, around);
  for (const FoundNode& found : found_) {
    const Mask mask = Mask::load(data_.level[1].masks.data(), found.node);
    const auto count = static_cast<std::size_t>(mask.count());
    readSquares(found.at, mask, palette_.deepSquare());
    codeSquares(count);
    readCodes(found.node, count);
    std::uint16_t other = 0;
    for (std::size_t r = 0; r < count; ++r) {
      const std::uint16_t code = std::min(ranks_[r], codeOf_[r]);
      other = static_cast<std::uint16_t>(other | (code ^ ranks_[r]));
      ranks_[r] = code;
    }
    if (other != 0) writeNode(found, mask, count);
  }
}

// Nodes with depths that were the distance to what was added, or with what was added, are measured
// anew.
template <int Bits>
void VoxelLeafEdit<Bits>::fill(const VoxelBox& box) {
  const VoxelBox around = findNodes(box);
  window_.measureTo(voxels_.changed(), box, around);
  VoxelBox again{dims_, {0, 0, 0}};
  std::size_t kept = 0;
  for (const FoundNode& found : found_) {
    const Mask mask = Mask::load(data_.level[1].masks.data(), found.node);
    const auto count = static_cast<std::size_t>(mask.count());
    readSquares(found.at, mask, palette_.deepSquare());
    codeSquares(count);
    readCodes(found.node, count);
    // The deepest stay so.
    const std::uint16_t deepest = palette_.deepestCode();
    unsigned some = 0;
    for (std::size_t r = 0; r < count; ++r) {
      const auto same = static_cast<unsigned>(codeOf_[r] == ranks_[r]);
      some |= (same & static_cast<unsigned>(ranks_[r] != deepest)) |
              static_cast<unsigned>(ranks_[r] == kNoDepth);
    }
    if (some == 0) continue;
    found_[kept++] = found;
    again.include({found.at[0] << Bits, found.at[1] << Bits, found.at[2] << Bits});
    again.include({(found.at[0] << Bits) + Mask::kEdge - 1, (found.at[1] << Bits) + Mask::kEdge - 1,
                   (found.at[2] << Bits) + Mask::kEdge - 1});
  }
  found_.resize(kept);
  if (kept == 0) return;
  window_.measure(voxels_.solid(), again.grown({0, 0, 0}, dims_), Band::Both);
  for (const FoundNode& found : found_) {
    const Mask mask = Mask::load(data_.level[1].masks.data(), found.node);
    const auto count = static_cast<std::size_t>(mask.count());
    readSquares(found.at, mask, 0.0f);  // all are in the window
    for (std::size_t r = 0; r < count; ++r) square_[r] = -square_[r];
    codeSquares(count);
    readCodes(found.node, count);
    std::uint16_t other = 0;
    for (std::size_t r = 0; r < count; ++r) {
      other = static_cast<std::uint16_t>(other | (codeOf_[r] ^ ranks_[r]));
      ranks_[r] = codeOf_[r];
    }
    if (other != 0) writeNode(found, mask, count);
  }
}

// ---- memory ----

template <int Bits>
bool VoxelLeafEdit<Bits>::grew() noexcept {
  return groups_.grew() | leaves_.grew();  // both forget
}

template <int Bits>
void VoxelLeafEdit<Bits>::reserve(const VoxelBox& box) {
  const VoxelBox band = box.grown(reach_, dims_).grown({1, 1, 1}, dims_);
  reserveGroups(groups_, data_.levels, box.grown({1, 1, 1}, dims_));
  leaves_.reserve(boxesIn(band, Bits));
}

template <int Bits>
void VoxelLeafEdit<Bits>::separateLabels() {
  labelLeaves<Bits>(data_);
  leaves_.restart(true);
}

template <int Bits>
void VoxelLeafEdit<Bits>::compact() {
  putInOrder<Bits>(data_);
  groups_.restart();
  leaves_.restart(data_.depth.uniformLabel == 0);
}

template class VoxelLeafEdit<1>;
template class VoxelLeafEdit<2>;
template class VoxelLeafEdit<3>;

}  // namespace palpate
