#include "imaging/exchange/seg_file.h"

#include <cmath>
#include <map>

#include "imaging/dicom_frames.h"
#include "imaging/dicom_header.h"
#include "imaging/dicom_stream.h"
#include "imaging/dicom_toolkit.h"
#include "imaging/exchange/cielab.h"
#include "imaging/volume.h"
#include "imaging/transfer_syntax.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kAskAgain =
    "Copy the file again from where it came, or export it again from the program that made it.";
/// Values 1 to 255 of a case's label volume.
constexpr unsigned long kMaxSegments = 255;

Error wrong(const fs::path& file, std::string message, std::string field, std::string found,
            std::string expected, std::string advice = kAskAgain) {
  return inputRefused(std::move(message))
      .inFile(file.string())
      .inField(std::move(field))
      .butFound(std::move(found))
      .wants(std::move(expected))
      .advise(std::move(advice));
}

/// A whole number from 0 to 2^31 - 1.
std::optional<std::uint32_t> whole(DcmItem& item, const DcmTagKey& tag) {
  double value = 0.0;
  if (!dicomNumber(item, tag, value) || value != std::trunc(value) || value < 0.0 ||
      value > 2147483647.0) {
    return std::nullopt;
  }
  return static_cast<std::uint32_t>(value);
}

std::string numberText(const std::optional<std::uint32_t>& number) {
  return number ? std::to_string(*number) : "nothing usable";
}

Result<void> refuseOtherObjects(DcmFileFormat& format, const fs::path& file) {
  DcmDataset& dataset = *format.getDataset();
  const std::string sopClass = dicomText(dataset, DCM_SOPClassUID);
  if (sopClass != UID_SegmentationStorage) {
    const char* name = dcmFindNameOfUID(sopClass.c_str());
    return fail(wrong(file, "The DICOM file is not a segmentation.", "SOPClassUID",
                      name != nullptr ? name : "another class", "SegmentationStorage",
                      "Choose the segmentation (modality SEG) of the study."));
  }
  std::string syntax = DcmXfer(dataset.getOriginalXfer()).getXferID();
  if (DcmXfer(dataset.getOriginalXfer()).isEncapsulated()) {
    return fail(wrong(file, "The segmentation's pixels are compressed.", "TransferSyntaxUID",
                      transferSyntaxName(syntax), "uncompressed pixels",
                      "Have the archive send it uncompressed, or use dcmdjpeg or dcmdrle."));
  }
  return {};
}

Result<void> readKind(DcmItem& dataset, SegFile& seg, const fs::path& file) {
  const std::string type = dicomCode(dataset, DCM_SegmentationType);
  if (type != "BINARY" && type != "FRACTIONAL") {
    return fail(wrong(file, "The segmentation is of a kind that Palpate does not read.",
                      "SegmentationType", type.empty() ? "nothing" : type, "BINARY or FRACTIONAL",
                      "Export it as a binary segmentation from the program that made it."));
  }
  seg.fractional = type == "FRACTIONAL";
  const std::uint32_t bits = seg.fractional ? 8 : 1;
  const auto allocated = whole(dataset, DCM_BitsAllocated);
  if (allocated != bits) {
    return fail(wrong(file, "The segmentation's pixels do not have the size of its kind.",
                      "BitsAllocated", numberText(allocated), std::to_string(bits)));
  }
  if (!seg.fractional) return {};
  const auto maximum = whole(dataset, DCM_MaximumFractionalValue);
  if (!maximum || *maximum == 0 || *maximum > 255) {
    return fail(wrong(file, "The segmentation does not say which value means one.",
                      "MaximumFractionalValue", numberText(maximum), "1 to 255"));
  }
  seg.maximum = *maximum;
  return {};
}

