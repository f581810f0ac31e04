#pragma once
/// The stored numbers of a DICOM file's frames, whatever its transfer syntax.

#include <cstdint>
#include <functional>
#include <span>

#include "core/base/error.h"
#include "imaging/dicom_header.h"

namespace palpate {

struct DecodedFacts {
  bool lossy = false;  ///< The code stream itself turned out to be lossy (JPEG 2000).
};

/// Called once a frame, in ascending order of frames; values row after row, the modality LUT
/// applied, slope and intercept not. Valid during the call.
using FrameVisitor = std::function<void(std::uint32_t frame, std::span<const std::int32_t> values)>;

/// Refuses what cannot be decoded by the name of its transfer syntax. Any thread.
[[nodiscard]] Result<DecodedFacts> decodeDicomFrames(const DicomFile& file,
                                                     const FrameVisitor& visit);

}  // namespace palpate
