#pragma once
/// Finds the DICOM images in a file, a folder, beside a DICOMDIR, or in an archive; and whether all
/// are there that a DICOMDIR among them lists.

#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "imaging/archive.h"
#include "imaging/dicom_header.h"

namespace palpate {

struct DicomScan {
  std::vector<DicomFile> files;           ///< In the order of their paths.
  std::size_t skipped = 0;                ///< Files that are not DICOM objects.
  std::vector<std::string> warnings;      ///< What a DICOMDIR lists and is not there.
  std::optional<PrivateFolder> unpacked;  ///< Where an archive's members lie, while this lives.
};

/// Names and endings mean nothing; links are not followed into other folders. Headers are read on
/// all cores. An empty result is not an error here.
[[nodiscard]] Result<DicomScan> scanDicom(const std::filesystem::path& path,
                                          const Progress& progress = {});

}  // namespace palpate
