#pragma once
/// Durations in fixed, logarithmic bins: percentiles of any number of samples in 16 KiB.

#include <array>
#include <cstdint>

#include "core/simulation/snapshot.h"

namespace palpate {

/// Real-time safe; one thread at a time. A percentile is right within 1.6 % (half a bin of 1/32
/// octave); the maximum is exact.
class Histogram {
 public:
  void add(std::int64_t nanoseconds) noexcept;
  void clear() noexcept { *this = Histogram(); }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Nanoseconds that at least `share` (0..1] of the samples do not exceed; 0 without samples.
  [[nodiscard]] double percentile(double share) const noexcept;
  [[nodiscard]] Timing timing() const noexcept;  ///< µs

 private:
  static constexpr unsigned kSubBits = 5;  // 32 bins an octave
  static constexpr std::size_t kBins = (64 - kSubBits + 1) << kSubBits;
  [[nodiscard]] static std::size_t binOf(std::uint64_t value) noexcept;
  [[nodiscard]] static double middleOf(std::size_t bin) noexcept;

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ = 0;
};

}  // namespace palpate
