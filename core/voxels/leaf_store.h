#pragma once
/// Edits of the bytes that nodes of voxel leaves link to (leaf_codes.h). Internal to TreeEditor.
///
/// Like a group of nodes, a node's bytes that must grow move once, to a place with room for all
/// its voxels, wide; so the bytes never exceed what they were at first by more than the room for
/// all nodes.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "core/voxels/leaf_codes.h"
#include "core/voxels/node_mask.h"

namespace palpate {

template <int Bits>
class LeafStore {
 public:
  using Mask = NodeMask<Bits>;
  /// By child; those that are absent are not looked at.
  struct Node {
    std::array<std::uint16_t, Mask::kChildren> code{};
    std::array<std::uint8_t, Mask::kChildren> label{};
  };

  LeafStore(LargeArray<std::uint8_t>& bytes, bool labelled) : bytes_(bytes) { restart(labelled); }

  /// After the bytes were put in order.
  void restart(bool labelled) {
    labelled_ = labelled;
    built_ = bytes_.size();
    free_.clear();
  }
  [[nodiscard]] static constexpr std::size_t room(bool labelled) noexcept {
    return leafBytesOf(Mask::kChildren, true, labelled, false);
  }

  void read(const Mask& mask, std::uint32_t link, Node& node) const noexcept {
    const bool wide = (link & kWideLeaves) != 0;
    const std::uint8_t* from = bytes_.data() + (link & ~kWideLeaves);
    const unsigned width = wide ? 12 : 6;
    const std::uint32_t ones = wide ? 4095 : 63;
    std::size_t bit = 0;
    forEachChild(mask, [&](int c) {
      std::uint32_t word = 0;
      std::memcpy(&word, from + bit / 8, sizeof word);
      node.code[static_cast<std::size_t>(c)] = static_cast<std::uint16_t>(word >> (bit % 8) & ones);
      bit += width;
    });
    if (!labelled_) return;
    const std::uint8_t* label = from + (bit + 7) / 8;
    forEachChild(mask, [&](int c) { node.label[static_cast<std::size_t>(c)] = *label++; });
  }

  /// The codes of a node of so many voxels alone, by rank; up to three more may be written.
  static constexpr std::size_t kRanks = Mask::kChildren + 3;
  void readCodes(std::uint32_t link, int count, std::uint16_t* codes) const noexcept {
    const std::uint8_t* from = bytes_.data() + (link & ~kWideLeaves);
    std::uint32_t word = 0;
    if ((link & kWideLeaves) != 0) {
      for (int r = 0; r < count; r += 2, from += 3) {
        std::memcpy(&word, from, sizeof word);
        codes[r] = static_cast<std::uint16_t>(word & 4095U);
        codes[r + 1] = static_cast<std::uint16_t>(word >> 12 & 4095U);
      }
    } else {
      for (int r = 0; r < count; r += 4, from += 3) {
        std::memcpy(&word, from, sizeof word);
        for (int i = 0; i < 4; ++i) {
          codes[r + i] = static_cast<std::uint16_t>(word >> (6 * i) & 63U);
        }
      }
    }
  }
  /// Puts others in their place, as wide as they are; false, and nothing is written, where they
  /// need to be wider. What lies behind the count must be zeros, three at least.
  bool writeCodes(std::uint32_t link, int count, const std::uint16_t* codes) noexcept {
    std::uint8_t* to = bytes_.data() + (link & ~kWideLeaves);
    std::size_t left = leafCodeBytes(static_cast<std::size_t>(count), (link & kWideLeaves) != 0);
    const bool wide = (link & kWideLeaves) != 0;
    if (!wide) {
      std::uint16_t any = 0;
      for (int r = 0; r < count; ++r) any = static_cast<std::uint16_t>(any | codes[r]);
      if (any >= DepthPalette::kNarrow) return false;
    }
    for (int r = 0; r < count; r += wide ? 2 : 4, to += 3) {
      const std::uint32_t word = wide ? codes[r] | static_cast<std::uint32_t>(codes[r + 1]) << 12
                                      : codes[r] | static_cast<std::uint32_t>(codes[r + 1]) << 6 |
                                            static_cast<std::uint32_t>(codes[r + 2]) << 12 |
                                            static_cast<std::uint32_t>(codes[r + 3]) << 18;
      std::memcpy(to, &word, std::min<std::size_t>(left, 3));
      left -= std::min<std::size_t>(left, 3);
    }
    return true;
  }

  /// Writes a node that had `before` voxels at `link` (0: none); gives its link. `mask` is not
  /// empty.
  [[nodiscard]] std::uint32_t write(const Mask& mask, std::uint32_t link, int before,
                                    const Node& node) {
    bool wide = false;
    forEachChild(mask, [&](int c) {
      wide = wide || node.code[static_cast<std::size_t>(c)] >= DepthPalette::kNarrow;
    });
    const auto count = static_cast<std::size_t>(mask.count());
    std::size_t place = link & ~kWideLeaves;
    if (before == 0) {
      place = take();
    } else if (place < built_ && leafBytesOf(count, wide, labelled_, false) >
                                     leafBytesOf(static_cast<std::size_t>(before),
                                                 (link & kWideLeaves) != 0, labelled_, false)) {
      place = take();
    }
    std::uint8_t* to = bytes_.data() + place;
    std::uint64_t pending = 0;
    unsigned bits = 0;
    const unsigned width = wide ? 12 : 6;
    forEachChild(mask, [&](int c) {
      pending |= std::uint64_t{node.code[static_cast<std::size_t>(c)]} << bits;
      bits += width;
      if (bits < 32) return;
      const auto word = static_cast<std::uint32_t>(pending);
      std::memcpy(to, &word, sizeof word);
      to += sizeof word;
      pending >>= 32;
      bits -= 32;
    });
    for (; bits > 0; bits -= std::min(bits, 8U)) {
      *to++ = static_cast<std::uint8_t>(pending & 255U);
      pending >>= 8;
    }
    if (labelled_) {
      forEachChild(mask, [&](int c) { *to++ = node.label[static_cast<std::size_t>(c)]; });
    }
    return static_cast<std::uint32_t>(place) | (wide ? kWideLeaves : 0U);
  }

  void drop(std::uint32_t link) {
    const std::size_t place = link & ~kWideLeaves;
    if (place < built_) return;
    grew_ = grew_ || free_.size() == free_.capacity();
    free_.push_back(static_cast<std::uint32_t>(place));
  }

  void reserve(std::size_t nodes) {
    const std::size_t most = bytes_.size() + nodes * room(labelled_);
    bytes_.reserve(most);
    free_.reserve((most - built_) / room(labelled_));
  }
  [[nodiscard]] bool grew() noexcept { return std::exchange(grew_, false); }

 private:
  std::size_t take() {
    if (!free_.empty()) {
      const std::size_t place = free_.back();
      free_.pop_back();
      return place;
    }
    const std::size_t place = bytes_.size();
    const std::uint8_t* before = bytes_.data();
    bytes_.resize(place + room(labelled_));
    grew_ = grew_ || before != bytes_.data();
    return place;
  }

  LargeArray<std::uint8_t>& bytes_;
  bool labelled_ = false;
  std::size_t built_ = 0;
  std::vector<std::uint32_t> free_;
  bool grew_ = false;
};

}  // namespace palpate
