#include "core/voxels/brick_edit.h"

#include <algorithm>

#include "core/voxels/edited_nodes.h"
#include "core/voxels/lower_clearances.h"

namespace palpate {
namespace {

using Band = DistanceWindow::Band;

// Calls f(block) for the 4³ blocks with a corner in the box, of a tree with so many cells.
template <class F>
void forEachBlock(const VoxelBox& box, const Extent3& extent, F&& f) {
  Extent3 lo;
  Extent3 hi;
  for (std::size_t a = 0; a < 3; ++a) {
    lo[a] = std::max(box.lo[a] - 1, 0) >> 2;
    hi[a] = std::min(box.hi[a] - 1, extent[a] - 1) >> 2;
  }
  Extent3 at;
  for (at[2] = lo[2]; at[2] <= hi[2]; ++at[2]) {
    for (at[1] = lo[1]; at[1] <= hi[1]; ++at[1]) {
      for (at[0] = lo[0]; at[0] <= hi[0]; ++at[0]) f(at);
    }
  }
}

}  // namespace

BrickEdit::BrickEdit(DepthBricks& bricks, const Extent3& extent, EditedVoxels& voxels)
    : bricks_(bricks),
      palette_(bricks.palette),
      voxels_(voxels),
      dims_(voxels.dims()),
      extent_(extent),
      deepReach_(DistanceWindow::reachOf(palette_, Band::Both)),
      nearReach_(DistanceWindow::reachOf(palette_, Band::Outside)),
      store_(bricks),
      window_(palette_, dims_, EditedVoxels::tileWith(deepReach_, DepthBricks::kEdge), Band::Both),
      near_(palette_, dims_, EditedVoxels::tileWith(nearReach_), Band::Outside),
      one_(palette_, dims_, {5, 5, 5}, Band::Both) {
  readVoxels(voxels);
}

void BrickEdit::readVoxels(EditedVoxels& voxels) {
  forEachBlock({{0, 0, 0}, dims_}, extent_, [&](const Address& block) {
    const std::size_t word = store_.wordOf(block);
    if (!store_.linked(word)) return;
    store_.read(store_.linkAt(word), codes_);
    std::size_t at = 0;
    for (std::int32_t z = 0; z < 5; ++z) {
      for (std::int32_t y = 0; y < 5; ++y) {
        for (std::int32_t x = 0; x < 5; ++x, ++at) {
          if (palette_.value(codes_[at]) > 0.0f) continue;
          const Address v{block[0] * 4 + x, block[1] * 4 + y, block[2] * 4 + z};
          // Beyond the grid its edge goes on.
          if (v[0] < dims_[0] && v[1] < dims_[1] && v[2] < dims_[2])
            voxels.include(v[0], v[1], v[2]);
        }
      }
    }
  });
}

bool BrickEdit::hasVoxels(const Address& block) const noexcept {
  for (std::int32_t k = block[2] * 4; k <= std::min(block[2] * 4 + 4, dims_[2] - 1); ++k) {
    for (std::int32_t j = block[1] * 4; j <= std::min(block[1] * 4 + 4, dims_[1] - 1); ++j) {
      if (bitsAt(voxels_.solid().row(j, k), dims_[0], block[0] * 4, 5) != 0) return true;
    }
  }
  return false;
}

void BrickEdit::edit(const VoxelBox& box, std::uint8_t label) {
  const bool adding = label != 0;
  const VoxelBox band = box.grown(deepReach_, dims_);
  if (adding) {
    // Whole bricks.
    VoxelBox whole;
    for (std::size_t a = 0; a < 3; ++a) {
      whole.lo[a] = std::max(band.lo[a] - 1, 0) & ~3;
      whole.hi[a] = std::min((band.hi[a] - 1) / 4 * 4 + 5, dims_[a]);
    }
    window_.measure(voxels_.solid(), whole, Band::Both);
    forEachBlock(band, extent_, [&](const Address& block) { fill(block); });
    lowerClearances(bricks_, box);
  } else {
    near_.measure(voxels_.solid(), box.grown(nearReach_, dims_), Band::Outside);
    window_.measureTo(voxels_.changed(), box, band);
    forEachBlock(band, extent_, [&](const Address& block) { carve(block, box); });
  }
  if (!store_.labelled()) return;
  forEachBlock(box, extent_, [&](const Address& block) {
    const std::size_t word = store_.wordOf(block);
    if (store_.linked(word)) editLabels(block, word, label);
  });
}

// A brick near removed voxels: depths inside are at most the distance to these.
void BrickEdit::carve(const Address& block, const VoxelBox& box) {
  const std::size_t word = store_.wordOf(block);
  if (!store_.linked(word)) return;
  bool touches = true;  // a corner is in the box
  for (std::size_t a = 0; a < 3; ++a) {
    touches = touches && block[a] * 4 < box.hi[a] && block[a] * 4 + 5 > box.lo[a];
  }
  if (touches && !hasVoxels(block)) return store_.drop(word);
  const std::uint32_t link = store_.linkAt(word);
  const bool shared = store_.shared(link);
  if (!shared) store_.read(link, codes_);
  const VoxelBox& band = window_.box();
  bool some = false;
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    const std::int32_t k = std::min(block[2] * 4 + z, dims_[2] - 1);
    for (std::int32_t y = 0; y < 5; ++y) {
      const std::int32_t j = std::min(block[1] * 4 + y, dims_[1] - 1);
      const std::uint64_t* row = voxels_.solid().row(j, k);
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
  if (shared) measure(block);
  store_.write(block, codes_);
}

// Codes of a brick that are not known, because it was a shared one.
void BrickEdit::measure(const Address& block) {
  VoxelBox corners;
  for (std::size_t a = 0; a < 3; ++a) {
    corners.lo[a] = block[a] * 4;
    corners.hi[a] = std::min(block[a] * 4 + 5, dims_[a]);
  }
  one_.measure(voxels_.solid(), corners, Band::Both);
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    for (std::int32_t y = 0; y < 5; ++y) {
      for (std::int32_t x = 0; x < 5; ++x, ++at) {
        codes_[at] = palette_.codeOf(one_.at(std::min(block[0] * 4 + x, dims_[0] - 1),
                                             std::min(block[1] * 4 + y, dims_[1] - 1),
                                             std::min(block[2] * 4 + z, dims_[2] - 1)));
      }
    }
  }
}

// A brick near added voxels, all of whose corners are in the window.
void BrickEdit::fill(const Address& block) {
  const std::size_t word = store_.wordOf(block);
  const bool linked = store_.linked(word);
  // Depths inside only grow: what was saturated is.
  if (linked && store_.shared(store_.linkAt(word))) return;
  if (!linked && !hasVoxels(block)) return;
  if (linked) store_.read(store_.linkAt(word), codes_);
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
  if (some) store_.write(block, codes_);
}

void BrickEdit::editLabels(const Address& block, std::size_t word, std::uint8_t label) {
  store_.readLabels(word, labels_);
  std::size_t at = 0;
  for (std::int32_t z = 0; z < 5; ++z) {
    for (std::int32_t y = 0; y < 5; ++y) {
      for (std::int32_t x = 0; x < 5; ++x, ++at) {
        const std::int32_t i = std::min(block[0] * 4 + x, dims_[0] - 1);
        const std::int32_t j = std::min(block[1] * 4 + y, dims_[1] - 1);
        const std::int32_t k = std::min(block[2] * 4 + z, dims_[2] - 1);
        if (!voxels_.solid().test(i, j, k)) {
          labels_[at] = 0;
        } else if (voxels_.changed().test(i, j, k)) {
          labels_[at] = label;
        }
      }
    }
  }
  store_.writeLabels(word, labels_);
}

void BrickEdit::reserve(const VoxelBox& box) {
  const VoxelBox items = box.grown({1, 1, 1}, dims_);
  const VoxelBox band = box.grown(deepReach_, dims_).grown({1, 1, 1}, dims_);
  store_.reserve(boxesIn(band, 2), boxesIn(band, 4), boxesIn(items, 2));
}

}  // namespace palpate
