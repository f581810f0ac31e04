#pragma once
/// The point shell of a voxel body (design: "Between two voxel bodies").

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/collision/point_shell.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// The centres of the body's surface voxels (every non-zero label is solid) in ascending linear
/// order of the grid, in P of the body's grid, metres; normals point out of the body, along the
/// gradient of its signed distance. The shell brings the body's own sphere trees, which
/// QueryMethod::Paper descends. Refuses a body without a solid voxel.
[[nodiscard]] Result<PointShell> shellOfVoxelBody(const LabelGrid& body,
                                                  const Progress& progress = {});

}  // namespace palpate
