#pragma once
/// The pixels of a binary segmentation as DICOM wants them: a bit each, lowest first, frame after
/// frame without a gap (PS3.5 8.1.1).
///
/// DCMTK 3.6.7 joins frames wrongly that do not fill whole bytes; these bits take the place of its
/// own.

#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

class PackedBits {
 public:
  /// Anything but 0 is set.
  void append(std::span<const std::uint8_t> pixels) {
    bytes_.resize((count_ + pixels.size() + 15) / 16 * 2, 0);  // DICOM's lengths are even
    for (const std::uint8_t pixel : pixels) {
      bytes_[count_ / 8] |= static_cast<std::uint8_t>((pixel != 0 ? 1U : 0U) << (count_ % 8));
      ++count_;
    }
  }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const noexcept { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::size_t count_ = 0;
};

}  // namespace palpate
