#pragma once
/// The geometry of a volume as the commands print it: millimetres, DICOM LPS.

#include <nlohmann/json.hpp>
#include <string>

#include "core/geometry/grid_geometry.h"

namespace palpate {

/// dims[3], spacing_mm[3], origin_mm[3], direction[9] (the three unit axes, column after column).
void addGridFields(nlohmann::ordered_json& json, const GridGeometry& geometry);
/// The same fields, null: for what has no geometry that could be trusted.
void addNullGridFields(nlohmann::ordered_json& json);
/// "256 × 256 × 108 voxels of 0.957 × 0.957 × 1.500 mm".
[[nodiscard]] std::string gridSentence(const GridGeometry& geometry);

}  // namespace palpate
