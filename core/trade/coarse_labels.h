#pragma once
/// The anatomy at a coarser resolution.

#include "core/voxels/label_grid.h"

namespace palpate {

/// Joins `factor` voxels along each axis. A joined voxel has the commonest label of those in it
/// (ties: the lower value), and none where less than half of them have one.
[[nodiscard]] LabelGrid coarseLabels(const LabelGrid& grid, int factor);

}  // namespace palpate
