/// An edit in stages: which voxels change; masks and links; then depths, one box of changes at a
/// time, in the band around it; bounds; counts.

#include "core/voxels/tree_editor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "core/voxels/brick_store.h"
#include "core/voxels/clearance_edit.h"
#include "core/voxels/distance_window.h"
#include "core/voxels/leaf_store.h"
#include "core/voxels/node_groups.h"
#include "core/voxels/tree_order.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

using Band = DistanceWindow::Band;

constexpr std::int32_t kTile = 32;  // edge of a box of changes that is done at a time
// The code of an added voxel until its depth is found: none inside has this.
constexpr std::uint16_t kNoDepth = DepthPalette::kFarCode;
constexpr std::size_t kMostSlots = DepthBricks::kPlaceMask / (DepthBricks::kSlotWords / 2);

Extent3 windowFor(const Extent3& reach, std::int32_t edge) {
  return {edge + 2 * reach[0], edge + 2 * reach[1], edge + 2 * reach[2]};
}

Error tooLarge() {
  return inputRefused("The tree is too large to be edited in place.")
      .advise("Crop or resample the volume.");
}

}  // namespace

class TreeEditor::Work {
 public:
  Work() = default;
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;
  virtual ~Work() = default;
  /// Label 0 removes.
  virtual EditResult edit(std::span<const Voxel> voxels, std::uint8_t label) = 0;
  virtual void reserve(const VoxelBox& box) = 0;
  virtual void separateLabels() = 0;
  virtual void compact() = 0;
};

template <int Bits>
class TreeEditor::WorkOf final : public TreeEditor::Work {
 public:
  using Mask = NodeMask<Bits>;
  using Address = std::array<std::int32_t, 3>;

  explicit WorkOf(VoxelTree::Data& data)
      : data_(data),
        palette_(data.depth.palette),
        dims_(data.geometry.dims),
        distance_(data.options.leaf == LeafModel::Distance),
        deepReach_(DistanceWindow::reachOf(palette_, Band::Both)),
        nearReach_(DistanceWindow::reachOf(palette_, Band::Outside)),
        solid_(dims_),
        changed_(dims_),
        groups_(data),
        leaves_(data.leafBytes, data.depth.uniformLabel == 0),
        bricks_(data.depth),
        window_(palette_, dims_,
                windowFor(deepReach_, kTile + 2 * std::max(DepthBricks::kEdge, Mask::kEdge)),
                Band::Both),
        near_(palette_, dims_, windowFor(nearReach_, kTile), Band::Outside),
        brick_(palette_, dims_, {5, 5, 5}, Band::Both) {
    fillTables();
    if (distance_) {
      readBricks();
    } else {
      readLeaves();
    }
  }

  EditResult edit(std::span<const Voxel> voxels, std::uint8_t label) override;
  void reserve(const VoxelBox& box) override;
  void separateLabels() override;
  void compact() override;

 private:
  void fillTables();
  void readLeaves();
  void readBricks();
  void codeSquares(std::size_t count) noexcept;
  void readCodes(std::uint32_t node, std::size_t count) noexcept {
    leaves_.readCodes(data_.level[1].firstChild[node], static_cast<int>(count), ranks_.data());
  }

  bool mark(std::span<const Voxel> voxels);
  void countSurface();
  template <class F>
  void forEachTile(F&& f);

  [[nodiscard]] Mask voxelMask(const Address& node) const noexcept;
  [[nodiscard]] Mask cellMask(const Address& node) const noexcept;
  void editLeafNodes(const VoxelBox& box);
  void editCellNodes(const VoxelBox& box);

  struct FoundNode {
    Address at;
    std::uint32_t node;
  };
  VoxelBox findNodes(const VoxelBox& box);
  void readSquares(const Address& at, const Mask& mask, float beyond);
  void writeNode(const FoundNode& found, const Mask& mask, std::size_t count);
  void carveLeaves(const VoxelBox& box);
  void fillLeaves(const VoxelBox& box);
  void editBrickDepths(const VoxelBox& box);
  [[nodiscard]] bool brickHasVoxels(const Address& block) const noexcept;
  template <class F>
  void forEachBlock(const VoxelBox& box, F&& f);
  void carveBrick(const Address& block, const VoxelBox& box);
  void fillBrick(const Address& block);
  void measureBrick(const Address& block, BrickStore::Codes& codes);
  void editLabels(const Address& block, std::size_t word);
  void lowerClearances(const VoxelBox& box);
  void fillStats();

