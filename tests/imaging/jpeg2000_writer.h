#pragma once
/// A small JPEG 2000 code stream.

#include <cstdint>
#include <string>

namespace palpate::test {

/// Sixteen bits without sign, lossless. Throws std::runtime_error when it cannot.
[[nodiscard]] std::string encodeJpeg2000(std::uint32_t columns, std::uint32_t rows);

}  // namespace palpate::test
