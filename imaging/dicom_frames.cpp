#include "imaging/dicom_frames.h"

namespace palpate {

const std::array<const char*, 8> kPhaseNames{
    "temporal position", "trigger time", "echo time",          "b-value",
    "image type",        "stack",        "acquisition number", "acquisition time"};

namespace {

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
}

DicomFrame readClassic(DcmItem& dataset) {
  DicomFrame frame;
  readPosition(dataset, frame);
  readOrientation(dataset, frame);
  readMeasures(dataset, frame);
  readRescale(dataset, frame);
  frame.phase = {dicomText(dataset, DCM_TemporalPositionIdentifier),
                 dicomText(dataset, DCM_TriggerTime),
                 dicomText(dataset, DCM_EchoTime),
                 dicomText(dataset, DCM_DiffusionBValue),
                 dicomText(dataset, DCM_ImageType),
                 "",
                 dicomText(dataset, DCM_AcquisitionNumber),
                 dicomText(dataset, DCM_AcquisitionTime)};
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
  frame.phase.assign(kPhaseNames.size(), "");
  if (DcmItem* g = groupOf(own, shared, DCM_PlanePositionSequence)) readPosition(*g, frame);
  if (DcmItem* g = groupOf(own, shared, DCM_PlaneOrientationSequence)) readOrientation(*g, frame);
  if (DcmItem* g = groupOf(own, shared, DCM_PixelMeasuresSequence)) readMeasures(*g, frame);
  if (DcmItem* g = groupOf(own, shared, DCM_PixelValueTransformationSequence)) {
    readRescale(*g, frame);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_FrameContentSequence)) {
    frame.phase[0] = dicomText(*g, DCM_TemporalPositionIndex);
    frame.phase[5] = dicomText(*g, DCM_StackID);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_CardiacSynchronizationSequence)) {
    frame.phase[1] = dicomText(*g, DCM_NominalCardiacTriggerDelayTime);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_MREchoSequence)) {
    frame.phase[2] = dicomText(*g, DCM_EffectiveEchoTime);
  }
  if (DcmItem* g = groupOf(own, shared, DCM_MRDiffusionSequence)) {
    frame.phase[3] = dicomText(*g, DCM_DiffusionBValue);
  }
  for (const DcmTagKey& tag : {DCM_MRImageFrameTypeSequence, DCM_CTImageFrameTypeSequence}) {
    if (DcmItem* g = groupOf(own, shared, tag)) frame.phase[4] = dicomText(*g, DCM_FrameType);
  }
  return frame;
}

}  // namespace

std::vector<DicomFrame> readDicomFrames(DcmItem& dataset, std::uint32_t count) {
  std::vector<DicomFrame> frames;
  DcmItem* shared = nullptr;
  (void)dataset.findAndGetSequenceItem(DCM_SharedFunctionalGroupsSequence, shared, 0);
  DcmSequenceOfItems* perFrame = nullptr;
  (void)dataset.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, perFrame);
  for (std::uint32_t f = 0; f < count; ++f) {
    DcmItem* own = perFrame != nullptr && f < perFrame->card() ? perFrame->getItem(f) : nullptr;
    if (shared == nullptr && own == nullptr) {
      frames.push_back(readClassic(dataset));
      // One position cannot be that of many frames.
      if (count > 1) frames.back().hasPosition = false;
    } else {
      frames.push_back(readEnhanced(own, shared));
    }
    frames.back().number = f;
  }
  return frames;
}

}  // namespace palpate
