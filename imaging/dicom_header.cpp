#include "imaging/dicom_header.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>

#include "core/base/counted.h"
#include "imaging/dicom_frames.h"
#include "imaging/dicom_stream.h"
#include "imaging/dicom_toolkit.h"
#include "imaging/volume.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::uint32_t kMaxFrames = 100'000;
constexpr std::uint32_t kMaxSide = 65'535;  // Rows and Columns are of sixteen bits.
// What a lossy codec may reach on an empty slice with room to spare. A header that claims more is
// wrong, and decoding would first ask for the memory.
constexpr std::uint64_t kMaxInflation = 10'000;

std::uint32_t whole(DcmItem& item, const DcmTagKey& tag, std::uint32_t otherwise) {
  double value = 0.0;
  if (!dicomNumber(item, tag, value) || value < 0.0 || value > 4e9) return otherwise;
  return static_cast<std::uint32_t>(value);
}

std::string problemOf(DcmItem& dataset, const DicomFile& file) {
  if (dataset.tagExists(DcmTagKey(0x7FE0, 0x0008)) ||
      dataset.tagExists(DcmTagKey(0x7FE0, 0x0009))) {
    return "its pixels are floating-point numbers (a parametric map)";
  }
  if (!dataset.tagExists(DCM_Rows) || !dataset.tagExists(DCM_Columns)) {
    return "it holds no image (" +
           (file.modality.empty() ? std::string("no modality") : file.modality) + ")";
  }
  if (file.modality == "RTDOSE") return "it holds radiation doses, not an image (RTDOSE)";
  if (file.rows == 0 || file.columns == 0) return "its image has no rows or no columns";
  if (file.samples != 1) return "its image is in colour";
  if (file.photometric != "MONOCHROME1" && file.photometric != "MONOCHROME2") {
    return "its image is not grey (" + file.photometric + ")";
  }
  if (file.bitsAllocated == 1) return "its image has one bit per pixel (a segmentation)";
  const bool bitsFit = (file.bitsAllocated == 8 || file.bitsAllocated == 12 ||
                        file.bitsAllocated == 16 || file.bitsAllocated == 32) &&
                       file.bitsStored >= 1 && file.bitsStored <= file.bitsAllocated &&
                       file.highBit < file.bitsAllocated && file.highBit + 1 >= file.bitsStored;
  if (!bitsFit) return "its pixels have an impossible number of bits";
  return {};
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

bool isNative(const std::string& uid) {
  return uid == "1.2.840.10008.1.2" || uid == "1.2.840.10008.1.2.1" || uid == "1.2.840.10008.1.2.2";
}

/// Pixels that a byte of the file can become at most. Native ones that are missing are looked for
/// in isCutShort().
std::uint64_t maxInflation(const std::string& uid) {
  if (uid == "1.2.840.10008.1.2.1.99") return 1100;  // deflate: 1032 to one
  if (uid == "1.2.840.10008.1.2.5") return 64;       // RLE: 128 bytes from two
  // Huffman-coded JPEG: two bits or more for each block of 64.
  if (uid.starts_with("1.2.840.10008.1.2.4.5") || uid == "1.2.840.10008.1.2.4.70") return 256;
  return kMaxInflation;
}

std::string problemOfSize(const DicomFile& file, std::uint32_t frames) {
  if (frames == 0) return "it states an impossible number of frames";
  const std::uint64_t slice = std::uint64_t{file.rows} * file.columns;
  const bool fits = file.rows <= kMaxSide && file.columns <= kMaxSide &&
                    slice <= kMaxVoxels / frames &&
                    slice * frames <= file.bytes * maxInflation(file.transferSyntax);
  if (!fits) {
    return "it states an image of an impossible size (" + std::to_string(file.columns) + " x " +
           std::to_string(file.rows) + " pixels, " + counted(frames, "frame)", "frames)");
  }
  return {};
}

/// Native pixels must be there in full, and no more of them stated than there is; compressed ones
/// are found short when they are decoded. `end`: behind the tag and length of the pixels.
bool isCutShort(const DicomFile& file, std::uint64_t end) {
  if (!isNative(file.transferSyntax)) return false;
  const std::uint64_t bits =
      std::uint64_t{file.rows} * file.columns * file.frames.size() * file.bitsAllocated;
  const std::uint64_t left = file.bytes - std::min<std::uint64_t>(end, file.bytes);
  if (bits / 8 > left) return true;
  if (end < 4 || file.transferSyntax == "1.2.840.10008.1.2.2") return false;
  std::array<unsigned char, 4> length{};
  std::ifstream in(file.path, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(end - length.size()));
  in.read(reinterpret_cast<char*>(length.data()), length.size());
  const std::uint64_t stated =
      length[0] | length[1] << 8U | length[2] << 16U | static_cast<std::uint64_t>(length[3]) << 24U;
  return stated > left;
}

bool lossySyntax(const std::string& uid) {
  // JPEG baseline, extended, spectral, progressive; JPEG-LS near-lossless. JPEG 2000 (.91) may be
  // either: its decoder looks at the stream.
  return uid == "1.2.840.10008.1.2.4.50" || uid == "1.2.840.10008.1.2.4.51" ||
         uid == "1.2.840.10008.1.2.4.53" || uid == "1.2.840.10008.1.2.4.55" ||
         uid == "1.2.840.10008.1.2.4.81";
}

/// Why the file's frames cannot be told; empty when they can.
std::string readFrames(DcmItem& dataset, DicomFile& file) {
  const std::uint32_t frames = frameCount(dataset);
  const std::string problem = problemOfSize(file, frames);
  return problem.empty() ? readDicomFrames(dataset, frames, file.frames) : problem;
}

}  // namespace

std::string transferSyntaxName(const std::string& uid) {
  const DcmXfer syntax(uid.c_str());
  if (syntax.getXfer() != EXS_Unknown) return syntax.getXferName();
  // A damaged file may hold anything there, a name too.
  const bool isUid = uid.size() <= 64 && uid.find_first_not_of("0123456789.") == std::string::npos;
  return isUid ? uid : "unknown transfer syntax";
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
  file.localizer = imageType.find("LOCALIZER") != std::string::npos;
  file.mosaic = imageType.find("MOSAIC") != std::string::npos;
  file.lossy =
      lossySyntax(file.transferSyntax) || dicomText(*dataset, DCM_LossyImageCompression) == "01";
  DcmItem* lut = nullptr;
  file.modalityLut = dataset->findAndGetSequenceItem(DCM_ModalityLUTSequence, lut, 0).good();
  file.problem = problemOf(*dataset, file);
  const bool isGreyImage = file.problem.empty();
  if (isGreyImage) file.problem = readFrames(*dataset, file);
  if (file.problem.empty() && (!parse.complete() || isCutShort(file, parse.end)))
    file.problem = kDamagedFile;
  if (!parse.limit.empty()) file.problem = parse.limit;
  file.damaged = !parse.complete() || (isGreyImage && !file.problem.empty());
  return file;
}

}  // namespace palpate
