#pragma once
/// DICOM in: the list of what is there, and one series as a volume.

#include "imaging/import.h"

namespace palpate {

[[nodiscard]] Result<SeriesList> listDicomSeries(const std::filesystem::path& path,
                                                 const Progress& progress, bool thumbnails);
[[nodiscard]] Result<ImportedScan> importDicom(const ImportRequest& request,
                                               const Progress& progress);

}  // namespace palpate
