#include "core/voxels/brick_store.h"

#include <algorithm>

#include "core/voxels/clearance_edit.h"

namespace palpate {

BrickStore::BrickStore(DepthBricks& bricks) : bricks_(bricks) {
  restart();
}

void BrickStore::restart() {
  built_ = bricks_.slots.size() / DepthBricks::kSlotWords;
  freeSlots_.clear();
  freeLabels_.clear();
}

template <class T>
void BrickStore::extend(LargeArray<T>& array, std::size_t count) {
  const T* before = array.data();
  array.resize(array.size() + count);
  grew_ = grew_ || before != array.data();
}

void BrickStore::pushFree(std::vector<std::uint32_t>& list, std::size_t place) {
  grew_ = grew_ || list.size() == list.capacity();
  list.push_back(static_cast<std::uint32_t>(place));
}

void BrickStore::read(std::uint32_t link, Codes& codes) const noexcept {
  const std::uint32_t* row = &bricks_.slots[DepthBricks::placeOf(link)];
  const bool wide = (link & DepthBricks::kWide) != 0;
  std::size_t at = 0;
  for (std::size_t r = 0; r < DepthBricks::kRows; ++r) {
    const std::uint32_t low = row[r];
    const std::uint32_t high = wide ? row[DepthBricks::kSlotWords + r] : 0;
    for (unsigned x = 0; x < 5; ++x) {
      codes[at++] =
          static_cast<std::uint16_t>((low >> (6 * x) & 63U) | (high >> (6 * x) & 63U) << 6);
    }
  }
}

std::size_t BrickStore::write(const std::array<std::int32_t, 3>& block, const Codes& codes) {
  std::size_t word = wordOf(block);
  if (word < 64) {
    addWords(bricks_.blockAt(block[0] >> 2, block[1] >> 2, block[2] >> 2));
    word = wordOf(block);
  }
  std::array<std::uint32_t, 2 * DepthBricks::kSlotWords> rows{};
  std::uint32_t anyHigh = 0;
  std::size_t at = 0;
  for (std::size_t r = 0; r < DepthBricks::kRows; ++r) {
    std::uint32_t low = 0;
    std::uint32_t high = 0;
    for (unsigned x = 0; x < 5; ++x, ++at) {
      low |= (codes[at] & 63U) << (6 * x);
      high |= static_cast<std::uint32_t>(codes[at] >> 6) << (6 * x);
    }
    rows[r] = low;
    rows[DepthBricks::kSlotWords + r] = high;
    anyHigh |= high;
  }
  bool wide = anyHigh != 0;
  std::uint32_t clearance = 0;
  std::size_t slot = 0;
  if (!linked(word)) {
    clearance = recodedClearance(bricks_.words[word], ClearanceWord::kBlockSteps,
                                 ClearanceWord::kBrickSteps, {0, 0, 0});
    slot = takeSlots();
    if (labelled()) bricks_.label[word] = DepthBricks::kOneLabel;
  } else {
    const std::uint32_t link = linkAt(word);
    slot = DepthBricks::placeOf(link) / DepthBricks::kSlotWords;
    clearance = bricks_.slots[slot * DepthBricks::kSlotWords + DepthBricks::kRows];
    const bool wideBefore = (link & DepthBricks::kWide) != 0;
    if (shared(link) || (slot < built_ && wide && !wideBefore)) {
      slot = takeSlots();
    } else if (slot < built_) {
      wide = wideBefore;  // so that its room is known
    }
  }
  std::uint32_t* to = &bricks_.slots[slot * DepthBricks::kSlotWords];
  std::copy_n(rows.data(), (wide ? 2 : 1) * DepthBricks::kSlotWords, to);
  to[DepthBricks::kRows] = clearance;
  bricks_.words[word] = ClearanceWord::kLink | DepthBricks::linkTo(slot, wide);
  return word;
}

void BrickStore::drop(std::size_t word) {
  const std::uint32_t link = linkAt(word);
  const std::uint32_t clearance = bricks_.slots[DepthBricks::placeOf(link) + DepthBricks::kRows];
  freeSlots(link);
  if (labelled()) {
    freeLabels(word);
    bricks_.label[word] = 0;
  }
  bricks_.words[word] = recodedClearance(clearance, ClearanceWord::kBrickSteps,
                                         ClearanceWord::kBlockSteps, {0, 0, 0});
}

// The words of a block that had one clearance for all.
void BrickStore::addWords(std::size_t block) {
  const std::size_t first = bricks_.words.size();
  extend(bricks_.words, 64);
  if (labelled()) extend(bricks_.label, 64);
  const std::uint32_t whole = bricks_.coarse[block];
  for (std::size_t child = 0; child < 64; ++child) {
    std::array<float, 3> by;
    for (std::size_t a = 0; a < 3; ++a) {
      by[a] = std::sqrt(bricks_.palette.weight()[a]) *
              (static_cast<float>(child >> (2 * a) & 3U) * 4.0f - 6.0f);
    }
    bricks_.words[first + child] =
        recodedClearance(whole, ClearanceWord::kCoarseSteps, ClearanceWord::kBlockSteps, by);
  }
  bricks_.coarse[block] = ClearanceWord::kLink | static_cast<std::uint32_t>(first / 64);
  bricks_.firstWord[block] = static_cast<std::uint32_t>(first);
}

std::size_t BrickStore::takeSlots() {
  if (!freeSlots_.empty()) {
    const std::size_t slot = freeSlots_.back();
    freeSlots_.pop_back();
    return slot;
  }
  const std::size_t slot = bricks_.slots.size() / DepthBricks::kSlotWords;
  extend(bricks_.slots, 2 * DepthBricks::kSlotWords);
  return slot;
}

void BrickStore::freeSlots(std::uint32_t link) {
  const std::size_t slot = DepthBricks::placeOf(link) / DepthBricks::kSlotWords;
  if (slot >= built_) pushFree(freeSlots_, slot);
}

void BrickStore::freeLabels(std::size_t word) {
  if ((bricks_.label[word] & DepthBricks::kOneLabel) == 0) {
    pushFree(freeLabels_, bricks_.label[word]);
  }
}

void BrickStore::separateLabels() {
  const std::uint32_t one = DepthBricks::kOneLabel | bricks_.uniformLabel;
  bricks_.label.assign(bricks_.words.size(), 0);
  for (std::size_t word = 0; word < bricks_.words.size(); ++word) {
    if (linked(word)) bricks_.label[word] = one;
  }
  bricks_.uniformLabel = 0;
}

void BrickStore::readLabels(std::size_t word, Labels& labels) const noexcept {
  const std::uint32_t label = bricks_.label[word];
  if ((label & DepthBricks::kOneLabel) != 0) {
    labels.fill(static_cast<std::uint8_t>(label & 255U));
  } else {
    std::copy_n(&bricks_.labelBytes[label * DepthBricks::kLabelBytes], kCorners, labels.begin());
  }
}

void BrickStore::writeLabels(std::size_t word, const Labels& labels) {
  std::uint8_t first = 0;
  bool same = true;
  for (const std::uint8_t label : labels) {
    if (label == 0) continue;
    if (first == 0) first = label;
    same = same && label == first;
  }
  std::uint32_t& own = bricks_.label[word];
  if (same) {
    freeLabels(word);
    own = DepthBricks::kOneLabel | first;
    return;
  }
  if ((own & DepthBricks::kOneLabel) != 0) {
    if (!freeLabels_.empty()) {
      own = freeLabels_.back();
      freeLabels_.pop_back();
    } else {
      own = static_cast<std::uint32_t>(bricks_.labelBytes.size() / DepthBricks::kLabelBytes);
      extend(bricks_.labelBytes, DepthBricks::kLabelBytes);
    }
  }
  std::copy(labels.begin(), labels.end(),
            bricks_.labelBytes.begin() + std::size_t{own} * DepthBricks::kLabelBytes);
}

void BrickStore::reserve(std::size_t bricks, std::size_t wordBlocks, std::size_t mixed) {
  bricks_.slots.reserve(bricks_.slots.size() + bricks * 2 * DepthBricks::kSlotWords);
  freeSlots_.reserve(((bricks_.slots.size() / DepthBricks::kSlotWords - built_) / 2) + bricks);
  bricks_.words.reserve(bricks_.words.size() + wordBlocks * 64);
  if (!labelled()) return;
  bricks_.label.reserve(bricks_.label.size() + wordBlocks * 64);
  const std::size_t entries = bricks_.labelBytes.size() / DepthBricks::kLabelBytes + mixed;
  bricks_.labelBytes.reserve(entries * DepthBricks::kLabelBytes);
  freeLabels_.reserve(entries);
}

}  // namespace palpate
