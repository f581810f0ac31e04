#include "core/session/deflate.h"

#include <zlib.h>

namespace palpate {

std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes) {
  uLongf size = ::compressBound(static_cast<uLong>(bytes.size()));
  std::vector<std::uint8_t> out(size);
  // Label volumes are long runs: the fastest level already gives about 1:60.
  if (::compress2(out.data(), &size, bytes.data(), static_cast<uLong>(bytes.size()),
                  Z_BEST_SPEED) != Z_OK) {
    return {};
  }
  out.resize(size);
  return out;
}

std::optional<std::vector<std::uint8_t>> inflated(std::span<const std::uint8_t> bytes,
                                                  std::size_t size) {
  // Deflate cannot do better than 1:1032; a larger claim is damage, not a reason to take memory.
  if (size / 1032 > bytes.size()) return std::nullopt;
  std::vector<std::uint8_t> out(size);
  auto got = static_cast<uLongf>(size);
  if (::uncompress(out.data(), &got, bytes.data(), static_cast<uLong>(bytes.size())) != Z_OK ||
      got != size) {
    return std::nullopt;
  }
  return out;
}

}  // namespace palpate
