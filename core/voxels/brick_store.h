#pragma once
/// Edits of bricks: their codes, labels, words and places. Internal to TreeEditor.
///
/// A brick that is new or needs twelve bits where its place has room for six, or that no longer
/// shares a deep brick, moves once, to a place behind those built, with room for both slots. Such
/// places are used again when their brick goes. A block of 16³ cells that gets its first brick gets
/// words, and keeps them.

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/voxels/depth_bricks.h"

namespace palpate {

class BrickStore {
 public:
  static constexpr std::size_t kCorners = 125;  ///< Of a brick, x fastest.
  using Codes = std::array<std::uint16_t, kCorners>;
  using Labels = std::array<std::uint8_t, kCorners>;

  explicit BrickStore(DepthBricks& bricks);
  /// After the arrays were put in order.
  void restart();

  /// Place in `words` of a 4³ block (address in such blocks); below 64 where it has no words.
  [[nodiscard]] std::size_t wordOf(const std::array<std::int32_t, 3>& block) const noexcept {
    return bricks_.wordAt({block[0] * 4, block[1] * 4, block[2] * 4});
  }
  [[nodiscard]] bool linked(std::size_t word) const noexcept {
    return (bricks_.words[word] & ClearanceWord::kLink) != 0;
  }
  [[nodiscard]] std::uint32_t linkAt(std::size_t word) const noexcept {
    return bricks_.words[word] & ~ClearanceWord::kLink;
  }
  /// Is it one of the shared deep bricks? Only these have rungs.
  [[nodiscard]] bool shared(std::uint32_t link) const noexcept {
    return bricks_.codeAt(link, 0, 0, 0) > bricks_.palette.deepestCode();
  }
  void read(std::uint32_t link, Codes& codes) const noexcept;

  /// Writes the brick of a block, which may be new; gives its place in `words`. Its clearance stays
  /// what bounded the block before.
  std::size_t write(const std::array<std::int32_t, 3>& block, const Codes& codes);
  /// Takes it away. Its clearance stays that of the block.
  void drop(std::size_t word);

  [[nodiscard]] bool labelled() const noexcept { return bricks_.uniformLabel == 0; }
  /// Gives each brick a label of its own.
  void separateLabels();
  void readLabels(std::size_t word, Labels& labels) const noexcept;
  /// 0 for corners outside.
  void writeLabels(std::size_t word, const Labels& labels);

  /// Takes memory for so many more bricks, blocks with words and bricks with several labels.
  void reserve(std::size_t bricks, std::size_t wordBlocks, std::size_t mixed);
  [[nodiscard]] bool grew() noexcept { return std::exchange(grew_, false); }

 private:
  void addWords(std::size_t block);
  [[nodiscard]] std::size_t takeSlots();
  void freeSlots(std::uint32_t link);
  void freeLabels(std::size_t word);
  void pushFree(std::vector<std::uint32_t>& list, std::size_t place);
  template <class T>
  void extend(LargeArray<T>& array, std::size_t count);

  DepthBricks& bricks_;
  std::size_t built_ = 0;                 // slots that lie as they were built
  std::vector<std::uint32_t> freeSlots_;  // first of two slots
  std::vector<std::uint32_t> freeLabels_;
  bool grew_ = false;
};

}  // namespace palpate
