#pragma once
/// The parts of a label that move by themselves, each cut out into a grid of its own.

#include <cstdint>
#include <vector>

#include "core/scene/scene.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Voxels of `value`, connected by faces, edges or corners (or all as one part where the body is
/// not to be separated), in the order of their first voxel; parts below the least volume are left
/// out. Each with a margin of two voxels, its pose in P as in the grid. Not for the loops.
[[nodiscard]] std::vector<LabelGrid> looseParts(const LabelGrid& grid, std::uint8_t value,
                                                const SceneBody& body);

}  // namespace palpate
