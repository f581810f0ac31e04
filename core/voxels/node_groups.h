#pragma once
/// Edits of a tree's masks and links: nodes come and go, children stay neighbours. Internal to
/// TreeEditor.
///
/// A group of children that must grow moves once, to a place at the end of its level with room for
/// all children; from then on it is changed in place, and its place is used again when its node
/// goes. What it leaves has empty masks. So a level never exceeds what it was at first by more than
/// the room for all children of the nodes above.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/voxels/node_mask.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

template <int Bits>
class NodeGroups {
 public:
  using Mask = NodeMask<Bits>;
  using Address = std::array<std::int32_t, 3>;

  explicit NodeGroups(VoxelTree::Data& data) : data_(data), state_(data.level.size()) { restart(); }

  /// After the arrays were put in order: all of them are as built.
  void restart() {
    for (std::size_t l = 1; l < state_.size(); ++l) {
      state_[l].built = static_cast<std::uint32_t>(nodes(l));
      state_[l].free.clear();
    }
  }

  [[nodiscard]] std::size_t nodes(std::size_t l) const noexcept {
    return data_.level[l].masks.size() / Mask::kBytes;
  }
  /// The node of level 1 of this address; kNoNode where there is none.
  [[nodiscard]] std::uint32_t find(const Address& at) const noexcept {
    std::uint32_t node = 0;
    for (int l = data_.levels; l > 1; --l) {
      const TreeLevel& level = data_.level[static_cast<std::size_t>(l)];
      const Mask mask = Mask::load(level.masks.data(), node);
      const int c = childAt(at, l);
      if (!mask.test(c)) return kNoNode;
      node = level.firstChild[node] + static_cast<std::uint32_t>(mask.rank(c));
    }
    return node;
  }
  /// The same; where there is none it and what leads to it are made, without children.
  std::uint32_t insert(const Address& at) {
    std::uint32_t node = 0;
    for (int l = data_.levels; l > 1; --l) {
      const TreeLevel& level = data_.level[static_cast<std::size_t>(l)];
      const Mask mask = Mask::load(level.masks.data(), node);
      const int c = childAt(at, l);
      node = mask.test(c) ? level.firstChild[node] + static_cast<std::uint32_t>(mask.rank(c))
                          : addChild(static_cast<std::size_t>(l), node, c);
    }
    return node;
  }
  /// Takes away a node of level 1, which is there and has no children any more, and whatever is
  /// left without children above it. The root stays.
  void remove(const Address& at) noexcept {
    std::array<std::uint32_t, 32> path{};
    std::uint32_t node = 0;
    for (int l = data_.levels; l > 1; --l) {
      path[static_cast<std::size_t>(l)] = node;
      const TreeLevel& level = data_.level[static_cast<std::size_t>(l)];
      node = level.firstChild[node] +
             static_cast<std::uint32_t>(Mask::load(level.masks.data(), node).rank(childAt(at, l)));
    }
    for (int l = 2; l <= data_.levels; ++l) {
      const auto up = static_cast<std::size_t>(l);
      if (!dropChild(up, path[up], childAt(at, l))) return;
    }
  }

  /// Calls f(address, node) for the nodes of level 1 with addresses in lo .. hi.
  template <class F>
  void visit(const Address& lo, const Address& hi, F&& f) const {
    visitFrom(data_.levels, 0, {0, 0, 0}, lo, hi, f);
  }

  /// Takes memory so that so many more groups of children fit in level l.
  void reserve(std::size_t l, std::size_t groups) {
    TreeLevel& level = data_.level[l];
    const std::size_t most = nodes(l) + groups * kRoom;
    level.masks.reserve(most * Mask::kBytes);
    if (!level.firstChild.empty()) level.firstChild.reserve(most);
    state_[l].free.reserve((most - state_[l].built) / kRoom);
  }
  /// Did an edit take memory since this was asked?
  [[nodiscard]] bool grew() noexcept { return std::exchange(grew_, false); }

 private:
  static constexpr std::size_t kRoom = Mask::kChildren;
  struct State {
    std::uint32_t built = 0;          // nodes that lie as they were built
    std::vector<std::uint32_t> free;  // groups behind those that are free
  };

  [[nodiscard]] static int childAt(const Address& at, int l) noexcept {
    const int shift = Bits * (l - 2);
    return Mask::child(at[0] >> shift & Mask::kLow, at[1] >> shift & Mask::kLow,
                       at[2] >> shift & Mask::kLow);
  }

