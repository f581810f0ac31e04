#pragma once
/// One JPEG 2000 code stream to numbers, through OpenJPEG (DCMTK's decoder is not free).

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace palpate {

struct Jpeg2000Image {
  std::uint32_t columns = 0, rows = 0;
  std::uint32_t bits = 0;
  bool isSigned = false, reversible = false;
  std::vector<std::int32_t> values;  ///< Row after row.
};

/// One component only. Empty when the stream is damaged, in colour, or not of the expected size
/// (looked at before memory is asked for). Any thread.
[[nodiscard]] std::optional<Jpeg2000Image> decodeJpeg2000(std::span<const std::uint8_t> stream,
                                                          std::uint32_t columns,
                                                          std::uint32_t rows);

}  // namespace palpate
