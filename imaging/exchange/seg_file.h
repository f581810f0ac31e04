#pragma once
/// A DICOM segmentation as plain values, sizes checked before memory is taken.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "imaging/exchange/grid_fit.h"

namespace palpate {

struct SegSegment {
  std::uint32_t number = 0;                           ///< As frames refer to it.
  std::string label;                                  ///< UTF-8, as written; may be empty.
  std::optional<std::array<std::uint8_t, 3>> colour;  ///< sRGB
};

struct SegFrame {
  std::size_t segment = 0;  ///< In SegFile::segments.
  StatedGrid place;         ///< Columns, rows, one slice.
};

struct SegFile {
  bool fractional = false;
  std::uint32_t maximum = 255;  ///< FRACTIONAL: the value that means 1.
  std::uint32_t rows = 0, columns = 0;
  std::vector<SegSegment> segments;  ///< 1 to 255, in the file's order.
  std::vector<SegFrame> frames;
  /// BINARY: a bit a pixel, lowest first, frame after frame without a gap; FRACTIONAL: a byte.
  std::vector<std::uint8_t> pixels;

  /// Set, or at least half of the maximum. `pixel` is row · columns + column.
  [[nodiscard]] bool isSet(std::size_t frame, std::size_t pixel) const noexcept {
    const std::size_t at = frame * rows * columns + pixel;
    if (fractional) return 2U * pixels[at] >= maximum;
    return (pixels[at / 8] >> (at % 8) & 1U) != 0;
  }
};

/// Refuses what is no DICOM segmentation, is damaged or cut short, compressed, neither BINARY nor
/// FRACTIONAL, of more than 255 segments, or has frames without a place or of a segment that is
/// not described: each by tag, with what was found.
[[nodiscard]] Result<SegFile> readSegFile(const std::filesystem::path& file);

}  // namespace palpate
