#pragma once
/// The real head CT of Debian's invesalius-examples as a world, at any resolution.

#include <optional>

#include "core/voxels/label_grid.h"

namespace palpate::bench {

/// Bone (300 HU and more), the CT interpolated to cubic voxels of `spacing` metres. The file is
/// $PALPATE_DEMO_SCAN or where Debian installs it; nothing where it is absent or not that file.
[[nodiscard]] std::optional<LabelGrid> skull(double spacing);

}  // namespace palpate::bench
