#include "imaging/dicom_toolkit.h"

#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmdata/dcspchrs.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/oflog.h>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace palpate {

void prepareDicomToolkit() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);
    DcmRLEDecoderRegistration::registerCodecs();
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
    (void)dcmDataDict.isDictionaryLoaded();
  });
}

namespace {

// No text that we read is longer; a damaged length must not cost memory.
constexpr Uint32 kMaxText = 1U << 16U;

bool isShort(DcmItem& item, const DcmTagKey& tag) {
  DcmElement* element = nullptr;
  return item.findAndGetElement(tag, element).good() && element != nullptr &&
         element->getLength() <= kMaxText;
}

std::string trimmed(std::string text) {
  const auto isBlank = [](char c) { return c == ' ' || c == '\0'; };
  while (!text.empty() && isBlank(text.back())) text.pop_back();
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), isBlank));
  return text;
}

}  // namespace

std::string dicomText(DcmItem& item, const DcmTagKey& tag) {
  OFString text;
  if (!isShort(item, tag) || item.findAndGetOFStringArray(tag, text).bad()) return {};
  return trimmed(std::string(text.c_str(), text.size()));
}

bool dicomNumber(DcmItem& item, const DcmTagKey& tag, double& value, unsigned long position) {
  if (!isShort(item, tag)) return false;
  Float64 number = 0.0;
  if (item.findAndGetFloat64(tag, number, position).bad()) {
    // DCMTK gives decimals and floats as such; integers (US, SS, IS ...) only as their own types or
    // as text, which all have.
    OFString text;
    if (item.findAndGetOFString(tag, text, position).bad()) return false;
    const std::string digits = trimmed(std::string(text.c_str(), text.size()));
    OFBool good = OFFalse;
    number = OFStandard::atof(digits.c_str(), &good);
    if (!good || digits.find_first_not_of("+-0123456789.eE") != std::string::npos) return false;
  }
  if (!std::isfinite(number)) return false;
  value = number;
  return true;
}

std::string dicomUtf8(DcmItem& item, const DcmTagKey& tag) {
  const std::string raw = dicomText(item, tag);
  const std::string charset = dicomText(item, DCM_SpecificCharacterSet);
  DcmSpecificCharacterSet converter;
  OFString converted;
  if (!charset.empty() &&
      converter.selectCharacterSet(OFString(charset.c_str()), "ISO_IR 192").good() &&
      converter.convertString(OFString(raw.c_str(), raw.size()), converted, "^=").good()) {
    return trimmed(std::string(converted.c_str(), converted.size()));
  }
  std::string ascii = raw;
  std::replace_if(
      ascii.begin(), ascii.end(), [](char c) { return static_cast<unsigned char>(c) >= 128; }, '?');
  return ascii;
}

}  // namespace palpate
