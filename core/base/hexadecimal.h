#pragma once
/// Bytes as text.

#include <cstdint>
#include <span>
#include <string>

namespace palpate {

/// Two lower-case digits a byte.
[[nodiscard]] inline std::string hexadecimal(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const std::uint8_t b : bytes) {
    text.push_back(kDigits[b >> 4U]);
    text.push_back(kDigits[b & 15U]);
  }
  return text;
}

}  // namespace palpate
