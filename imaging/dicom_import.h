#pragma once
/// One DICOM series as a volume.

#include "imaging/import.h"

namespace palpate {

[[nodiscard]] Result<ImportedScan> importDicom(const ImportRequest& request,
                                               const Progress& progress);

}  // namespace palpate
