#pragma once
/// Exact distances from some voxels of a box to the nearest of others, without a distance field of
/// the whole box in memory.
///
/// Separable squared distances: Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled
/// Functions", 2012. Departure: the first axis is not a pass over a stored field. A few slices at a
/// time are given, for each column, the next set voxel below and above; the other two axes then
/// need one slice only. A float field of 512 x 512 x 800 would be 0.8 GiB (itk::SignedMaurer holds
/// two), a k-d tree of its 10 to 20 million surface voxels about 0.5 GiB; this is 32 MiB.

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"

namespace palpate {

/// A byte a voxel, x fastest; what the bits mean is the caller's.
struct BitBox {
  std::array<std::int32_t, 3> dims{0, 0, 0};
  std::array<double, 3> spacing_mm{1.0, 1.0, 1.0};
  std::vector<std::uint8_t> bits;
};

/// For each voxel with bit `from`, in the order of the voxels, the distance in mm from its centre
/// to the nearest with bit `to`. At least one voxel must have `to` (asserted). `progress` is told
/// fractions 0 to 1; Cancelled when asked to stop. Uses TBB's workers.
[[nodiscard]] Result<std::vector<float>> nearestDistances_mm(const BitBox& box, std::uint8_t from,
                                                             std::uint8_t to,
                                                             const Progress& progress);

}  // namespace palpate
