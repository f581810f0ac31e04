#pragma once
/// The frames of a DICOM file: one in a classic image, many in an enhanced one, whose per-frame
/// functional groups hold position, orientation, spacing and rescale (PS3.3 C.7.6.16).
/// Include from .cpp only (DCMTK).

#include <vector>

#include "imaging/dicom_header.h"
#include "imaging/dicom_toolkit.h"

namespace palpate {

/// `count` frames; what the file does not say stays unset. Returns why they cannot be told apart,
/// as DicomFile::problem; empty when they can.
[[nodiscard]] DicomProblem readDicomFrames(DcmItem& dataset, std::uint32_t count,
                                           std::vector<DicomFrame>& frames);

}  // namespace palpate
