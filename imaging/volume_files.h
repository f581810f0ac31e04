#pragma once
/// NIfTI, NRRD and MetaImage through ITK, in LPS, direction kept.
///
/// Values become int16 where every one is, else float32 (a double is rounded to the nearest).
/// Refused, with the reason: several volumes in one file, colour or vector voxels, sheared axes,
/// NaN or infinite voxels, damaged or short files. A left-handed grid keeps every voxel where it
/// is in the patient: its slices are put in the other order.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"
#include "imaging/volume.h"

namespace palpate {

/// By content and extension (.nii, .nii.gz, .nrrd, .nhdr, .mha, .mhd).
/// @param warnings  if given, gets a sentence for each thing the file leaves open.
[[nodiscard]] Result<Volume> readVolumeFile(const std::filesystem::path& file,
                                            std::vector<std::string>* warnings = nullptr);
/// The geometry alone; the voxels are not read, so a file cut short is not noticed.
[[nodiscard]] Result<GridGeometry> readVolumeGeometry(const std::filesystem::path& file);
/// Whole or not at all, read back and compared before it gets its name; format by extension (.mha,
/// .nrrd, .nii, .nii.gz). Only .nii.gz is compressed: grey values shrink by a third and take twenty
/// times as long. A full or unwritable place is ErrorKind::Machine.
[[nodiscard]] Result<void> writeVolumeFile(const Volume& volume, const std::filesystem::path& file);
/// Label volumes: values 0..255, anything else is refused with the first offending value.
[[nodiscard]] Result<LabelGrid> readLabelFile(const std::filesystem::path& file);
/// Compressed: labels shrink a hundredfold.
/// @param texts  keys and texts for the header of a .nrrd file; other formats leave them out.
[[nodiscard]] Result<void> writeLabelFile(
    const LabelGrid& labels, const std::filesystem::path& file,
    const std::vector<std::pair<std::string, std::string>>& texts = {});

}  // namespace palpate
