#include "core/voxels/edited_voxels.h"

namespace palpate {

bool EditedVoxels::mark(std::span<const Extent3> voxels, bool adding,
                        std::size_t solidVoxels) noexcept {
  box_ = {dims_, {0, 0, 0}};
  count_ = 0;
  for (const Extent3& v : voxels) {
    std::uint64_t& word = solid_.row(v[1], v[2])[v[0] >> 6];
    const std::uint64_t bit = std::uint64_t{1} << (v[0] & 63);
    if (((word & bit) != 0) == adding) continue;
    word ^= bit;
    changed_.row(v[1], v[2])[v[0] >> 6] |= bit;
    box_.include(v);
    ++count_;
  }
  if (adding || count_ < solidVoxels) return true;
  for (std::int32_t k = box_.lo[2]; k < box_.hi[2]; ++k) {
    for (std::int32_t j = box_.lo[1]; j < box_.hi[1]; ++j) {
      for (std::size_t w = 0; w < solid_.rowWords; ++w)
        solid_.row(j, k)[w] |= changed_.row(j, k)[w];
    }
  }
  return false;
}

void EditedVoxels::forget() noexcept {
  for (std::int32_t k = box_.lo[2]; k < box_.hi[2]; ++k) {
    for (std::int32_t j = box_.lo[1]; j < box_.hi[1]; ++j) {
      std::fill(changed_.row(j, k) + (box_.lo[0] >> 6),
                changed_.row(j, k) + ((box_.hi[0] - 1) >> 6) + 1, 0);
    }
  }
}

// Surface voxels are those of the changes and next to them that were and that are: by rows.
std::ptrdiff_t EditedVoxels::surfaceChange() const noexcept {
  const VoxelBox around = box_.grown({1, 1, 1}, dims_);
  const auto words = static_cast<std::int32_t>(solid_.rowWords);
  const std::int32_t firstWord = around.lo[0] >> 6;
  const std::int32_t lastWord = (around.hi[0] - 1) >> 6;
  const auto wordOf = [&](std::int32_t w, std::int32_t j, std::int32_t k, bool edited) {
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
          const std::uint64_t at = wordOf(w, j, k, edited);
          const std::uint64_t left = at << 1 | wordOf(w - 1, j, k, edited) >> 63;
          const std::uint64_t right = at >> 1 | wordOf(w + 1, j, k, edited) << 63;
          const std::uint64_t open =
              at & ~(left & right & wordOf(w, j - 1, k, edited) & wordOf(w, j + 1, k, edited) &
                     wordOf(w, j, k - 1, edited) & wordOf(w, j, k + 1, edited));
          more += edited ? std::popcount(open) : -std::popcount(open);
        }
      }
    }
  }
  return more;
}

}  // namespace palpate
