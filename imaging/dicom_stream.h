#pragma once
/// DICOM files into DCMTK, within limits that it does not set itself: how deep sequences lie in
/// each other, and how far a deflated data set inflates. Include from .cpp only (DCMTK).

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate {

struct DicomParse {
  OFCondition condition;
  /// Which limit stopped it, as the end of a sentence; empty when none did.
  std::string limit;
  /// Bytes of the file before the place where reading ended; 0 in a deflated one.
  std::uint64_t end = 0;
  [[nodiscard]] bool complete() const { return condition.good() && limit.empty(); }
};

/// Reads up to `stop`, or all of the file. Any thread.
[[nodiscard]] DicomParse parseDicom(DcmFileFormat& format, const std::filesystem::path& file,
                                    const DcmTagKey& stop = DCM_UndefinedTagKey);

}  // namespace palpate
