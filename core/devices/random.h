#pragma once
/// Random numbers that are the same everywhere (SplitMix64: Steele, Lea, Flood 2014). The standard
/// library's distributions differ between implementations; a seed here fixes the bits.

#include <cstdint>

namespace palpate {

class Random {
 public:
  explicit Random(std::uint64_t seed) noexcept : state_(seed) {}
  [[nodiscard]] std::uint64_t next() noexcept {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  /// Even in [low, high).
  [[nodiscard]] double uniform(double low, double high) noexcept {
    return low + (high - low) * static_cast<double>(next() >> 11) * 0x1.0p-53;
  }

 private:
  std::uint64_t state_;
};

}  // namespace palpate
