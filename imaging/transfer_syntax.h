#pragma once
/// DICOM's ways to write pixels (PS3.5 annex A), as far as Palpate knows them: one table.

#include <cstdint>
#include <string>

namespace palpate {

enum class PixelCoding : std::uint8_t { Unknown, Native, Deflated, Rle, Jpeg, JpegLs, Jpeg2000 };

struct TransferSyntax {
  PixelCoding coding = PixelCoding::Unknown;
  bool lossy = false;  ///< By its definition; JPEG 2000 may be either, and says so in its stream.
  bool bigEndian = false;
};

/// Unknown, and nothing else, for another UID.
[[nodiscard]] TransferSyntax transferSyntaxOf(const std::string& uid);
/// "JPEG 2000 (lossless only)"; the UID itself when unknown, if it is one.
[[nodiscard]] std::string transferSyntaxName(const std::string& uid);

}  // namespace palpate
