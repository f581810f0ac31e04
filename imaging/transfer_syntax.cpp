#include "imaging/transfer_syntax.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "imaging/dicom_toolkit.h"

namespace palpate {
namespace {

struct Row {
  std::string_view uid;
  TransferSyntax syntax;
};

constexpr std::array<Row, 15> kTable{{
    {"1.2.840.10008.1.2", {PixelCoding::Native}},
    {"1.2.840.10008.1.2.1", {PixelCoding::Native}},
    {"1.2.840.10008.1.2.2", {PixelCoding::Native, false, true}},
    {"1.2.840.10008.1.2.1.99", {PixelCoding::Deflated}},
    {"1.2.840.10008.1.2.5", {PixelCoding::Rle}},
    {"1.2.840.10008.1.2.4.50", {PixelCoding::Jpeg, true}},  // baseline
    {"1.2.840.10008.1.2.4.51", {PixelCoding::Jpeg, true}},  // extended
    {"1.2.840.10008.1.2.4.53", {PixelCoding::Jpeg, true}},  // spectral selection, retired
    {"1.2.840.10008.1.2.4.55", {PixelCoding::Jpeg, true}},  // progressive, retired
    {"1.2.840.10008.1.2.4.57", {PixelCoding::Jpeg}},        // lossless
    {"1.2.840.10008.1.2.4.70", {PixelCoding::Jpeg}},        // lossless, first-order prediction
    {"1.2.840.10008.1.2.4.80", {PixelCoding::JpegLs}},
    {"1.2.840.10008.1.2.4.81", {PixelCoding::JpegLs, true}},
    {"1.2.840.10008.1.2.4.90", {PixelCoding::Jpeg2000}},
    {"1.2.840.10008.1.2.4.91", {PixelCoding::Jpeg2000}},
}};

}  // namespace

TransferSyntax transferSyntaxOf(const std::string& uid) {
  const auto row =
      std::find_if(kTable.begin(), kTable.end(), [&uid](const Row& r) { return r.uid == uid; });
  return row != kTable.end() ? row->syntax : TransferSyntax{};
}

std::string transferSyntaxName(const std::string& uid) {
  const DcmXfer syntax(uid.c_str());
  if (syntax.getXfer() != EXS_Unknown) return syntax.getXferName();
  // A damaged file may hold anything there, a name too.
  const bool isUid = uid.size() <= 64 && uid.find_first_not_of("0123456789.") == std::string::npos;
  return isUid ? uid : "unknown transfer syntax";
}

}  // namespace palpate
