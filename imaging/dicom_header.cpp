#include "imaging/dicom_header.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "core/base/counted.h"
#include "core/base/short_number.h"
#include "imaging/dicom_frames.h"
#include "imaging/dicom_stream.h"
#include "imaging/dicom_toolkit.h"
#include "imaging/transfer_syntax.h"
#include "imaging/volume.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::uint32_t kMaxFrames = 100'000;
constexpr std::uint32_t kMaxSide = 65'535;  // Rows and Columns are of sixteen bits.

std::uint32_t whole(DcmItem& item, const DcmTagKey& tag, std::uint32_t otherwise) {
  double value = 0.0;
  if (!dicomNumber(item, tag, value) || value < 0.0 || value > 4e9) return otherwise;
  return static_cast<std::uint32_t>(value);
}

/// The kind of object by its name in DICOM: "RTStructureSetStorage".
std::string objectKind(DcmItem& dataset) {
  const char* name = dcmFindNameOfUID(dicomText(dataset, DCM_SOPClassUID).c_str());
  return name != nullptr ? name : "an unknown kind of object";
}

DicomProblem problemOf(DcmItem& dataset, const DicomFile& file) {
  for (const auto& [tag, keyword] :
       {std::pair{DcmTagKey(0x7FE0, 0x0008), "FloatPixelData"},
        std::pair{DcmTagKey(0x7FE0, 0x0009), "DoubleFloatPixelData"}}) {
    if (!dataset.tagExists(tag)) continue;
    return {.reason = "its pixels are floating-point numbers (a parametric map)",
            .field = keyword,
            .found = objectKind(dataset),
            .expected = "PixelData"};
  }
  if (!dataset.tagExists(DCM_Rows) || !dataset.tagExists(DCM_Columns)) {
    return {.reason = "it holds no image (" +
                      (file.modality.empty() ? std::string("no modality") : file.modality) + ")",
            .field = "SOPClassUID",
            .found = objectKind(dataset),
            .expected = "a CT or MR image"};
  }
  if (file.modality == "RTDOSE") {
    return {.reason = "it holds radiation doses, not an image (RTDOSE)",
            .field = "Modality",
            .found = file.modality,
            .expected = "CT or MR"};
  }
  if (file.rows == 0 || file.columns == 0) {
    return {.reason = "its image has no rows or no columns",
            .field = "Rows, Columns",
            .found = std::to_string(file.rows) + ", " + std::to_string(file.columns),
            .expected = "1 or more each"};
  }
  if (file.samples != 1) {
    return {.reason = "its image is in colour",
            .field = "SamplesPerPixel",
            .found = std::to_string(file.samples),
            .expected = "1"};
  }
  if (file.photometric != "MONOCHROME1" && file.photometric != "MONOCHROME2") {
    return {.reason = "its image is not grey (" + file.photometric + ")",
            .field = "PhotometricInterpretation",
            .found = file.photometric,
            .expected = "MONOCHROME1 or MONOCHROME2"};
  }
  if (file.bitsAllocated == 1) {
    return {.reason = "its image has one bit per pixel (a segmentation)",
            .field = "BitsAllocated",
            .found = "1",
            .expected = "8, 12, 16 or 32"};
  }
  const bool bitsFit = (file.bitsAllocated == 8 || file.bitsAllocated == 12 ||
                        file.bitsAllocated == 16 || file.bitsAllocated == 32) &&
                       file.bitsStored >= 1 && file.bitsStored <= file.bitsAllocated &&
                       file.highBit < file.bitsAllocated && file.highBit + 1 >= file.bitsStored;
  if (bitsFit) return {};
  return {.reason = "its pixels have an impossible number of bits",
          .field = "BitsAllocated, BitsStored, HighBit",
          .found = std::to_string(file.bitsAllocated) + ", " + std::to_string(file.bitsStored) +
                   ", " + std::to_string(file.highBit),
          .expected = "8, 12, 16 or 32; stored bits within them, up to the high bit"};
}

/// 0 when the file states a number that is none.
std::uint32_t frameCount(DcmItem& dataset) {
  DcmElement* element = nullptr;
  if (dataset.findAndGetElement(DCM_NumberOfFrames, element).bad() || element == nullptr ||
      element->getLengthField() == 0) {
    return 1;
  }
  double count = 0.0;
  if (!dicomNumber(dataset, DCM_NumberOfFrames, count) || count != std::trunc(count) ||
      count < 0.0 || count > kMaxFrames) {
    return 0;
  }
  return std::max(static_cast<std::uint32_t>(count), 1U);
}

/// Pixels that a file of so many bytes may state.
struct PixelBound {
  std::uint64_t perByte = 0;
  std::uint64_t free = 0;  ///< Whatever the bytes.
};

