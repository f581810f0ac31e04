#pragma once
/// A case: a folder with case.toml, volume.mha, labels.mha, labels.toml, scene.toml, private to the
/// user (0700). 3D Slicer opens all of it.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/voxels/label_grid.h"
#include "imaging/import.h"
#include "imaging/volume.h"

namespace palpate {

/// case.toml.
struct CaseInfo {
  std::string pseudonym, description, modality, sourceFormat;
  std::optional<std::string> patientName, patientId;
  std::vector<std::string> warnings, repairs;
  bool lossy = false;
  GridGeometry geometry;
  VoxelType voxelType = VoxelType::Int16;
  std::string voxelsSha256;
};

/// Writes a new case beside its final name and renames it: it appears whole or not at all. Refused
/// if the folder exists and is not an (over-writable) case or empty. Returns what case.toml says.
[[nodiscard]] Result<CaseInfo> writeNewCase(const std::filesystem::path& folder,
                                            const ImportedScan& scan);

[[nodiscard]] Result<CaseInfo> readCaseInfo(const std::filesystem::path& folder);
[[nodiscard]] Result<Volume> readCaseVolume(const std::filesystem::path& folder);
/// A case without labels is refused with the command that makes them.
[[nodiscard]] Result<LabelState> readCaseLabelState(const std::filesystem::path& folder);
[[nodiscard]] Result<LabelGrid> readCaseLabels(const std::filesystem::path& folder);
[[nodiscard]] Result<LabelTable> readCaseLabelTable(const std::filesystem::path& folder);
[[nodiscard]] bool caseHasLabels(const std::filesystem::path& folder);
/// Both files replaced together, each whole or not at all.
[[nodiscard]] Result<void> writeCaseLabels(const std::filesystem::path& folder,
                                           const LabelGrid& labels, const LabelTable& table);

}  // namespace palpate
