#include "imaging/dicom_frames.h"

namespace palpate {

const std::array<const char*, 8> kPhaseNames{
    "temporal position", "trigger time", "echo time",          "b-value",
    "image type",        "stack",        "acquisition number", "acquisition time"};

namespace {

// Phases are compared and kept for every frame; what is longer is no phase.
constexpr Uint32 kMaxPhase = 1024;

std::vector<std::string> noPhase() {
  return std::vector<std::string>(kPhaseNames.size());
}

std::string phaseText(DcmItem& item, const DcmTagKey& tag) {
  DcmElement* element = nullptr;
  if (item.findAndGetElement(tag, element).bad() || element->getLengthField() > kMaxPhase)
    return {};
  return dicomText(item, tag);
}

void readVector(DcmItem& item, const DcmTagKey& tag, unsigned long from, Eigen::Vector3d& v,
                bool& complete) {
  for (unsigned long i = 0; i < 3; ++i) {
    complete = dicomNumber(item, tag, v[static_cast<Eigen::Index>(i)], from + i) && complete;
  }
}

void readPosition(DcmItem& item, DicomFrame& frame) {
  bool complete = true;
  readVector(item, DCM_ImagePositionPatient, 0, frame.position_mm, complete);
  frame.hasPosition = complete;
}

void readOrientation(DcmItem& item, DicomFrame& frame) {
  bool complete = true;
  readVector(item, DCM_ImageOrientationPatient, 0, frame.row, complete);
  readVector(item, DCM_ImageOrientationPatient, 3, frame.column, complete);
  frame.hasOrientation = complete;
}

void readMeasures(DcmItem& item, DicomFrame& frame) {
  // PixelSpacing is "between rows, between columns": first along the column, then along the row.
  frame.hasSpacing = dicomNumber(item, DCM_PixelSpacing, frame.spacing_mm[1], 0) &&
                     dicomNumber(item, DCM_PixelSpacing, frame.spacing_mm[0], 1);
  (void)dicomNumber(item, DCM_SliceThickness, frame.thickness_mm);
}

void readRescale(DcmItem& item, DicomFrame& frame) {
  (void)dicomNumber(item, DCM_RescaleSlope, frame.slope);
  (void)dicomNumber(item, DCM_RescaleIntercept, frame.intercept);
  frame.rescaleType = dicomCode(item, DCM_RescaleType);
}

DicomFrame readClassic(DcmItem& dataset) {
  DicomFrame frame;
  readPosition(dataset, frame);
  readOrientation(dataset, frame);
  readMeasures(dataset, frame);
  readRescale(dataset, frame);
  frame.phase = {phaseText(dataset, DCM_TemporalPositionIdentifier),
                 phaseText(dataset, DCM_TriggerTime),
                 phaseText(dataset, DCM_EchoTime),
                 phaseText(dataset, DCM_DiffusionBValue),
                 phaseText(dataset, DCM_ImageType),
                 "",
                 phaseText(dataset, DCM_AcquisitionNumber),
                 phaseText(dataset, DCM_AcquisitionTime)};
  return frame;
}

/// The one item of a functional group's sequence: the frame's own, else the shared one.
DcmItem* groupOf(DcmItem* frameGroups, DcmItem* sharedGroups, const DcmTagKey& tag) {
  DcmItem* item = nullptr;
  for (DcmItem* groups : {frameGroups, sharedGroups}) {
    if (groups != nullptr && groups->findAndGetSequenceItem(tag, item, 0).good()) return item;
  }
  return nullptr;
}

DicomFrame readEnhanced(DcmItem* own, DcmItem* shared) {
  DicomFrame frame;
  frame.phase = noPhase();
  if (DcmItem* g = groupOf(own, shared, DCM_PlanePositionSequence)) readPosition(*g, frame);
  if (DcmItem* g = groupOf(own, shared, DCM_PlaneOrientationSequence)) readOrientation(*g, frame);
  if (DcmItem* g = groupOf(own, shared, DCM_PixelMeasuresSequence)) readMeasures(*g, frame);
  if (DcmItem* g = groupOf(own, shared, DCM_PixelValueTransformationSequence)) {
    readRescale(*g, frame);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_FrameContentSequence)) {
    frame.phase[0] = phaseText(*g, DCM_TemporalPositionIndex);
    frame.phase[5] = phaseText(*g, DCM_StackID);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_CardiacSynchronizationSequence)) {
    frame.phase[1] = phaseText(*g, DCM_NominalCardiacTriggerDelayTime);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_MREchoSequence)) {
    frame.phase[2] = phaseText(*g, DCM_EffectiveEchoTime);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_MRDiffusionSequence)) {
    frame.phase[3] = phaseText(*g, DCM_DiffusionBValue);
  }
  for (const DcmTagKey& tag : {DCM_MRImageFrameTypeSequence, DCM_CTImageFrameTypeSequence}) {
    if (DcmItem* g = groupOf(own, shared, tag)) frame.phase[4] = phaseText(*g, DCM_FrameType);
  }
  return frame;
}

}  // namespace

DicomProblem readDicomFrames(DcmItem& dataset, std::uint32_t count,
                             std::vector<DicomFrame>& frames) {
  DcmItem* shared = nullptr;
  (void)dataset.findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, shared, 0);
  DcmSequenceOfItems* perFrame = nullptr;
  (void)dataset.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, perFrame);
  if (perFrame != nullptr && perFrame->card() != count) {
    return {.reason = "it describes " + std::to_string(perFrame->card()) + " of its " +
                      std::to_string(count) + " frames",
            .field = "PerFrameFunctionalGroupsSequence",
            .found = std::to_string(perFrame->card()) + " items",
            .expected = std::to_string(count) + " items"};
  }
  if (shared == nullptr && perFrame == nullptr) {
    DicomFrame frame = readClassic(dataset);
    // One position cannot be that of many frames.
    if (count > 1) frame.hasPosition = false;
    if (count > 1) frame.phase = noPhase();
    frames.assign(count, frame);
  } else {
    // From one to the next: getItem() counts from the first every time.
    DcmObject* own = nullptr;
    for (std::uint32_t f = 0; f < count; ++f) {
      if (perFrame != nullptr) own = perFrame->nextInContainer(own);
      frames.push_back(readEnhanced(dynamic_cast<DcmItem*>(own), shared));
    }
  }
  for (std::uint32_t f = 0; f < count; ++f) frames[f].number = f;
  return {};
}

}  // namespace palpate
