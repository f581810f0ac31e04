#pragma once
/// Exact distances from some voxels of a block to the nearest of others, without a distance field
/// of the whole block in memory.
///
/// Separable squared distances: Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled
/// Functions", 2012. Departure: the first axis is not a pass over a stored field. A few slices at a
/// time are given, for each column, the next set voxel below and above; the other two axes then
/// need one slice only. A float field of 512 x 512 x 800 would be 0.8 GiB (itk::SignedMaurer holds
/// two), a k-d tree of its 10 to 20 million surface voxels about 0.5 GiB; this is 32 MiB.

#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "imaging/segment/mask_block.h"
#include "imaging/segment/morphology.h"

namespace palpate {

/// For each voxel with plane `from`, in the order of the voxels, the distance in mm from its centre
/// to the nearest with plane `to`. At least one voxel must have `to` (asserted). Cancelled when
/// asked to stop. Uses TBB's workers.
[[nodiscard]] Result<std::vector<float>> nearestDistances_mm(const MaskBlock& block,
                                                             std::uint8_t from, std::uint8_t to,
                                                             const Share& share);

}  // namespace palpate
