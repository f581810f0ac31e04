#pragma once
/// How far two masks on one grid agree: shares of volume, and distances between their surfaces.
///
/// The surface of a mask is made of its voxels with one of six neighbours outside it. Beyond the
/// scan counts as outside, so that every mask with a voxel has a surface; where both masks are cut
/// by the scan's edge, the cut faces count as surface of both. Distances are between centres of
/// surface voxels, so that masks which differ by one layer are one spacing apart, and equal masks
/// 0.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// The voxels of a label volume that count as solid. The grid belongs to the caller.
struct MaskOfLabels {
  const LabelGrid& grid;
  std::optional<std::uint8_t> value;  ///< Empty: all but background.
};

/// Of many distances, millimetres. Percentiles between two of them are interpolated linearly.
struct DistanceSummary {
  double mean = 0.0, median = 0.0;
  double p95 = 0.0;    ///< 95 % are no farther.
  double worst = 0.0;  ///< The farthest.
};

struct SurfaceAgreement {
  std::array<std::size_t, 2> voxels{0, 0};  ///< On the surfaces of a and b.
  DistanceSummary aToB;                     ///< From each surface voxel of a to the nearest of b.
  DistanceSummary bToA;
  /// Mean and median over both ways together; p95 and worst (Hausdorff) are the larger of the two.
  DistanceSummary symmetric;
};

struct Agreement {
  std::array<std::size_t, 2> voxels{0, 0};
  std::array<double, 2> mm3{0.0, 0.0};
  std::size_t common = 0;                   ///< Voxels in both.
  double dice = 0.0;                        ///< 2 common / (a + b).
  double jaccard = 0.0;                     ///< common / (a or b).
  std::optional<SurfaceAgreement> surface;  ///< Empty where a or b has no voxel.
};

/// Refuses (InputRefused) grids of different counts or more than 0.001 mm apart, and two masks
/// without a voxel. Progress and cancel. Any thread; uses TBB's workers; same masks, same bits,
/// whatever their number.
///
/// Memory beside the masks: a byte a voxel of the box around both, 12 bytes a surface voxel, 32
/// MiB, and 8 bytes a voxel of one slice for each worker. For 512 x 512 x 800 that is 0.25 GiB and
/// the surfaces, less than the scan itself (0.4 GiB).
[[nodiscard]] Result<Agreement> compareMasks(const MaskOfLabels& a, const MaskOfLabels& b,
                                             const Progress& progress = {});

}  // namespace palpate
