#pragma once
/// Which stack of a scan an import means, or why none.

#include "imaging/dicom_scan.h"
#include "imaging/dicom_stack.h"
#include "imaging/import.h"

namespace palpate {

/// One rule, with a series' UID and without: of what is asked for and can be a volume (perhaps with
/// a repair), the only one that is no scout and no single image beside a stack. Otherwise the
/// choice is the user's, and the refusal lists what there is. Points into `stacks`.
[[nodiscard]] Result<const DicomStack*> chooseStack(const std::vector<DicomStack>& stacks,
                                                    const DicomScan& scan,
                                                    const ImportRequest& request);
/// Of a path without any DICOM image.
[[nodiscard]] Error nothingThere(const std::filesystem::path& path, const DicomScan& scan);

}  // namespace palpate
