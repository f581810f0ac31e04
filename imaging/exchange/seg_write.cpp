#include "imaging/exchange/seg_write.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/base/whole_file.h"
#include "imaging/dicom_stream.h"
#include "imaging/dicom_toolkit.h"
#include "imaging/exchange/cielab.h"
#include "imaging/exchange/dicom_uid.h"
#include "imaging/exchange/packed_bits.h"
#include "imaging/exchange/segment_codes.h"

// Behind ours: DCMTK's configuration header comes first.
#include <dcmtk/dcmfg/fgfracon.h>
#include <dcmtk/dcmfg/fgpixmsr.h>
#include <dcmtk/dcmfg/fgplanor.h>
#include <dcmtk/dcmfg/fgplanpo.h>
#include <dcmtk/dcmseg/segdoc.h>
#include <dcmtk/dcmseg/segment.h>

namespace palpate {
namespace fs = std::filesystem;
namespace {

/// The largest even length that 32 bits tell from "undefined".
constexpr std::size_t kMaxPixelBytes = 0xFFFFFFFE - 2;

/// The longest decimal that DICOM lets stand ("DS", 16 characters), so that geometry is exact to
/// some 1e-12 of itself.
OFString decimalString(double value) {
  char text[40];
  for (int digits = 16; digits > 0; --digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, value == 0.0 ? 0.0 : value);
    if (std::strlen(text) <= 16) break;
  }
  return text;
}

std::size_t characters(const std::string& utf8) {
  std::size_t count = 0;
  for (const char c : utf8) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return count;
}

Result<void> refuseUnfit(const LabelGrid& labels, const LabelTable& table) {
  if (labels.geometry.dims[0] > 65535 || labels.geometry.dims[1] > 65535) {
    return fail(inputRefused("The slices are too large for DICOM.")
                    .inField("dims")
                    .butFound(std::to_string(labels.geometry.dims[0]) + " x " +
                              std::to_string(labels.geometry.dims[1]) + " voxels")
                    .wants("at most 65535 along a side")
                    .advise("Export as .nrrd."));
  }
  for (const LabelInfo& info : table) {
    if (characters(info.name) <= 64 && info.name.find('\\') == std::string::npos) continue;
    return fail(inputRefused("A label's name does not fit into DICOM.")
                    .inField("label " + std::to_string(info.value))
                    .butFound(std::to_string(characters(info.name)) + " characters")
                    .wants("at most 64 characters, without a backslash")
                    .advise("Rename the label in labels.toml, or export as .nrrd."));
  }
  return {};
}

CodeSequenceMacro code(const SnomedCode& snomed) {
  return {snomed.value, "SCT", snomed.meaning};
}

bool addSegment(DcmSegmentation& seg, const LabelInfo& info) {
  const SegmentCodes codes = segmentCodes(info.name);
  DcmSegment* segment = nullptr;
  // The name follows in finish(): DCMTK knows neither UTF-8 nor its length here.
  if (DcmSegment::create(segment, "label", code(codes.category), code(codes.type),
                         DcmSegTypes::SAT_SEMIAUTOMATIC, "Palpate")
          .bad()) {
    return false;
  }
  const auto lab = dicomLabOfRgb(info.colour);
  Uint16 number = 0;
  return segment->setRecommendedDisplayCIELabValue(lab[0], lab[1], lab[2]).good() &&
         seg.addSegment(segment, number).good();
}

bool addSharedGroups(DcmSegmentation& seg, const GridGeometry& g) {
  FGPixelMeasures measures;
  const OFString between = decimalString(g.spacing[2] * 1e3);
  // "Between rows, between columns".
  const OFString pixel =
      decimalString(g.spacing[1] * 1e3) + "\\" + decimalString(g.spacing[0] * 1e3);
  if (measures.setPixelSpacing(pixel).bad() || measures.setSliceThickness(between).bad() ||
      measures.setSpacingBetweenSlices(between).bad()) {
    return false;
  }
  const Eigen::Matrix3d axes = g.X_PV.linear();
  const auto d = [&axes](Eigen::Index r, Eigen::Index c) { return decimalString(axes(r, c)); };
  const std::unique_ptr<FGPlaneOrientationPatient> orientation(
      FGPlaneOrientationPatient::createMinimal(d(0, 0), d(1, 0), d(2, 0), d(0, 1), d(1, 1),
                                               d(2, 1)));
  return orientation && seg.addForAllFrames(measures).good() &&
         seg.addForAllFrames(*orientation).good();
}

bool addFrame(DcmSegmentation& seg, const GridGeometry& g, std::int32_t slice, Uint32 place,
              Uint16 segment, std::vector<Uint8>& pixels) {
  const Eigen::Vector3d p = g.X_PV * g.centre_V(0, 0, slice) * 1e3;
  const std::unique_ptr<FGPlanePosPatient> position(FGPlanePosPatient::createMinimal(
      decimalString(p[0]), decimalString(p[1]), decimalString(p[2])));
  FGFrameContent content;
  OFVector<FGBase*> groups;
  groups.push_back(position.get());
  groups.push_back(&content);
  return position && content.setDimensionIndexValues(segment, 0).good() &&
         content.setDimensionIndexValues(place, 1).good() &&
         seg.addFrame(pixels.data(), segment, groups).good();
}

/// Ordinals of the slices that hold anything, from 1; 0 for the others.
std::vector<Uint32> places(const LabelGrid& labels, const std::array<Uint16, 256>& segments) {
  const auto& dims = labels.geometry.dims;
  const std::size_t slice = static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]);
  std::vector<Uint32> ordinal(static_cast<std::size_t>(dims[2]), 0);
  Uint32 next = 0;
  for (std::size_t k = 0; k < ordinal.size(); ++k) {
    for (std::size_t i = k * slice; i < (k + 1) * slice && ordinal[k] == 0; ++i) {
      if (segments[labels.labels[i]] != 0) ordinal[k] = ++next;
    }
  }
  return ordinal;
}

