#pragma once
/// The voxels of a tree that is edited in place: which are inside, and which of them the edit at
/// work changes. Internal to TreeEditor.
///
/// Two bits a voxel of the grid, taken once; an edit takes no memory. Addresses are voxels of the
/// label grid. One thread, that of the editor.
///
/// An edit: mark() its voxels (solid() is then as it will be), look at the changes box by box with
/// forEachTile(), and forget() them.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/voxels/voxel_box.h"

namespace palpate {

class EditedVoxels {
 public:
  /// Edge of a box of changes that is done at a time, voxels. A row of it is a word of 32 bits
  /// (forEachTile()). Windows of distances are as large as it and what lies around.
  static constexpr std::int32_t kTile = 32;
  /// The size of such a box with so many voxels around it, and so many more.
  [[nodiscard]] static constexpr Extent3 tileWith(const Extent3& reach,
                                                  std::int32_t more = 0) noexcept {
    const std::int32_t edge = kTile + 2 * more;
    return {edge + 2 * reach[0], edge + 2 * reach[1], edge + 2 * reach[2]};
  }

  /// No voxel is inside yet: whoever reads the tree says which are, with include().
  explicit EditedVoxels(const Extent3& dims) : dims_(dims), solid_(dims), changed_(dims) {}
  void include(std::int32_t i, std::int32_t j, std::int32_t k) noexcept { solid_.set(i, j, k); }

  [[nodiscard]] const Extent3& dims() const noexcept { return dims_; }
  /// Those inside; after mark(), as edited.
  [[nodiscard]] const VoxelBits& solid() const noexcept { return solid_; }
  [[nodiscard]] const VoxelBits& changed() const noexcept { return changed_; }
  /// How many mark() found to change.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

  /// Puts voxels, which are in the grid, inside (`adding`) or outside; those that are there already
  /// or given twice count once. False, and solid() as before, where all `solidVoxels` of the tree
  /// would go. Either way changes are to be forgotten before the next call.
  bool mark(std::span<const Extent3> voxels, bool adding, std::size_t solidVoxels) noexcept;
  void forget() noexcept;

  /// By how much the number of surface voxels changes (VoxelTree's stats). Call where count() > 0.
  [[nodiscard]] std::ptrdiff_t surfaceChange() const noexcept;

  /// Calls f(box) for boxes of at most kTile³ voxels that have all changes, each as small as it can
  /// be.
  template <class F>
  void forEachTile(F&& f) const;

 private:
  Extent3 dims_;
  VoxelBits solid_, changed_;
  VoxelBox box_;  // around all changes
  std::size_t count_ = 0;
};

template <class F>
void EditedVoxels::forEachTile(F&& f) const {
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
        tight.hi[0] = x + kTile - std::countl_zero(any);
        f(tight);
      }
    }
  }
}

}  // namespace palpate