  VoxelTree::Data& data_;
  const DepthPalette& palette_;
  Extent3 dims_;
  bool distance_;
  Extent3 deepReach_, nearReach_;  // steps of a depth and of a distance outside
  VoxelBits solid_, changed_;
  NodeGroups<Bits> groups_;
  LeafStore<Bits> leaves_;
  BrickStore bricks_;
  DistanceWindow window_, near_, brick_;

  // Of the edit at work:
  VoxelBox box_;
  std::size_t count_ = 0;
  std::uint8_t label_ = 0;
  typename LeafStore<Bits>::Node node_;
  std::vector<FoundNode> found_;                              // as many as a window may hold
  std::array<std::uint16_t, LeafStore<Bits>::kRanks> ranks_;  // codes of a node
  std::array<float, Mask::kChildren> square_;                 // beside them, of the window
  std::array<std::uint16_t, Mask::kChildren> codeOf_;         // of these
  BrickStore::Codes codes_;
  BrickStore::Labels labels_;

  // Codes by square where these are whole numbers.
  std::vector<std::uint16_t> codeOfSquare_;
};

template <int Bits>
void TreeEditor::WorkOf<Bits>::fillTables() {
  if (palette_.weight() == std::array<float, 3>{1, 1, 1}) {
    const auto squares = static_cast<std::size_t>(palette_.deepSquare()) + 2;  // to the cap
    for (std::size_t n = 0; n < squares; ++n) {
      codeOfSquare_.push_back(palette_.codeOf(-static_cast<float>(n)));
    }
  }
  if (distance_) return;
  std::size_t nodes = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t voxels = std::min(kTile + 2 * deepReach_[a], dims_[a]);
    nodes *= static_cast<std::size_t>((voxels + Mask::kEdge - 2) / Mask::kEdge + 1);
  }
  found_.reserve(nodes);
}

// ---- what the tree knows of its voxels ----