/// The frames of one label. False where DCMTK refuses one.
bool addFrames(DcmSegmentation& seg, const LabelGrid& labels, std::uint8_t value, Uint16 segment,
               const std::vector<Uint32>& ordinal, PackedBits& bits) {
  const auto& g = labels.geometry;
  const std::size_t slice =
      static_cast<std::size_t>(g.dims[0]) * static_cast<std::size_t>(g.dims[1]);
  std::vector<Uint8> pixels(slice);
  for (std::size_t k = 0; k < ordinal.size(); ++k) {
    if (ordinal[k] == 0) continue;
    bool any = false;
    for (std::size_t i = 0; i < slice; ++i) {
      pixels[i] = labels.labels[k * slice + i] == value ? 1 : 0;
      any = any || pixels[i] != 0;
    }
    const auto z = static_cast<std::int32_t>(k);
    if (!any) continue;
    if (!addFrame(seg, g, z, ordinal[k], segment, pixels)) return false;
    bits.append(pixels);
  }
  return true;
}

bool describe(DcmSegmentation& seg, const SegOrigin& origin) {
  const std::string dimensions = randomUid();
  const std::string root = "palpate/" + origin.fingerprint + "/" + origin.pseudonym + "/";
  return seg.getDimensions()
             .addDimensionIndex(DCM_ReferencedSegmentNumber, dimensions.c_str(),
                                DCM_SegmentIdentificationSequence, "Segment")
             .good() &&
         seg.getDimensions()
             .addDimensionIndex(DCM_ImagePositionPatient, dimensions.c_str(),
                                DCM_PlanePositionSequence, "Position")
             .good() &&
         seg.getFrameOfReference().setFrameOfReferenceUID(uidOf(root + "frame").c_str()).good() &&
         seg.getStudy().setStudyInstanceUID(uidOf(root + "study").c_str()).good() &&
         seg.getSeries().setSeriesInstanceUID(randomUid().c_str()).good() &&
         seg.getSeries().setSeriesNumber("1").good() &&
         seg.getSOPCommon().setSOPInstanceUID(randomUid().c_str()).good() &&
         seg.getSOPCommon().setSpecificCharacterSet("ISO_IR 192").good() &&
         seg.getPatient().setPatientName(origin.pseudonym.c_str(), OFFalse).good() &&
         seg.getPatient().setPatientID(origin.pseudonym.c_str(), OFFalse).good();
}

std::unique_ptr<DcmSegmentation> emptySegmentation(const GridGeometry& g, const SegOrigin& origin) {
  ContentIdentificationMacro content;
  const IODGeneralEquipmentModule::EquipmentInfo equipment("Palpate", "Palpate", "none",
                                                           origin.programVersion.c_str());
  DcmSegmentation* made = nullptr;
  if (content.setContentLabel("LABELS").bad() || content.setInstanceNumber("1").bad() ||
      content.setContentDescription("Labels of a scan").bad() ||
      content.setContentCreatorName("Palpate").bad() ||
      DcmSegmentation::createBinarySegmentation(made, static_cast<Uint16>(g.dims[1]),
                                                static_cast<Uint16>(g.dims[0]), equipment, content)
          .bad()) {
    return nullptr;
  }
  return std::unique_ptr<DcmSegmentation>(made);
}

