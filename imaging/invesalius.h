#pragma once
/// InVesalius projects (.inv3): a gzipped tar with main.plist and the voxels in matrix.dat.
///
/// The project stores int16 values, rows from posterior to anterior (flipped here), and no position
/// in the patient: the volume is centred on the origin, and a warning says so.

#include <filesystem>

#include "core/base/error.h"
#include "imaging/import.h"

namespace palpate {

[[nodiscard]] bool isInvesaliusProject(const std::filesystem::path& file);
/// The geometry alone, from main.plist.
[[nodiscard]] Result<SeriesInfo> describeInvesalius(const std::filesystem::path& file);
/// Fills volume, format, warnings. The project's name is left out: it may be the patient's.
[[nodiscard]] Result<ImportedScan> readInvesalius(const std::filesystem::path& file);

}  // namespace palpate
