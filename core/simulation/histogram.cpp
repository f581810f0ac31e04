#include "core/simulation/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {

// Values below 32 ns have a bin each; above, the exponent and the five bits after the leading one.
std::size_t Histogram::binOf(std::uint64_t value) noexcept {
  if (value < (1U << kSubBits)) return static_cast<std::size_t>(value);
  const unsigned shift = static_cast<unsigned>(std::bit_width(value)) - 1U - kSubBits;
  const std::uint64_t sub = (value >> shift) & ((1U << kSubBits) - 1U);
  return static_cast<std::size_t>(((shift + 1ULL) << kSubBits) + sub);
}

double Histogram::middleOf(std::size_t bin) noexcept {
  if (bin < (1U << kSubBits)) return static_cast<double>(bin);
  const auto shift = static_cast<int>((bin >> kSubBits) - 1);
  const auto sub = static_cast<double>((bin & ((1U << kSubBits) - 1U)) + (1U << kSubBits));
  return std::ldexp(sub + 0.5, shift);
}

void Histogram::add(std::int64_t nanoseconds) noexcept {
  const std::int64_t value = std::max<std::int64_t>(nanoseconds, 0);
  ++bins_[binOf(static_cast<std::uint64_t>(value))];
  ++count_;
  max_ = std::max(max_, value);
}

double Histogram::percentile(double share) const noexcept {
  if (count_ == 0) return 0.0;
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    seen += bins_[bin];
    if (seen >= wanted) return std::min(middleOf(bin), static_cast<double>(max_));
  }
  return static_cast<double>(max_);
}

Timing Histogram::timing() const noexcept {
  constexpr double kMicros = 1e-3;
  return {percentile(0.5) * kMicros, percentile(0.99) * kMicros, percentile(0.999) * kMicros,
          static_cast<double>(max_) * kMicros};
}

DurationBins Histogram::bins() const noexcept {
  DurationBins out;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (bins_[bin] == 0) continue;
    const double micros = middleOf(bin) * 1e-3;
    std::size_t i = 0;
    while (i < DurationBins::kEnds.size() && micros >= DurationBins::kEnds[i]) ++i;
    out.count[i] += bins_[bin];
  }
  return out;
}

}  // namespace palpate
