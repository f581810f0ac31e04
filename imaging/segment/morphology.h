#pragma once
/// Growing and shrinking of a block's planes by a ball, exact, in mm.

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/segment/mask_block.h"

namespace palpate {

/// Part of a tool's progress.
struct Share {
  const Progress& progress;
  double from = 0.0, to = 1.0;
  const char* what = "";

  void at(double fraction) const { progress(from + (to - from) * fraction, what); }
  [[nodiscard]] Share part(double a, double b) const {
    return {progress, from + (to - from) * a, from + (to - from) * b, what};
  }
};

/// Sets plane `to` where a voxel of plane `from` is within `mm` (centre to centre), clears it
/// elsewhere. `from` and `to` differ. Cancelled leaves `to` half done.
[[nodiscard]] Result<void> dilate(MaskBlock& block, std::uint8_t from, std::uint8_t to, double mm,
                                  const Share& share);
/// Sets plane `to` where every voxel of the block within `mm` has plane `from`.
[[nodiscard]] Result<void> erode(MaskBlock& block, std::uint8_t from, std::uint8_t to, double mm,
                                 const Share& share);

/// Slices that a slab of whole slices holds, so that `bytesPerVoxel` stay within its bytes, and
/// at least as many as its borders.
[[nodiscard]] std::int32_t slabSlices(const MaskBlock& block, std::int32_t border,
                                      std::size_t bytesPerVoxel);

}  // namespace palpate
