#pragma once
/// The distance leaf model of the design, straight from its definition: no tree, no bricks, no
/// single precision. Every voxel's distance is looked for among its neighbours, the nearest first.

#include <array>
#include <memory>

#include "core/trade/reference_shape.h"

namespace palpate {

/// @param grid  kept; W = P.
/// @param felt  which label values are anatomy.
/// @param reach_mm  depths beyond are cut there; what is felt is far shallower.
[[nodiscard]] std::unique_ptr<ReferenceShape> gridReference(std::shared_ptr<const LabelGrid> grid,
                                                            const std::array<bool, 256>& felt,
                                                            double reach_mm = 6.0);

}  // namespace palpate