  template <class F>
  void visitFrom(int l, std::uint32_t node, const Address& address, const Address& lo,
                 const Address& hi, F& f) const {
    if (l == 1) return f(address, node);
    const TreeLevel& level = data_.level[static_cast<std::size_t>(l)];
    const int shift = Bits * (l - 2);
    std::uint32_t next = level.firstChild[node];
    forEachChild(Mask::load(level.masks.data(), node), [&](int c) {
      const std::uint32_t child = next++;
      const Address at{address[0] * Mask::kEdge + (c & Mask::kLow),
                       address[1] * Mask::kEdge + ((c >> Bits) & Mask::kLow),
                       address[2] * Mask::kEdge + (c >> (2 * Bits))};
      for (std::size_t a = 0; a < 3; ++a) {
        if (at[a] < lo[a] >> shift || at[a] > hi[a] >> shift) return;
      }
      visitFrom(l - 1, child, at, lo, hi, f);
    });
  }

  // Entries [from, from + count) of a level to `to`; they may overlap.
  void move(std::size_t l, std::size_t from, std::size_t to, std::size_t count) noexcept {
    TreeLevel& level = data_.level[l];
    std::memmove(level.masks.data() + to * Mask::kBytes, level.masks.data() + from * Mask::kBytes,
                 count * Mask::kBytes);
    if (level.firstChild.empty()) return;
    std::memmove(level.firstChild.data() + to, level.firstChild.data() + from,
                 count * sizeof(std::uint32_t));
  }
  void clear(std::size_t l, std::size_t at, std::size_t count) noexcept {
    TreeLevel& level = data_.level[l];
    std::memset(level.masks.data() + at * Mask::kBytes, 0, count * Mask::kBytes);
    if (level.firstChild.empty()) return;
    std::memset(level.firstChild.data() + at, 0, count * sizeof(std::uint32_t));
  }

  // A place for all children of a node, cleared.
  std::uint32_t take(std::size_t l) {
    std::vector<std::uint32_t>& free = state_[l].free;
    if (!free.empty()) {
      const std::uint32_t place = free.back();
      free.pop_back();
      return place;
    }
    TreeLevel& level = data_.level[l];
    const std::size_t place = nodes(l);
    const std::uint8_t* before = level.masks.data();
    level.masks.resize((place + kRoom) * Mask::kBytes);
    if (!level.firstChild.empty()) level.firstChild.resize(place + kRoom);
    grew_ = grew_ || before != level.masks.data();
    return static_cast<std::uint32_t>(place);
  }

  std::uint32_t addChild(std::size_t l, std::uint32_t node, int c) {
    TreeLevel& level = data_.level[l];
    Mask mask = Mask::load(level.masks.data(), node);
    const auto count = static_cast<std::size_t>(mask.count());
    const auto rank = static_cast<std::size_t>(mask.rank(c));
    std::uint32_t first = level.firstChild[node];
    if (count == 0) {
      first = take(l - 1);
    } else if (first < state_[l - 1].built) {
      const std::uint32_t place = take(l - 1);
      move(l - 1, first, place, count);
      clear(l - 1, first, count);
      first = place;
    }
    move(l - 1, first + rank, first + rank + 1, count - rank);
    clear(l - 1, first + rank, 1);
    mask.set(c);
    mask.store(level.masks.data(), node);
    level.firstChild[node] = first;
    ++data_.stats.nodesPerLevel[l - 2];
    return first + static_cast<std::uint32_t>(rank);
  }

  // True where the node has no children left.
  bool dropChild(std::size_t l, std::uint32_t node, int c) noexcept {
    TreeLevel& level = data_.level[l];
    Mask mask = Mask::load(level.masks.data(), node);
    const auto count = static_cast<std::size_t>(mask.count());
    const auto rank = static_cast<std::size_t>(mask.rank(c));
    const std::uint32_t first = level.firstChild[node];
    move(l - 1, first + rank + 1, first + rank, count - rank - 1);
    clear(l - 1, first + count - 1, 1);
    mask.word[static_cast<std::size_t>(c) >> 6] &= ~(std::uint64_t{1} << (c & 63));
    mask.store(level.masks.data(), node);
    --data_.stats.nodesPerLevel[l - 2];
    if (!mask.empty()) return false;
    if (first >= state_[l - 1].built) {
      std::vector<std::uint32_t>& free = state_[l - 1].free;
      grew_ = grew_ || free.size() == free.capacity();
      free.push_back(first);
    }
    level.firstChild[node] = 0;
    return true;
  }

  VoxelTree::Data& data_;
  std::vector<State> state_;
  bool grew_ = false;
};

}  // namespace palpate
