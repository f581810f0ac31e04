#pragma once
/// What one DICOM file says about its images, as plain values.
///
/// DCMTK stays in the source files. Its log is off: it would repeat names and identifiers.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Where a frame lies and what its numbers mean. Millimetres, LPS, as written in the file.
struct DicomFrame {
  std::uint32_t number = 0;  ///< In its file, from 0.
  bool hasPosition = false, hasOrientation = false, hasSpacing = false;
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d row = Eigen::Vector3d::Zero(), column = Eigen::Vector3d::Zero();
  Eigen::Vector2d spacing_mm = Eigen::Vector2d::Zero();  ///< Along row, along column.
  double slope = 1.0, intercept = 0.0;
  std::string rescaleType;    ///< The unit, "HU"; empty when not said.
  double thickness_mm = 0.0;  ///< 0 when not said.
  /// What tells images of one place apart: time, echo, b-value ..., in the order of kPhaseNames.
  std::vector<std::string> phase;
};

/// The names of DicomFrame::phase, for people.
extern const std::array<const char*, 8> kPhaseNames;

/// Why a file or a stack of images is no volume, and where that is written.
struct DicomProblem {
  std::string reason = {};  ///< The end of a sentence: "its rescale slope is zero". Empty: none.
  std::string field = {};   ///< Attributes by DICOM's keywords; empty where no one is to blame.
  std::string found = {}, expected = {};
  [[nodiscard]] bool empty() const { return reason.empty(); }
};

struct DicomFile {
  std::filesystem::path path;
  std::string name;  ///< For people, from the scan: the last part of its path, also in an archive.
  std::uintmax_t bytes = 0;
  std::string seriesUid, instanceUid, modality, description;
  std::string studyUid, studyDate;
  std::string patientName, patientId;  ///< UTF-8. Never stored or logged.
  std::string transferSyntax;          ///< UID
  std::string photometric;
  std::uint32_t rows = 0, columns = 0, samples = 1;
  std::uint32_t bitsAllocated = 0, bitsStored = 0, highBit = 0;
  bool isSigned = false;
  std::string imageKind;   ///< ImageType from its third value on: "AXIAL", "PERFUSION RCBF".
  bool localizer = false;  ///< The scanner says that it is a scout.
  bool mosaic = false;     ///< Many slices side by side in one image (Siemens).
  bool lossy = false;
  bool modalityLut = false;
  std::vector<DicomFrame> frames;
  bool damaged = false;  ///< The file ends early or is not what DICOM allows.
  DicomProblem problem;  ///< Why there is no grey image to read; empty when there is.
};

/// The reason of a file that should hold an image but ends early.
inline constexpr const char* kDamagedFile = "it is damaged or cut short";

/// JPEG-LS and JPEG 2000 know no least size of an empty image, and decoders ask for memory by the
/// stated size. Images of anatomy have up to 30 pixels a byte; so many are accepted, and an empty
/// image of 4096 x 4096 whatever its bytes.
inline constexpr std::uint64_t kMaxPixelsPerByte = 256, kFreePixels = std::uint64_t{1} << 24U;

/// Whether a CT's header says that its numbers are other than Hounsfield units: another unit, or a
/// map of perfusion. Most headers of plain CT say nothing.
[[nodiscard]] bool isOtherThanHounsfield(const DicomFile& file, const DicomFrame& frame);
/// Looks at the first bytes only.
[[nodiscard]] bool mayBeDicom(const std::filesystem::path& file);
/// Empty when the file is not a DICOM image object at all (text, DICOMDIR, damaged beyond reading).
/// Any thread.
[[nodiscard]] std::optional<DicomFile> readDicomHeader(const std::filesystem::path& file);
/// Whether a text has a part of the patient's name or identifier in it, of three letters or more.
[[nodiscard]] bool holdsName(const std::string& text, const DicomFile& file);
/// As DICOM writes several numbers: "0.5\0.5".
[[nodiscard]] std::string dicomNumbers(std::initializer_list<double> values);

}  // namespace palpate