/// Rows, columns and frames, and all the pixels that they need. Returns the number of frames.
Result<std::uint32_t> readPixels(DcmItem& dataset, SegFile& seg, const fs::path& file) {
  const auto rows = whole(dataset, DCM_Rows);
  const auto columns = whole(dataset, DCM_Columns);
  const auto frames = whole(dataset, DCM_NumberOfFrames);
  // Each factor is below 2^31, and rows and columns are 16 bits wide in DICOM.
  const bool sizes = rows && columns && frames && *rows > 0 && *columns > 0 && *frames > 0 &&
                     *rows <= 65535 && *columns <= 65535;
  if (!sizes) {
    return fail(wrong(file, "The segmentation states an impossible size.",
                      "Rows, Columns, NumberOfFrames",
                      numberText(rows) + ", " + numberText(columns) + ", " + numberText(frames),
                      "1 to 65535 rows and columns, and at least one frame"));
  }
  const std::uint64_t pixels = std::uint64_t{*rows} * *columns * *frames;
  const std::uint64_t needed = seg.fractional ? pixels : (pixels + 7) / 8;
  DcmElement* element = nullptr;
  const std::uint64_t stored =
      dataset.findAndGetElement(DCM_PixelData, element).good() ? element->getLengthField() : 0;
  const Uint8* bytes = nullptr;
  unsigned long count = 0;
  if (stored < needed || dataset.findAndGetUint8Array(DCM_PixelData, bytes, &count).bad() ||
      bytes == nullptr || count < needed) {
    return fail(wrong(file, "The segmentation holds fewer pixels than it states.", "PixelData",
                      std::to_string(stored) + " bytes", std::to_string(needed) + " bytes"));
  }
  seg.rows = *rows;
  seg.columns = *columns;
  seg.pixels.assign(bytes, bytes + needed);
  return *frames;
}

std::optional<std::array<std::uint8_t, 3>> colourOf(DcmItem& segment) {
  std::array<std::uint16_t, 3> lab{};
  for (std::size_t c = 0; c < 3; ++c) {
    double value = 0.0;
    if (!dicomNumber(segment, DCM_RecommendedDisplayCIELabValue, value, c) || value < 0.0 ||
        value > 65535.0) {
      return std::nullopt;
    }
    lab[c] = static_cast<std::uint16_t>(value);
  }
  return rgbOfDicomLab(lab);
}

/// Fills seg.segments; returns where each number is.
Result<std::map<std::uint32_t, std::size_t>> readSegments(DcmItem& dataset, SegFile& seg,
                                                          const fs::path& file) {
  DcmSequenceOfItems* sequence = nullptr;
  (void)dataset.findAndGetSequence(DCM_SegmentSequence, sequence);
  const unsigned long count = sequence != nullptr ? sequence->card() : 0;
  if (count == 0 || count > kMaxSegments) {
    return fail(wrong(file, "The segmentation does not have a number of segments that fits a case.",
                      "SegmentSequence", std::to_string(count) + " segments", "1 to 255",
                      "Export fewer segments into one file."));
  }
  const std::string charset = dicomText(dataset, DCM_SpecificCharacterSet);
  std::map<std::uint32_t, std::size_t> places;
  for (unsigned long s = 0; s < count; ++s) {
    DcmItem& item = *sequence->getItem(s);
    const auto number = whole(item, DCM_SegmentNumber);
    if (!number || *number == 0 || !places.emplace(*number, s).second) {
      return fail(wrong(file, "A segment has no number of its own.",
                        "SegmentNumber of segment " + std::to_string(s + 1), numberText(number),
                        "a number from 1 that no other segment has"));
    }
    // The character set is the file's, and dicomUtf8() looks for it in the item.
    if (!charset.empty()) (void)item.putAndInsertString(DCM_SpecificCharacterSet, charset.c_str());
    seg.segments.push_back({*number, dicomUtf8(item, DCM_SegmentLabel), colourOf(item)});
  }
  return places;
}

