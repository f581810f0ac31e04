#pragma once
/// What a DICOM file, folder or archive holds, for a list.

#include "imaging/import.h"

namespace palpate {

[[nodiscard]] Result<SeriesList> listDicomSeries(const std::filesystem::path& path,
                                                 const Progress& progress, bool thumbnails = false);

}  // namespace palpate
