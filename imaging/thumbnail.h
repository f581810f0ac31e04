#pragma once
/// A small grey picture of a stack of images, to know it again in a list.

#include <optional>
#include <vector>

#include "imaging/dicom_stack.h"
#include "imaging/import.h"

namespace palpate {

/// The slice in the middle, at most kThumbnailSide pixels wide and high, square pixels; grey from
/// the 1st to the 99th percentile of its values. Empty where it cannot be decoded. Any thread.
[[nodiscard]] std::optional<GreyPicture> thumbnailOf(const std::vector<DicomFile>& files,
                                                     const DicomStack& stack);

}  // namespace palpate
