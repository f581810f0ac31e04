#pragma once
/// From frames to stacks: which images make one volume, and which of them their series' UID means.

#include <vector>

#include "imaging/dicom_stack.h"

namespace palpate {

/// By series in the order of first files; within a series, the largest first. Looks at headers
/// only.
[[nodiscard]] std::vector<DicomStack> groupIntoStacks(const std::vector<DicomFile>& files);
/// The same, copies and damaged files settled (dicom_copies.h).
[[nodiscard]] std::vector<DicomStack> stacksOf(const std::vector<DicomFile>& files);

}  // namespace palpate
