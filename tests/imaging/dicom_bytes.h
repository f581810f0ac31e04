#pragma once
/// DICOM files byte by byte, for tests of files that no toolkit would write. Little-endian.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::test {

inline constexpr const char* kImplicitVr = "1.2.840.10008.1.2";
inline constexpr const char* kExplicitVr = "1.2.840.10008.1.2.1";
inline constexpr const char* kDeflated = "1.2.840.10008.1.2.1.99";
inline constexpr const char* kRle = "1.2.840.10008.1.2.5";
inline constexpr const char* kJpegBaseline = "1.2.840.10008.1.2.4.50";
inline constexpr const char* kJpegLossless = "1.2.840.10008.1.2.4.70";
inline constexpr const char* kJpegLs = "1.2.840.10008.1.2.4.80";
inline constexpr const char* kJpeg2000 = "1.2.840.10008.1.2.4.90";
inline constexpr std::uint32_t kUndefinedLength = 0xFFFFFFFF;

inline std::string little(std::uint64_t value, int bytes) {
  std::string text;
  for (int b = 0; b < bytes; ++b) text.push_back(static_cast<char>(value >> (8 * b)));
  return text;
}

inline std::string tagBytes(std::uint32_t tag) {
  return little(tag >> 16U, 2) + little(tag & 0xFFFFU, 2);
}

/// The head of an element with any length, true or not.
inline std::string elementHead(std::uint32_t tag, const std::string& vr, std::uint32_t length) {
  const bool isLong = vr == "OB" || vr == "OW" || vr == "SQ" || vr == "UN" || vr == "UT";
  return tagBytes(tag) + vr + (isLong ? little(0, 2) + little(length, 4) : little(length, 2));
}

inline std::string element(std::uint32_t tag, const std::string& vr, std::string value) {
  if (value.size() % 2 != 0) value.push_back(vr == "OB" || vr == "UI" ? '\0' : ' ');
  return elementHead(tag, vr, static_cast<std::uint32_t>(value.size())) + value;
}

inline std::string number16(std::uint32_t tag, std::uint32_t value) {
  return element(tag, "US", little(value, 2));
}

inline std::string item(const std::string& value) {
  return tagBytes(0xFFFEE000) + little(value.size(), 4) + value;
}

inline std::string sequenceEnd() {
  return tagBytes(0xFFFEE0DD) + little(0, 4);
}

inline std::string sequence(std::uint32_t tag, const std::vector<std::string>& items) {
  std::string value;
  for (const std::string& i : items) value += item(i);
  return element(tag, "SQ", value);
}

/// Compressed pixels: an empty table of offsets, then a fragment each.
inline std::string encapsulated(const std::vector<std::string>& fragments) {
  std::string bytes = elementHead(0x7FE00010, "OB", kUndefinedLength) + item("");
  for (std::string f : fragments) {
    if (f.size() % 2 != 0) f.push_back('\0');
    bytes += item(f);
  }
  return bytes + sequenceEnd();
}

/// Preamble, group 2, and a data set that is in this transfer syntax already.
inline std::string part10(const std::string& syntax, const std::string& dataset) {
  const std::string meta = element(0x00020002, "UI", "1.2.840.10008.5.1.4.1.1.2") +
                           element(0x00020003, "UI", "2.25.1001.1") +
                           element(0x00020010, "UI", syntax);
  return std::string(128, '\0') + "DICM" + element(0x00020000, "UL", little(meta.size(), 4)) +
         meta + dataset;
}

/// What a small CT image says, in order of tags; parts that a test needs to be wrong are replaced.
struct DicomBytes {
  std::string patientName = "quince^medlar";
  std::string beforePatient;  ///< Elements between group 8's and the patient's.
  std::string frameCount;     ///< NumberOfFrames; left out when empty.
  std::uint32_t rows = 8, columns = 8, bitsAllocated = 16, bitsStored = 16;
  std::uint32_t isSigned = 0;
  std::string position = "0\\0\\0";
  bool ownGeometry = true;  ///< Position, orientation and spacing in the data set itself.
  std::string beforePixels;
  std::string pixels;  ///< The whole element of the pixels.

  [[nodiscard]] std::string dataset() const {
    std::string d = element(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2") +
                    element(0x00080018, "UI", "2.25.1001.1") + element(0x00080060, "CS", "CT") +
                    beforePatient + element(0x00100010, "PN", patientName) +
                    element(0x0020000D, "UI", "2.25.1000") + element(0x0020000E, "UI", "2.25.1001");
    if (ownGeometry) {
      d += element(0x00200032, "DS", position) + element(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
    }
    d += number16(0x00280002, 1) + element(0x00280004, "CS", "MONOCHROME2");
    if (!frameCount.empty()) d += element(0x00280008, "IS", frameCount);
    d += number16(0x00280010, rows) + number16(0x00280011, columns);
    if (ownGeometry) d += element(0x00280030, "DS", "0.5\\0.5");
    d += number16(0x00280100, bitsAllocated) + number16(0x00280101, bitsStored) +
         number16(0x00280102, bitsStored - 1) + number16(0x00280103, isSigned);
    return d + beforePixels + pixels;
  }
  [[nodiscard]] std::string file(const std::string& syntax = kExplicitVr) const {
    return part10(syntax, dataset());
  }
};

/// Pixels as they are, `bytes` of them, counting up.
inline std::string plainPixels(std::size_t bytes, const std::string& vr = "OW") {
  std::string value;
  for (std::size_t i = 0; i < bytes; ++i) value.push_back(static_cast<char>(i * 7));
  return element(0x7FE00010, vr, value);
}

}  // namespace palpate::test