/// The segment that a frame is of, said by the frame itself or for all of them.
std::optional<std::uint32_t> segmentNumber(DcmItem* own, DcmItem* shared) {
  for (DcmItem* groups : {own, shared}) {
    DcmItem* item = nullptr;
    if (groups == nullptr ||
        groups->findAndGetSequenceItem(DCM_SegmentIdentificationSequence, item, 0).bad()) {
      continue;
    }
    return whole(*item, DCM_ReferencedSegmentNumber);
  }
  return std::nullopt;
}

Result<StatedGrid> placeOf(const DicomFrame& frame, const SegFile& seg, const fs::path& file) {
  const std::string of = " of frame " + std::to_string(frame.number + 1);
  const auto missing = [&](const char* tag, const char* expected) {
    return fail(wrong(file, "A frame of the segmentation does not say where it lies.", tag + of,
                      "nothing usable", expected));
  };
  if (!frame.hasPosition) return missing("ImagePositionPatient", "three numbers");
  if (!frame.hasOrientation) return missing("ImageOrientationPatient", "six numbers");
  if (!frame.hasSpacing) return missing("PixelSpacing", "two numbers");
  StatedGrid place;
  place.dims = {static_cast<std::int32_t>(seg.columns), static_cast<std::int32_t>(seg.rows), 1};
  place.axes_mm.col(0) = frame.row * frame.spacing_mm[0];
  place.axes_mm.col(1) = frame.column * frame.spacing_mm[1];
  place.axes_mm.col(2).setZero();
  place.origin_mm = frame.position_mm;
  return place;
}

Result<void> readFrames(DcmItem& dataset, std::uint32_t count,
                        const std::map<std::uint32_t, std::size_t>& places, SegFile& seg,
                        const fs::path& file) {
  DcmItem* shared = nullptr;
  DcmSequenceOfItems* perFrame = nullptr;
  (void)dataset.findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, shared, 0);
  (void)dataset.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, perFrame);
  const unsigned long described = perFrame != nullptr ? perFrame->card() : 0;
  if (described != count) {
    return fail(wrong(file, "The segmentation does not describe each of its frames.",
                      "PerFrameFunctionalGroupsSequence", std::to_string(described) + " frames",
                      std::to_string(count) + " frames"));
  }
  std::vector<DicomFrame> frames;
  (void)readDicomFrames(dataset, count, frames);  // its one complaint is the one above
  DcmObject* own = nullptr;
  for (const DicomFrame& frame : frames) {
    own = perFrame->nextInContainer(own);
    const auto number = segmentNumber(dynamic_cast<DcmItem*>(own), shared);
    const auto segment = number ? places.find(*number) : places.end();
    if (segment == places.end()) {
      return fail(wrong(file, "A frame is of a segment that the file does not describe.",
                        "ReferencedSegmentNumber of frame " + std::to_string(frame.number + 1),
                        numberText(number), "the number of a segment of the file"));
    }
    auto place = placeOf(frame, seg, file);
    if (!place) return fail(place.error());
    seg.frames.push_back({segment->second, *place});
  }
  return {};
}

}  // namespace

Result<SegFile> readSegFile(const fs::path& file) {
  prepareDicomToolkit();
  DcmFileFormat format;
  const DicomParse parse = parseDicom(format, file);
  if (!parse.complete() || format.getDataset() == nullptr) {
    return fail(inputRefused("The DICOM file is damaged or cut short.")
                    .inFile(file.string())
                    .advise(kAskAgain));
  }
  DcmDataset& dataset = *format.getDataset();
  if (auto object = refuseOtherObjects(format, file); !object) return fail(object.error());
  SegFile seg;
  if (auto kind = readKind(dataset, seg, file); !kind) return fail(kind.error());
  const auto count = readPixels(dataset, seg, file);
  if (!count) return fail(count.error());
  const auto places = readSegments(dataset, seg, file);
  if (!places) return fail(places.error());
  if (auto frames = readFrames(dataset, *count, *places, seg, file); !frames) {
    return fail(frames.error());
  }
  return seg;
}

}  // namespace palpate
