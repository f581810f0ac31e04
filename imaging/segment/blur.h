#pragma once
/// A Gaussian blur of a block's plane, cut at one half.

#include "core/base/error.h"
#include "imaging/segment/mask_block.h"
#include "imaging/segment/morphology.h"

namespace palpate {

/// Sets plane `to` where the blurred plane `from` (standard deviation `mm`, kernel of three of
/// them, renormalised at the block's sides) is above one half, clears it elsewhere. The planes
/// differ. By VTK (vtkImageGaussianSmooth), in slabs.
[[nodiscard]] Result<void> blurAndCut(MaskBlock& block, std::uint8_t from, std::uint8_t to,
                                      double mm, const Share& share);
/// How far the kernel reaches, mm.
[[nodiscard]] inline double blurReach_mm(double mm) {
  return 3.0 * mm;
}

}  // namespace palpate