PixelBound boundOf(PixelCoding coding) {
  switch (coding) {
    case PixelCoding::Native:
      // Counted in missingPixels(); this only tells nonsense from a file that is cut short.
      return {10'000};
    case PixelCoding::Deflated:
      return {1100};  // 1032 to one
    case PixelCoding::Rle:
      return {64};  // 128 bytes from two
    case PixelCoding::Jpeg:
      return {256};  // Huffman-coded: two bits or more for each block of 64.
    default:
      return {kMaxPixelsPerByte, kFreePixels};
  }
}

DicomProblem problemOfSize(const DicomFile& file, std::uint32_t frames) {
  const std::uint64_t slice = std::uint64_t{file.rows} * file.columns;
  const PixelBound bound = boundOf(transferSyntaxOf(file.transferSyntax).coding);
  const bool possible =
      file.rows <= kMaxSide && file.columns <= kMaxSide && slice <= kMaxVoxels / frames;
  if (possible && slice * frames <= std::max(file.bytes * bound.perByte, bound.free)) {
    return {};
  }
  const std::string size = std::to_string(file.columns) + " x " + std::to_string(file.rows) +
                           " pixels, " + counted(frames, "frame", "frames");
  return {
      .reason = "it states an image of an impossible size (" + size + ")",
      .field = "Columns, Rows, NumberOfFrames",
      .found = size + " in " + std::to_string(file.bytes) + " bytes",
      .expected = "at most " + std::to_string(bound.perByte) + " pixels a byte, and 2^31 in all"};
}

/// Native pixels must be there in full, and no more of them stated than there is; compressed ones
/// are found short when they are decoded. `end`: behind the tag and length of the pixels.
DicomProblem missingPixels(const DicomFile& file, std::uint64_t end) {
  const TransferSyntax syntax = transferSyntaxOf(file.transferSyntax);
  if (syntax.coding != PixelCoding::Native) return {};
  const std::uint64_t bits =
      std::uint64_t{file.rows} * file.columns * file.frames.size() * file.bitsAllocated;
  const std::uint64_t left = file.bytes - std::min<std::uint64_t>(end, file.bytes);
  const auto problem = [left](std::uint64_t wanted) {
    return DicomProblem{.reason = kDamagedFile,
                        .field = "PixelData",
                        .found = std::to_string(left) + " bytes",
                        .expected = std::to_string(wanted) + " bytes"};
  };
  if (bits / 8 > left) return problem(bits / 8);
  if (end < 4 || syntax.bigEndian) return {};
  std::array<unsigned char, 4> length{};
  std::ifstream in(file.path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(end - length.size()));
  in.read(reinterpret_cast<char*>(length.data()), length.size());
  const std::uint64_t stated =
      length[0] | length[1] << 8U | length[2] << 16U | static_cast<std::uint64_t>(length[3]) << 24U;
  return stated > left ? problem(stated) : DicomProblem{};
}

/// The first two values say whether it is original and of the patient.
std::string kindOfImage(DcmItem& dataset) {
  constexpr unsigned long kMaxValues = 8;
  std::string kind;
  for (unsigned long value = 2; value < kMaxValues; ++value) {
    const std::string code = dicomCode(dataset, DCM_ImageType, value);
    if (code.empty()) break;
    if (!kind.empty()) kind.push_back(' ');
    kind += code;
  }
  return kind;
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Why the file's frames cannot be told; empty when they can.
DicomProblem readFrames(DcmItem& dataset, DicomFile& file) {
  const std::uint32_t frames = frameCount(dataset);
  if (frames == 0) {
    double count = 0.0;
    return {.reason = "it states an impossible number of frames",
            .field = "NumberOfFrames",
            .found = dicomNumber(dataset, DCM_NumberOfFrames, count) ? dicomNumbers({count})
                                                                     : "no number",
            .expected = "a whole number up to " + std::to_string(kMaxFrames)};
  }
  const DicomProblem problem = problemOfSize(file, frames);
  return problem.empty() ? readDicomFrames(dataset, frames, file.frames) : problem;
}

}  // namespace

bool holdsName(const std::string& text, const DicomFile& file) {
  const std::string here = lowered(text);
  std::string part;
  for (const char c : lowered(file.patientName + "^" + file.patientId) + "^") {
    if (c != '^' && c != '=' && c != ' ') {
      part.push_back(c);
      continue;
    }
    if (part.size() >= 3 && here.find(part) != std::string::npos) return true;
    part.clear();
  }
  return false;
}

std::string dicomNumbers(std::initializer_list<double> values) {
  std::string text;
  for (const double v : values) {
    if (!text.empty()) text.push_back('\\');
    text += shortNumber(v);
  }
  return text;
}

bool isOtherThanHounsfield(const DicomFile& file, const DicomFrame& frame) {
  if (file.modality != "CT") return false;
  const std::string& unit = frame.rescaleType;
  return (!unit.empty() && unit != "HU" && unit != "HU_MOD") ||
         file.imageKind.find("PERFUSION") != std::string::npos;
}

bool mayBeDicom(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 132> head{};
  in.read(head.data(), head.size());
  const auto got = in.gcount();
  if (got == 132 && std::equal(head.begin() + 128, head.end(), "DICM")) return true;
  if (got < 8) return false;
  // Without preamble: a data set that begins with group 0002 or 0008, little-endian.
  const auto byte = [&head](std::size_t i) { return static_cast<unsigned char>(head[i]); };
  if (byte(1) != 0 || (byte(0) != 0x08 && byte(0) != 0x02)) return false;
  const bool explicitVr = std::isupper(byte(4)) != 0 && std::isupper(byte(5)) != 0;
  const std::uint32_t length =
      byte(4) | byte(5) << 8U | byte(6) << 16U | static_cast<std::uint32_t>(byte(7)) << 24U;
  std::error_code ec;
  return explicitVr || length < fs::file_size(file, ec);
}

std::optional<DicomFile> readDicomHeader(const fs::path& path) {
  if (!mayBeDicom(path)) return std::nullopt;
  prepareDicomToolkit();
  DcmFileFormat format;
  const DicomParse parse = parseDicom(format, path, DCM_PixelData);
  DcmDataset* dataset = format.getDataset();
  const bool usable =
      dataset != nullptr && (dataset->tagExists(DCM_SOPClassUID) || dataset->tagExists(DCM_Rows));
  if (!usable || dataset->tagExists(DCM_DirectoryRecordSequence)) return std::nullopt;
  DicomFile file;
  file.path = path;
  std::error_code ec;
  file.bytes = fs::file_size(path, ec);
  file.seriesUid = dicomText(*dataset, DCM_SeriesInstanceUID);
  file.instanceUid = dicomText(*dataset, DCM_SOPInstanceUID);
  file.modality = dicomCode(*dataset, DCM_Modality);
  file.description = dicomUtf8(*dataset, DCM_SeriesDescription);
  file.studyUid = dicomText(*dataset, DCM_StudyInstanceUID);
  file.studyDate = dicomText(*dataset, DCM_StudyDate);
  file.patientName = dicomUtf8(*dataset, DCM_PatientName);
  file.patientId = dicomUtf8(*dataset, DCM_PatientID);
  file.transferSyntax = DcmXfer(dataset->getOriginalXfer()).getXferID();
  const std::string metaSyntax = format.getMetaInfo() != nullptr
                                     ? dicomText(*format.getMetaInfo(), DCM_TransferSyntaxUID)
                                     : std::string();
  if (!metaSyntax.empty()) file.transferSyntax = metaSyntax;
  file.photometric = dicomCode(*dataset, DCM_PhotometricInterpretation);
  file.rows = whole(*dataset, DCM_Rows, 0);
  file.columns = whole(*dataset, DCM_Columns, 0);
  file.samples = whole(*dataset, DCM_SamplesPerPixel, 1);
  file.bitsAllocated = whole(*dataset, DCM_BitsAllocated, 0);
  file.bitsStored = whole(*dataset, DCM_BitsStored, file.bitsAllocated);
  file.highBit = whole(*dataset, DCM_HighBit, file.bitsStored - 1);
  file.isSigned = whole(*dataset, DCM_PixelRepresentation, 0) == 1;
  const std::string imageType = dicomText(*dataset, DCM_ImageType);
  file.imageKind = kindOfImage(*dataset);
  file.localizer = imageType.find("LOCALIZER") != std::string::npos;
  file.mosaic = imageType.find("MOSAIC") != std::string::npos;
  file.lossy = transferSyntaxOf(file.transferSyntax).lossy ||
               dicomText(*dataset, DCM_LossyImageCompression) == "01";
  DcmItem* lut = nullptr;
  file.modalityLut = dataset->findAndGetSequenceItem(DCM_ModalityLUTSequence, lut, 0).good();
  file.problem = problemOf(*dataset, file);
  const bool isGreyImage = file.problem.empty();
  if (isGreyImage) file.problem = readFrames(*dataset, file);
  if (file.problem.empty()) {
    file.problem =
        parse.complete() ? missingPixels(file, parse.end) : DicomProblem{.reason = kDamagedFile};
  }
  if (!parse.limit.empty()) file.problem = {.reason = parse.limit};
  file.damaged = !parse.complete() || (isGreyImage && !file.problem.empty());
  return file;
}

}  // namespace palpate
