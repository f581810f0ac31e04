#pragma once
/// What a click beside a label means: the label's voxel that is nearest.

#include <Eigen/Core>
#include <optional>

#include "core/voxels/label_grid.h"

namespace palpate {

/// Centre, P mm, of the label's voxel nearest to a point, within `reach_mm`; of equally near ones
/// the first in the order of the voxels. Any thread.
[[nodiscard]] std::optional<Eigen::Vector3d> nearestOf(const LabelGrid& labels, std::uint8_t value,
                                                       const Eigen::Vector3d& p_mm,
                                                       double reach_mm);

}  // namespace palpate
