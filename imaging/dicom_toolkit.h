#pragma once
/// DCMTK for our source files: its decoders registered, its log off. Include from .cpp only.

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <optional>
#include <string>

namespace palpate {

/// Call before any use of DCMTK; does its work once. Any thread.
void prepareDicomToolkit();

[[nodiscard]] std::string dicomText(DcmItem& item, const DcmTagKey& tag);
/// A code of capitals and digits (PS3.5, "CS"), to be repeated in messages; "?" when the file holds
/// something else there, which may be a name. Empty when missing. One of several by its position;
/// without, several are not a code.
[[nodiscard]] std::string dicomCode(DcmItem& item, const DcmTagKey& tag,
                                    std::optional<unsigned long> position = {});
/// False when missing or not a finite number.
[[nodiscard]] bool dicomNumber(DcmItem& item, const DcmTagKey& tag, double& value,
                               unsigned long position = 0);
/// A text in the file's character set, as UTF-8; characters that cannot be turned become '?'.
[[nodiscard]] std::string dicomUtf8(DcmItem& item, const DcmTagKey& tag);

}  // namespace palpate
