#pragma once
/// The segments of a DICOM segmentation as labels on a case's grid.

#include <filesystem>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/exchange/found_labels.h"

namespace palpate {

/// Segments become labels 1, 2, ... in the file's order; where two hold a voxel the later wins,
/// with a warning that counts such voxels. FRACTIONAL: from one half up, with a warning. Refused:
/// what readSegFile() and fitToGrid() refuse.
[[nodiscard]] Result<FoundLabels> readDicomSeg(const std::filesystem::path& file,
                                               const GridGeometry& geometry,
                                               const Progress& progress = {});

}  // namespace palpate
