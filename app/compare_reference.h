#pragma once
/// What a label is compared with: read from whatever a user has.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

struct ReferenceRequest {
  std::filesystem::path path;        ///< A label volume, an InVesalius project or a case's folder.
  std::optional<std::string> label;  ///< As given; empty: the default of the kind.
  std::string comparedLabel;         ///< The label it is a reference for.
  GridGeometry geometry;             ///< The grid it is compared on.
};

struct Reference {
  LabelGrid grid;
  std::optional<std::uint8_t> value;  ///< Of the voxels that count; empty: all but background.
  std::string name;  ///< As asked for, never from the file: "bone", "3", "non-zero", "mask 1".
  std::vector<std::string> warnings;
};

/// - A case's folder: its label of that name (default: of the compared label's name).
/// - An .inv3: its mask of that name or number, counted from 1 (default: the first). The format
///   stores no position, so a project of the same counts and spacing lies where the case lies, with
///   a warning where its own place would be another.
/// - NIfTI, NRRD, MetaImage: the voxels of that value, 1 to 255 (default: all but 0).
/// Refuses what is none of these or lacks the label, by file and field. The grid is the file's own:
/// whether it fits is the comparison's to say.
[[nodiscard]] Result<Reference> readReference(const ReferenceRequest& request);

}  // namespace palpate
