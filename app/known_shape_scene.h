#pragma once
/// A known shape as a scene: what `tradeoff --shape` measures.

#include <filesystem>
#include <memory>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/reference_shape.h"

namespace palpate {

/// The default scene on the shape's voxels, the device over its top. @param spacing  m.
[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> knownShapeScene(
    KnownShape shape, double spacing, const std::filesystem::path& datasets,
    const Progress& progress);

}  // namespace palpate