template <int Bits>
void TreeEditor::WorkOf<Bits>::readLeaves() {
  const Address all{dims_[0] >> Bits, dims_[1] >> Bits, dims_[2] >> Bits};
  groups_.visit({0, 0, 0}, all, [&](const Address& at, std::uint32_t node) {
    forEachChild(Mask::load(data_.level[1].masks.data(), node), [&](int c) {
      solid_.set(at[0] * Mask::kEdge + (c & Mask::kLow),
                 at[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                 at[2] * Mask::kEdge + (c >> (2 * Bits)));
    });
  });
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::readBricks() {
  forEachBlock({{0, 0, 0}, dims_}, [&](const Address& block) {
    const std::size_t word = bricks_.wordOf(block);
    if (!bricks_.linked(word)) return;
    bricks_.read(bricks_.linkAt(word), codes_);
    std::size_t at = 0;
    for (std::int32_t z = 0; z < 5; ++z) {
      for (std::int32_t y = 0; y < 5; ++y) {
        for (std::int32_t x = 0; x < 5; ++x, ++at) {
          if (palette_.value(codes_[at]) > 0.0f) continue;
          const Address v{block[0] * 4 + x, block[1] * 4 + y, block[2] * 4 + z};
          // Beyond the grid its edge goes on.
          if (v[0] < dims_[0] && v[1] < dims_[1] && v[2] < dims_[2]) solid_.set(v[0], v[1], v[2]);
        }
      }
    }
  });
}

// ---- which voxels change ----

// False where all voxels would go.
template <int Bits>
bool TreeEditor::WorkOf<Bits>::mark(std::span<const Voxel> voxels) {
  const bool adding = label_ != 0;
  box_ = {dims_, {0, 0, 0}};
  count_ = 0;
  for (const Voxel& v : voxels) {
    std::uint64_t& word = solid_.row(v[1], v[2])[v[0] >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (v[0] & 63);
    if (((word & bit) != 0) == adding) continue;
    word ^= bit;
    changed_.row(v[1], v[2])[v[0] >> 6] |= bit;
    box_.include(v);
    ++count_;
  }
  if (adding || count_ < data_.stats.solidVoxels) return true;
  for (std::int32_t k = box_.lo[2]; k < box_.hi[2]; ++k) {
    for (std::int32_t j = box_.lo[1]; j < box_.hi[1]; ++j) {
      for (std::size_t w = 0; w < solid_.rowWords; ++w)
        solid_.row(j, k)[w] |= changed_.row(j, k)[w];
    }
  }
  return false;
}

// Calls f(box) for boxes of at most 32³ voxels that have all changes, each as small as it can be.
template <int Bits>
template <class F>
void TreeEditor::WorkOf<Bits>::forEachTile(F&& f) {
  for (std::int32_t z = box_.lo[2]; z < box_.hi[2]; z += kTile) {
    for (std::int32_t y = box_.lo[1]; y < box_.hi[1]; y += kTile) {
      for (std::int32_t x = box_.lo[0]; x < box_.hi[0]; x += kTile) {
        VoxelBox tight{dims_, {0, 0, 0}};
        std::uint32_t any = 0;
        for (std::int32_t k = z; k < std::min(z + kTile, box_.hi[2]); ++k) {
          for (std::int32_t j = y; j < std::min(y + kTile, box_.hi[1]); ++j) {
            const std::uint32_t bits = bitsAt(changed_.row(j, k), dims_[0], x, kTile);
            if (bits == 0) continue;
            any |= bits;
            tight.include({x, j, k});
          }
        }
        if (any == 0) continue;
        tight.lo[0] = x + std::countr_zero(any);
        tight.hi[0] = x + 32 - std::countl_zero(any);
        f(tight);
      }
    }
  }
}

// Surface voxels are those of the changes and next to them that were and that are: by rows.
template <int Bits>
void TreeEditor::WorkOf<Bits>::countSurface() {
  const VoxelBox around = box_.grown({1, 1, 1}, dims_);
  const auto words = static_cast<std::int32_t>(solid_.rowWords);
  const std::int32_t firstWord = around.lo[0] >> 6;
  const std::int32_t lastWord = (around.hi[0] - 1) >> 6;
  const auto before = [&](std::int32_t w, std::int32_t j, std::int32_t k, bool edited) {
    if (w < 0 || w >= words || j < 0 || j >= dims_[1] || k < 0 || k >= dims_[2]) {
      return std::uint64_t{0};
    }
    const std::size_t at = solid_.rowAt(j, k) + static_cast<std::size_t>(w);
    return edited ? solid_.word[at] : solid_.word[at] ^ changed_.word[at];
  };
  std::ptrdiff_t more = 0;
  for (std::int32_t k = around.lo[2]; k < around.hi[2]; ++k) {
    for (std::int32_t j = around.lo[1]; j < around.hi[1]; ++j) {
      for (std::int32_t w = firstWord; w <= lastWord; ++w) {
        for (const bool edited : {false, true}) {
          const std::uint64_t at = before(w, j, k, edited);
          const std::uint64_t left = at << 1 | before(w - 1, j, k, edited) >> 63;
          const std::uint64_t right = at >> 1 | before(w + 1, j, k, edited) << 63;
          const std::uint64_t open =
              at & ~(left & right & before(w, j - 1, k, edited) & before(w, j + 1, k, edited) &
                     before(w, j, k - 1, edited) & before(w, j, k + 1, edited));
          more += edited ? std::popcount(open) : -std::popcount(open);
        }
      }
    }
  }
  data_.stats.surfaceVoxels += static_cast<std::size_t>(more);
}

// ---- masks and links ----

template <int Bits>
NodeMask<Bits> TreeEditor::WorkOf<Bits>::voxelMask(const Address& node) const noexcept {
  Mask mask;
  const std::int32_t x = node[0] * Mask::kEdge;
  for (int z = 0; z < Mask::kEdge && node[2] * Mask::kEdge + z < dims_[2]; ++z) {
    for (int y = 0; y < Mask::kEdge && node[1] * Mask::kEdge + y < dims_[1]; ++y) {
      const std::uint64_t* row = solid_.row(node[1] * Mask::kEdge + y, node[2] * Mask::kEdge + z);
      const int at = Mask::child(0, y, z);
      mask.word[static_cast<std::size_t>(at) >> 6] |=
          std::uint64_t{bitsAt(row, dims_[0], x, Mask::kEdge)} << (at & 63);
    }
  }
  return mask;
}

template <int Bits>
NodeMask<Bits> TreeEditor::WorkOf<Bits>::cellMask(const Address& node) const noexcept {
  Mask mask;
  const std::int32_t x = node[0] * Mask::kEdge;
  const int cells = std::min(Mask::kEdge, data_.extent[0] - x);
  for (int z = 0; z < Mask::kEdge && node[2] * Mask::kEdge + z < data_.extent[2]; ++z) {
    for (int y = 0; y < Mask::kEdge && node[1] * Mask::kEdge + y < data_.extent[1]; ++y) {
      std::uint32_t any = 0;
      for (int c = 0; c < 4; ++c) {
        any |= bitsAt(
            solid_.row(node[1] * Mask::kEdge + y + (c & 1), node[2] * Mask::kEdge + z + (c >> 1)),
            dims_[0], x, cells + 1);
      }
      const std::uint64_t bits = (any | any >> 1) & ((1U << cells) - 1U);
      const int at = Mask::child(0, y, z);
      mask.word[static_cast<std::size_t>(at) >> 6] |= bits << (at & 63);
    }
  }
  return mask;
}

// Codes of new voxels are to come.
template <int Bits>
void TreeEditor::WorkOf<Bits>::editLeafNodes(const VoxelBox& box) {
  TreeLevel& level = data_.level[1];
  Address at;
  for (at[2] = box.lo[2] >> Bits; at[2] <= (box.hi[2] - 1) >> Bits; ++at[2]) {
    for (at[1] = box.lo[1] >> Bits; at[1] <= (box.hi[1] - 1) >> Bits; ++at[1]) {
      for (at[0] = box.lo[0] >> Bits; at[0] <= (box.hi[0] - 1) >> Bits; ++at[0]) {
        const Mask mask = voxelMask(at);
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
          node_.label[static_cast<std::size_t>(c)] = label_;
        });
        if (node == kNoNode) node = groups_.insert(at);
        mask.store(level.masks.data(), node);
        level.firstChild[node] = leaves_.write(mask, link, before, node_);
      }
    }
  }
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::editCellNodes(const VoxelBox& box) {
  TreeLevel& level = data_.level[1];
  Address lo;
  Address hi;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = std::max(box.lo[a] - 1, 0) >> Bits;
    hi[a] = std::min(box.hi[a] - 1, data_.extent[a] - 1) >> Bits;
  }
  Address at;
  for (at[2] = lo[2]; at[2] <= hi[2]; ++at[2]) {
    for (at[1] = lo[1]; at[1] <= hi[1]; ++at[1]) {
      for (at[0] = lo[0]; at[0] <= hi[0]; ++at[0]) {
        const Mask mask = cellMask(at);
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

// ---- depths of voxel leaves ----

// The nodes of level 1 that may have a depth that a change in the box makes other, and the box
// around them: a depth is other only where it was no less than the distance to the change.
template <int Bits>
VoxelBox TreeEditor::WorkOf<Bits>::findNodes(const VoxelBox& box) {
  const VoxelBox band = box.grown(deepReach_, dims_);
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
void TreeEditor::WorkOf<Bits>::readSquares(const Address& at, const Mask& mask, float beyond) {
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

template <int Bits>
void TreeEditor::WorkOf<Bits>::writeNode(const FoundNode& found, const Mask& mask,
                                         std::size_t count) {
  std::uint32_t& link = data_.level[1].firstChild[found.node];
  const auto voxels = static_cast<int>(count);
  std::fill_n(&ranks_[count], 3, std::uint16_t{0});
  if (leaves_.writeCodes(link, voxels, ranks_.data())) return;
  leaves_.read(mask, link, node_);  // for its labels
  std::size_t rank = 0;
  forEachChild(mask, [&](int c) { node_.code[static_cast<std::size_t>(c)] = ranks_[rank++]; });
  link = leaves_.write(mask, link, voxels, node_);
}

// Codes of the depths with these squares; the far end of the window's stands for all beyond.
template <int Bits>
void TreeEditor::WorkOf<Bits>::codeSquares(std::size_t count) noexcept {
  if (codeOfSquare_.empty()) {
    for (std::size_t r = 0; r < count; ++r) codeOf_[r] = palette_.codeOf(-square_[r]);
    return;
  }
  for (std::size_t r = 0; r < count; ++r) {
    codeOf_[r] = codeOfSquare_[static_cast<std::size_t>(static_cast<std::int32_t>(square_[r]))];
  }
}

// Depths are at most the distance to what was removed.
template <int Bits>
void TreeEditor::WorkOf<Bits>::carveLeaves(const VoxelBox& box) {
  const VoxelBox around = findNodes(box);
  if (found_.empty()) return;
  window_.measureTo(changed_, box, around);
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
void TreeEditor::WorkOf<Bits>::fillLeaves(const VoxelBox& box) {
  const VoxelBox around = findNodes(box);
  window_.measureTo(changed_, box, around);
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
  window_.measure(solid_, again.grown({0, 0, 0}, dims_), Band::Both);
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

// ---- depths of distance leaves ----

template <int Bits>
bool TreeEditor::WorkOf<Bits>::brickHasVoxels(const Address& block) const noexcept {
  for (std::int32_t k = block[2] * 4; k <= std::min(block[2] * 4 + 4, dims_[2] - 1); ++k) {
    for (std::int32_t j = block[1] * 4; j <= std::min(block[1] * 4 + 4, dims_[1] - 1); ++j) {
      if (bitsAt(solid_.row(j, k), dims_[0], block[0] * 4, 5) != 0) return true;
    }
  }
  return false;
}

// Calls f(block) for the 4³ blocks with a corner in the box.
template <int Bits>
template <class F>
void TreeEditor::WorkOf<Bits>::forEachBlock(const VoxelBox& box, F&& f) {
  Address lo;
  Address hi;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = std::max(box.lo[a] - 1, 0) >> 2;
    hi[a] = std::min(box.hi[a] - 1, data_.extent[a] - 1) >> 2;
  }
  Address at;
  for (at[2] = lo[2]; at[2] <= hi[2]; ++at[2]) {
    for (at[1] = lo[1]; at[1] <= hi[1]; ++at[1]) {
      for (at[0] = lo[0]; at[0] <= hi[0]; ++at[0]) f(at);
    }
  }
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::editBrickDepths(const VoxelBox& box) {
  const bool adding = label_ != 0;
  const VoxelBox band = box.grown(deepReach_, dims_);
  if (adding) {
    // Whole bricks.
    VoxelBox whole;
    for (std::size_t a = 0; a < 3; ++a) {
      whole.lo[a] = std::max(band.lo[a] - 1, 0) & ~3;
      whole.hi[a] = std::min((band.hi[a] - 1) / 4 * 4 + 5, dims_[a]);
    }
    window_.measure(solid_, whole, Band::Both);
    forEachBlock(band, [&](const Address& block) { fillBrick(block); });
    lowerClearances(box);
  } else {
    near_.measure(solid_, box.grown(nearReach_, dims_), Band::Outside);
    window_.measureTo(changed_, box, band);
    forEachBlock(band, [&](const Address& block) { carveBrick(block, box); });
  }
  if (!bricks_.labelled()) return;
  forEachBlock(box, [&](const Address& block) {
    const std::size_t word = bricks_.wordOf(block);
    if (bricks_.linked(word)) editLabels(block, word);
  });
}

// A brick near removed voxels: depths inside are at most the distance to these.
template <int Bits>
void TreeEditor::WorkOf<Bits>::carveBrick(const Address& block, const VoxelBox& box) {
  const std::size_t word = bricks_.wordOf(block);
  if (!bricks_.linked(word)) return;
  bool touches = true;  // a corner is in the box
  for (std::size_t a = 0; a < 3; ++a) {
    touches = touches && block[a] * 4 < box.hi[a] && block[a] * 4 + 5 > box.lo[a];
  }
  if (touches && !brickHasVoxels(block)) return bricks_.drop(word);
  const std::uint32_t link = bricks_.linkAt(word);
  const bool shared = bricks_.shared(link);
  if (!shared) bricks_.read(link, codes_);
  const VoxelBox& band = window_.box();
  bool some = false;
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    const std::int32_t k = std::min(block[2] * 4 + z, dims_[2] - 1);
    for (std::int32_t y = 0; y < 5; ++y) {
      const std::int32_t j = std::min(block[1] * 4 + y, dims_[1] - 1);
      const std::uint64_t* row = solid_.row(j, k);
      for (std::int32_t x = 0; x < 5; ++x, ++at) {
        const std::int32_t i = std::min(block[0] * 4 + x, dims_[0] - 1);
        if ((row[i >> 6] >> (i & 63) & 1U) == 0) {
          if (!near_.box().contains(i, j, k)) continue;
          const std::uint16_t code = palette_.codeOf(near_.at(i, j, k));
          some = some || shared || code != codes_[at];
          codes_[at] = code;
        } else if (band.contains(i, j, k)) {
          const std::uint16_t code = palette_.codeOf(-window_.at(i, j, k));
          if (shared) {
            some = some || code < palette_.saturatedCode();
          } else if (code < codes_[at]) {
            codes_[at] = code;
            some = true;
          }
        }
      }
    }
  }
  if (!some) return;
  if (shared) measureBrick(block, codes_);
  bricks_.write(block, codes_);
}

// Codes of a brick that are not known, because it was a shared one.
template <int Bits>
void TreeEditor::WorkOf<Bits>::measureBrick(const Address& block, BrickStore::Codes& codes) {
  VoxelBox corners;
  for (std::size_t a = 0; a < 3; ++a) {
    corners.lo[a] = block[a] * 4;
    corners.hi[a] = std::min(block[a] * 4 + 5, dims_[a]);
  }
  brick_.measure(solid_, corners, Band::Both);
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    for (std::int32_t y = 0; y < 5; ++y) {
      for (std::int32_t x = 0; x < 5; ++x, ++at) {
        codes[at] = palette_.codeOf(brick_.at(std::min(block[0] * 4 + x, dims_[0] - 1),
                                              std::min(block[1] * 4 + y, dims_[1] - 1),
                                              std::min(block[2] * 4 + z, dims_[2] - 1)));
      }
    }
  }
}

// A brick near added voxels, all of whose corners are in the window.
template <int Bits>
void TreeEditor::WorkOf<Bits>::fillBrick(const Address& block) {
  const std::size_t word = bricks_.wordOf(block);
  const bool linked = bricks_.linked(word);
  // Depths inside only grow: what was saturated is.
  if (linked && bricks_.shared(bricks_.linkAt(word))) return;
  if (!linked && !brickHasVoxels(block)) return;
  if (linked) bricks_.read(bricks_.linkAt(word), codes_);
  bool some = !linked;
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    const std::int32_t k = std::min(block[2] * 4 + z, dims_[2] - 1);
    for (std::int32_t y = 0; y < 5; ++y) {
      const float* row = window_.row(std::min(block[1] * 4 + y, dims_[1] - 1), k);
      for (std::int32_t x = 0; x < 5; ++x, ++at) {
        const std::int32_t i = std::min(block[0] * 4 + x, dims_[0] - 1);
        const std::uint16_t code = palette_.codeOf(row[i - window_.box().lo[0]]);
        some = some || code != codes_[at];
        codes_[at] = code;
      }
    }
  }
  if (some) bricks_.write(block, codes_);
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::editLabels(const Address& block, std::size_t word) {
  bricks_.readLabels(word, labels_);
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    for (std::int32_t y = 0; y < 5; ++y) {
      for (std::int32_t x = 0; x < 5; ++x, ++at) {
        const std::int32_t i = std::min(block[0] * 4 + x, dims_[0] - 1);
        const std::int32_t j = std::min(block[1] * 4 + y, dims_[1] - 1);
        const std::int32_t k = std::min(block[2] * 4 + z, dims_[2] - 1);
        if (!solid_.test(i, j, k)) {
          labels_[at] = 0;
        } else if (changed_.test(i, j, k)) {
          labels_[at] = label_;
        }
      }
    }
  }
  bricks_.writeLabels(word, labels_);
}

// Values fall at most a cell's diagonal from an added voxel where a cell may be in the region
// afterwards that was not before: deeper inside, cells are in it all over.
template <int Bits>
void TreeEditor::WorkOf<Bits>::lowerClearances(const VoxelBox& box) {
  DepthBricks& d = data_.depth;
  std::array<float, 3> edge;
  SpaceBox region;
  float around = 0;  // what the slopes may add, by cells
  for (std::size_t a = 0; a < 3; ++a) {
    edge[a] = std::sqrt(palette_.weight()[a]);
    const std::int32_t steps = nearReach_[a] + 1;
    region.lo[a] = edge[a] * static_cast<float>(box.lo[a] - steps);
    region.hi[a] = edge[a] * static_cast<float>(box.hi[a] - 1 + steps);
    around += edge[a];
  }
  const auto blockBox = [&edge](const Address& block, std::int32_t cells) {
    SpaceBox b;
    for (std::size_t a = 0; a < 3; ++a) {
      b.lo[a] = edge[a] * static_cast<float>(block[a] * cells);
      b.hi[a] = b.lo[a] + edge[a] * static_cast<float>(cells);
    }
    return b;
  };
  constexpr float kMost = ClearanceWord::kBoundBias;
  const float coarseReach = kMost / ClearanceWord::kCoarseSteps + 16.0f * around;
  const float blockReach = kMost / ClearanceWord::kBlockSteps + 4.0f * around;
  const float brickReach = kMost / ClearanceWord::kBrickSteps + 4.0f * around;
  Address at;
  for (at[2] = 0; at[2] < d.blocks[2]; ++at[2]) {
    for (at[1] = 0; at[1] < d.blocks[1]; ++at[1]) {
      for (at[0] = 0; at[0] < d.blocks[0]; ++at[0]) {
        std::uint32_t& coarse = d.coarse[d.blockAt(at[0], at[1], at[2])];
        const SpaceBox block = blockBox(at, DepthBricks::kCoarseEdge);
        const float gap = gapBetween(block, region);
        if ((coarse & ClearanceWord::kLink) == 0) {
          if (gap > coarseReach) continue;
          coarse = loweredClearance(coarse, ClearanceWord::kCoarseSteps, block, region);
          continue;
        }
        if (gap > blockReach) continue;
        const std::size_t first = std::size_t{coarse & ~ClearanceWord::kLink} * 64;
        for (std::int32_t child = 0; child < 64; ++child) {
          std::uint32_t& word = d.words[first + static_cast<std::size_t>(child)];
          const SpaceBox small = blockBox(
              {at[0] * 4 + (child & 3), at[1] * 4 + (child >> 2 & 3), at[2] * 4 + (child >> 4)},
              DepthBricks::kEdge);
          if ((word & ClearanceWord::kLink) == 0) {
            word = loweredClearance(word, ClearanceWord::kBlockSteps, small, region);
          } else if (gap <= brickReach) {
            std::uint32_t& own = d.slots[DepthBricks::placeOf(word) + DepthBricks::kRows];
            own = loweredClearance(own, ClearanceWord::kBrickSteps, small, region);
          }
        }
      }
    }
  }
}

// ---- all of it ----

template <int Bits>
EditResult TreeEditor::WorkOf<Bits>::edit(std::span<const Voxel> voxels, std::uint8_t label) {
  EditResult result;
  for (const Voxel& v : voxels) {
    if (data_.geometry.contains(v[0], v[1], v[2])) continue;
    result.status = EditStatus::OutsideGrid;
    return result;
  }
  label_ = label;
  const bool possible = mark(voxels);
  if (possible && count_ > 0) {
    if (label != 0 && data_.depth.uniformLabel != 0 && data_.depth.uniformLabel != label) {
      separateLabels();
      result.tookMemory = true;
    }
    countSurface();
    forEachTile([this](const VoxelBox& box) {
      if (distance_) {
        editCellNodes(box);
      } else {
        editLeafNodes(box);
      }
    });
    forEachTile([this](const VoxelBox& box) {
      if (distance_) {
        editBrickDepths(box);
      } else if (label_ != 0) {
        fillLeaves(box);
      } else {
        carveLeaves(box);
      }
    });
    data_.stats.solidVoxels += label != 0 ? count_ : std::size_t{0} - count_;
    ++data_.edits;
    fillStats();
    const bool grew = groups_.grew() | leaves_.grew() | bricks_.grew();
    result.tookMemory = result.tookMemory || grew;
  }
  for (std::int32_t k = box_.lo[2]; k < box_.hi[2]; ++k) {
    for (std::int32_t j = box_.lo[1]; j < box_.hi[1]; ++j) {
      std::fill(changed_.row(j, k) + (box_.lo[0] >> 6),
                changed_.row(j, k) + ((box_.hi[0] - 1) >> 6) + 1, 0);
    }
  }
  if (!possible) {
    result.status = EditStatus::WouldBeEmpty;
    return result;
  }
  result.changed = count_;
  result.ignored = voxels.size() - count_;
  return result;
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::fillStats() {
  countBytes(data_);
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::reserve(const VoxelBox& box) {
  if (box.empty()) return;
  const auto boxes = [](const VoxelBox& of, int shift) {
    std::size_t n = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      n *= static_cast<std::size_t>(((of.hi[a] - 1) >> shift) - (of.lo[a] >> shift) + 1);
    }
    return n;
  };
  const VoxelBox items = box.grown({1, 1, 1}, dims_);
  const VoxelBox band = box.grown(deepReach_, dims_).grown({1, 1, 1}, dims_);
  for (int l = 1; l < data_.levels; ++l) {
    groups_.reserve(static_cast<std::size_t>(l), boxes(items, Bits * (l + 1)));
  }
  if (distance_) {
    bricks_.reserve(boxes(band, 2), boxes(band, 4), boxes(items, 2));
  } else {
    leaves_.reserve(boxes(band, Bits));
  }
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::separateLabels() {
  if (data_.depth.uniformLabel == 0) return;
  if (distance_) {
    bricks_.separateLabels();
  } else {
    labelLeaves<Bits>(data_);
    leaves_.restart(true);
  }
  fillStats();
}

template <int Bits>
void TreeEditor::WorkOf<Bits>::compact() {
  putInOrder<Bits>(data_);
  groups_.restart();
  leaves_.restart(data_.depth.uniformLabel == 0);
  bricks_.restart();
  fillStats();
}

Result<TreeEditor> TreeEditor::create(VoxelTree& tree) {
  VoxelTree::Data& data = *tree.data_;
  if (data.options.surfaceOnly) {
    return fail(inputRefused("A tree of surface voxels only cannot be edited.")
                    .inField("surfaceOnly")
                    .advise("Build the tree from all voxels."));
  }
  std::size_t nodes = 1;  // of level 1
  std::size_t bricks = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    nodes *= static_cast<std::size_t>((data.extent[a] >> data.bits) + 1);
    bricks *= static_cast<std::size_t>((data.extent[a] >> 2) + 1);
  }
  const std::size_t slots = data.depth.slots.size() / DepthBricks::kSlotWords + 2 * bricks;
  const std::size_t most = leafBytesOf(std::size_t{1} << (3 * data.bits), true, true, false);
  const bool distance = data.options.leaf == LeafModel::Distance;
  if (distance ? slots >= kMostSlots : data.leafBytes.size() + nodes * most >= kWideLeaves) {
    return fail(tooLarge());
  }
  std::unique_ptr<Work> work;
  if (data.bits == 1) work = std::make_unique<WorkOf<1>>(data);
  if (data.bits == 2) work = std::make_unique<WorkOf<2>>(data);
  if (data.bits == 3) work = std::make_unique<WorkOf<3>>(data);
  return TreeEditor(std::move(work));
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
