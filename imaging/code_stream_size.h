#pragma once
/// Whether a compressed frame is of the size that its header states. DCMTK fills what a short one
/// leaves open with whatever was in memory.

#include <cstdint>
#include <span>

namespace palpate {

/// JPEG and JPEG-LS: by the frame's head in the stream (T.81 B.2.2). One component, in at most
/// 1,000 scans: each costs the time of a whole image, and a few bytes.
[[nodiscard]] bool jpegIsOfSize(std::span<const std::uint8_t> stream, std::uint32_t columns,
                                std::uint32_t rows);
/// RLE (PS3.5 annex G): by what each segment, one a byte of a pixel, decodes to.
[[nodiscard]] bool rleIsOfSize(std::span<const std::uint8_t> frame, std::uint32_t bytesPerPixel,
                               std::uint64_t pixels);

}  // namespace palpate
