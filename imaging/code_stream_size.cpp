#include "imaging/code_stream_size.h"

#include <cstddef>

namespace palpate {
namespace {

constexpr std::uint32_t kMaxSegments = 15;
constexpr std::size_t kRleHead = 64;
// A progressive image of 12 bits has at most 63 coefficients by 13 bits; common are ten scans.
constexpr int kMaxScans = 1000;

std::uint32_t big16(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint32_t>(bytes[at] << 8U | bytes[at + 1]);
}

std::uint32_t little32(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8U |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16U |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24U;
}

/// SOF0 to SOF15 without the tables in between (DHT, JPG, DAC), and JPEG-LS's SOF55.
bool beginsFrame(std::uint8_t marker) {
  return marker == 0xF7 ||
         (marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC);
}

/// Entropy-coded data have no marker of a scan (FFDA) in them: what follows FF there is small.
bool hasFewScans(std::span<const std::uint8_t> stream) {
  int scans = 0;
  for (std::size_t at = 0; at + 1 < stream.size() && scans <= kMaxScans; ++at) {
    if (stream[at] == 0xFF && stream[at + 1] == 0xDA) ++scans;
  }
  return scans <= kMaxScans;
}

/// Bytes that a segment decodes to.
std::uint64_t decodedLength(std::span<const std::uint8_t> segment) {
  std::uint64_t length = 0;
  std::size_t at = 0;
  while (at + 1 < segment.size()) {
    const std::size_t control = segment[at];
    if (control < 128) {
      if (at + 1 + control >= segment.size()) break;
      length += control + 1;
      at += control + 2;
    } else {
      if (control > 128) length += 257 - control;
      at += control > 128 ? 2 : 1;
    }
  }
  return length;
}

}  // namespace

bool jpegIsOfSize(std::span<const std::uint8_t> stream, std::uint32_t columns, std::uint32_t rows) {
  if (stream.size() < 4 || stream[0] != 0xFF || stream[1] != 0xD8) return false;
  std::size_t at = 2;
  while (at + 4 <= stream.size() && stream[at] == 0xFF) {
    const std::uint8_t marker = stream[at + 1];
    if (marker == 0xFF) {  // filling
      ++at;
      continue;
    }
    if (beginsFrame(marker)) {
      return at + 10 <= stream.size() && big16(stream, at + 5) == rows &&
             big16(stream, at + 7) == columns && stream[at + 9] == 1 &&
             hasFewScans(stream.subspan(at));
    }
    at += 2 + big16(stream, at + 2);
  }
  return false;
}

bool rleIsOfSize(std::span<const std::uint8_t> frame, std::uint32_t bytesPerPixel,
                 std::uint64_t pixels) {
  if (frame.size() < kRleHead || bytesPerPixel == 0 || bytesPerPixel > kMaxSegments ||
      little32(frame, 0) != bytesPerPixel) {
    return false;
  }
  for (std::uint32_t s = 0; s < bytesPerPixel; ++s) {
    const std::size_t from = little32(frame, 4 + std::size_t{4} * s);
    const std::size_t to =
        s + 1 < bytesPerPixel ? little32(frame, 8 + std::size_t{4} * s) : frame.size();
    if (from < kRleHead || from > to || to > frame.size()) return false;
    const std::uint64_t length = decodedLength(frame.subspan(from, to - from));
    // Some writers make an odd number of pixels even.
    if (length != pixels && length != pixels + pixels % 2) return false;
  }
  return true;
}

}  // namespace palpate
