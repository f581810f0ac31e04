#include "imaging/dicom_toolkit.h"

#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmdata/dcspchrs.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/oflog.h>
#include <iconv.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

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
  // The length as written: getLength() of a text first reads the text.
  return item.findAndGetElement(tag, element).good() && element != nullptr &&
         element->getLengthField() <= kMaxText;
}

std::string trimmed(std::string text) {
  const auto isBlank = [](char c) { return c == ' ' || c == '\0'; };
  while (!text.empty() && isBlank(text.back())) text.pop_back();
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), isBlank));
  return text;
}

/// The whole of `from` in UTF-8, by the C library's converter.
std::optional<std::string> throughIconv(std::string from, const char* encoding) {
  const iconv_t converter = ::iconv_open("UTF-8", encoding);
  if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
  std::string to(from.size() * 4 + 16, '\0');
  char* in = from.data();
  char* out = to.data();
  std::size_t inLeft = from.size();
  std::size_t outLeft = to.size();
  const bool done =
      ::iconv(converter, &in, &inLeft, &out, &outLeft) != static_cast<std::size_t>(-1);
  ::iconv_close(converter);
  if (!done) return std::nullopt;
  to.resize(to.size() - outLeft);
  return to;
}

/// Names that switch between character sets by escapes (PS3.5 6.1.2.5): Debian's DCMTK leaves
/// Japanese and Korean ones to us.
std::optional<std::string> fromEscapes(const std::string& raw, const std::string& charset) {
  if (charset.find("IR 87") != std::string::npos || charset.find("IR 159") != std::string::npos) {
    return throughIconv(raw, "ISO-2022-JP-2");
  }
  if (charset.find("IR 149") != std::string::npos) {
    std::string plain = raw;
    for (std::size_t at = 0; (at = plain.find("\x1B$)C", at)) != std::string::npos;) {
      plain.erase(at, 4);
    }
    return throughIconv(plain, "EUC-KR");
  }
  return std::nullopt;
}

std::string asciiOnly(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) {
        return static_cast<unsigned char>(c) >= 128 || static_cast<unsigned char>(c) < 32;
      },
      '?');
  return text;
}

/// One of several values; empty when there are fewer.
std::string valueOf(const std::string& all, unsigned long position) {
  std::size_t begin = 0;
  for (; position > 0; --position) {
    begin = all.find('\\', begin);
    if (begin == std::string::npos) return {};
    ++begin;
  }
  return trimmed(all.substr(begin, all.find('\\', begin) - begin));
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

std::string dicomCode(DcmItem& item, const DcmTagKey& tag, std::optional<unsigned long> position) {
  std::string text = dicomText(item, tag);
  if (position) text = valueOf(text, *position);
  const bool isCode =
      text.size() <= 16 && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == ' ' || c == '_';
      });
  return isCode ? text : "?";
}

std::string dicomUtf8(DcmItem& item, const DcmTagKey& tag) {
  const std::string raw = dicomText(item, tag);
  const std::string charset = dicomText(item, DCM_SpecificCharacterSet);
  std::string utf8 = asciiOnly(raw);
  DcmSpecificCharacterSet converter;
  OFString converted;
  if (const auto escaped = fromEscapes(raw, charset)) {
    utf8 = *escaped;
  } else if (!charset.empty() &&
             converter.selectCharacterSet(OFString(charset.c_str()), "ISO_IR 192").good() &&
             converter.convertString(OFString(raw.c_str(), raw.size()), converted, "^=").good()) {
    utf8 = trimmed(std::string(converted.c_str(), converted.size()));
  }
  // Empty trailing parts of a name say nothing.
  while (!utf8.empty() && (utf8.back() == '=' || utf8.back() == '^')) utf8.pop_back();
  return utf8;
}

}  // namespace palpate
