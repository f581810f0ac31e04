#pragma once
/// NIfTI, NRRD and MetaImage through ITK, in LPS, direction kept.

#include <filesystem>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"
#include "imaging/volume.h"

namespace palpate {

/// By content and extension (.nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd).
[[nodiscard]] Result<Volume> readVolumeFile(const std::filesystem::path& file);
/// Whole or not at all; format by extension (.mha, .nrrd, .nii.gz ...). Compressed.
[[nodiscard]] Result<void> writeVolumeFile(const Volume& volume, const std::filesystem::path& file);
/// Label volumes: values 0..255, anything else is refused with the first offending value.
[[nodiscard]] Result<LabelGrid> readLabelFile(const std::filesystem::path& file);
[[nodiscard]] Result<void> writeLabelFile(const LabelGrid& labels,
                                          const std::filesystem::path& file);

}  // namespace palpate