/// What DCMTK leaves to us.
bool finish(DcmDataset& dataset, const LabelTable& table, const SegOrigin& origin,
            const std::vector<Uint8>& bits) {
  for (std::size_t s = 0; s < table.size(); ++s) {
    DcmItem* segment = nullptr;
    if (dataset.findAndGetSequenceItem(DCM_SegmentSequence, segment, static_cast<long>(s)).bad() ||
        segment->putAndInsertString(DCM_SegmentLabel, table[s].name.c_str()).bad()) {
      return false;
    }
  }
  // How much a lossy scan had been compressed the case does not know; that it was must be said.
  return dataset.putAndInsertUint8Array(DCM_PixelData, bits.data(), bits.size()).good() &&
         dataset.putAndInsertString(DCM_PatientIdentityRemoved, "YES").good() &&
         dataset.putAndInsertString(DCM_DeidentificationMethod, "Pseudonym only (Palpate)")
             .good() &&
         (!origin.lossy || dataset.putAndInsertString(DCM_LossyImageCompression, "01").good());
}

/// Whether the file holds these very pixels.
bool holds(const fs::path& file, const std::vector<Uint8>& bits) {
  const Uint8* stored = nullptr;
  unsigned long count = 0;
  DcmFileFormat format;
  return parseDicom(format, file).complete() &&
         format.getDataset()->findAndGetUint8Array(DCM_PixelData, stored, &count).good() &&
         count == bits.size() && std::memcmp(stored, bits.data(), count) == 0;
}

Error toolkitFailed() {
  return machineError("DCMTK could not make the segmentation.")
      .advise("Export as .seg.nrrd, and report this.");
}

Result<void> save(DcmSegmentation& seg, const LabelTable& table, const SegOrigin& origin,
                  const std::vector<Uint8>& bits, const fs::path& file) {
  auto whole = WholeFile::beside(file);
  if (!whole) return fail(whole.error());
  DcmFileFormat format;
  if (seg.writeDataset(*format.getDataset()).bad() ||
      !finish(*format.getDataset(), table, origin, bits)) {
    return fail(toolkitFailed());
  }
  errno = 0;
  if (format.saveFile(whole->hiddenName().c_str(), EXS_LittleEndianExplicit).bad()) {
    return fail(cannotWrite(file, errno != 0 ? errno : EIO));
  }
  if (!holds(whole->hiddenName(), bits)) return fail(cannotWrite(file, ENOSPC));
  return whole->commit();
}

}  // namespace

Result<void> writeDicomSeg(const LabelGrid& labels, const LabelTable& table,
                           const SegOrigin& origin, const fs::path& file,
                           const Progress& progress) {
  prepareDicomToolkit();
  if (auto fits = refuseUnfit(labels, table); !fits) return fits;
  std::array<Uint16, 256> segments{};
  for (std::size_t s = 0; s < table.size(); ++s) {
    segments[table[s].value] = static_cast<Uint16>(s + 1);
  }
  const std::vector<Uint32> ordinal = places(labels, segments);
  const auto seg = emptySegmentation(labels.geometry, origin);
  if (!seg || !describe(*seg, origin) || !addSharedGroups(*seg, labels.geometry)) {
    return fail(toolkitFailed());
  }
  for (const LabelInfo& info : table) {
    if (!addSegment(*seg, info)) return fail(toolkitFailed());
  }
  PackedBits bits;
  for (std::size_t s = 0; s < table.size(); ++s) {
    if (progress.cancelled()) return fail(cancelled());
    progress(0.8 * static_cast<double>(s) / static_cast<double>(table.size()), "Packing segments");
    if (!addFrames(*seg, labels, table[s].value, segments[table[s].value], ordinal, bits)) {
      return fail(toolkitFailed());
    }
  }
  if (seg->getNumberOfFrames() == 0) {
    return fail(inputRefused("The labels hold no voxels.")
                    .inField("labels")
                    .advise("Segment first: palpate segment CASE --preset NAME"));
  }
  if (bits.bytes().size() > kMaxPixelBytes) {
    return fail(inputRefused("The labels are too large for one DICOM file.")
                    .inField("PixelData")
                    .butFound(std::to_string(bits.bytes().size()) + " bytes")
                    .wants("less than 4 GiB")
                    .advise("Export fewer labels in one file, or as .nrrd."));
  }
  progress(0.9, "Writing the segmentation");
  return save(*seg, table, origin, bits.bytes(), file);
}

}  // namespace palpate
