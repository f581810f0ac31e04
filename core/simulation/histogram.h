#pragma once
/// Durations in fixed, logarithmic bins: percentiles of any number of samples in 16 KiB.

#include <array>
#include <cstdint>

#include "core/simulation/snapshot.h"

namespace palpate {

/// How many durations fell between two bounds, µs; the last has no upper bound.
struct DurationBins {
  /// 1, 2, 5, 10, ... 100 000 µs: bin i ends at kEnds[i].
  static constexpr std::array<double, 16> kEnds{1,   2,    5,    10,   20,    50,    100,   200,
                                                500, 1000, 2000, 5000, 10000, 20000, 50000, 100000};
  std::array<std::uint64_t, kEnds.size() + 1> count{};
};

/// Real-time safe; one thread at a time. A percentile is right within 1.6 % (half a bin of 1/32
/// octave); the maximum is exact.
class Histogram {
 public:
  void add(std::int64_t nanoseconds) noexcept;
  void clear() noexcept { *this = Histogram(); }
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Nanoseconds that at least `share` (0..1] of the samples do not exceed; 0 without samples.
  [[nodiscard]] double percentile(double share) const noexcept;
  [[nodiscard]] Timing timing() const noexcept;      ///< µs
  [[nodiscard]] DurationBins bins() const noexcept;  ///< Coarse, for a report; right within 1.6 %.

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
