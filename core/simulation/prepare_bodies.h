#pragma once
/// The loose bodies of a scene, made ready to run. A part of prepareScene().

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/approach.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// The values of the labels that move. Refuses a label that the table does not have.
[[nodiscard]] Result<FeltLabels> bodyLabels(const Scene& scene, const LabelTable& table);

/// Fills `prepared.bodies`; its labels, table and materials are there already. Refuses a body
/// without a voxel, and more bodies than kMostBodies.
[[nodiscard]] Result<void> prepareBodies(PreparedScene& prepared, const Progress& progress);

/// What a surface of `material` meets, by the label's material.
[[nodiscard]] SurfaceTable surfaceOf(const PreparedScene& prepared, const std::string& material);

}  // namespace palpate
