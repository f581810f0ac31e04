#pragma once
/// Fingerprints over bit patterns: equal bits, equal hash; -0.0 and 0.0 differ, NaNs by payload.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace palpate {

/// XXH3, 64 bits, seeded: chain by giving the last hash as the seed. Real-time safe.
[[nodiscard]] std::uint64_t hashBits(const void* data, std::size_t bytes,
                                     std::uint64_t seed) noexcept;

/// A fixed row of 64-bit words to be hashed, without padding of any struct. Real-time safe.
template <std::size_t kMost>
class BitRow {
 public:
  template <class T>
  void add(T value) noexcept {
    static_assert(std::is_arithmetic_v<T> && sizeof(T) <= 8);
    std::uint64_t word = 0;
    std::memcpy(&word, &value, sizeof(T));
    if (count_ < kMost) words_[count_++] = word;
  }
  template <class T, std::size_t n>
  void add(const T (&values)[n]) noexcept {
    for (const T& value : values) add(value);
  }
  [[nodiscard]] std::uint64_t hash(std::uint64_t seed) const noexcept {
    return hashBits(words_.data(), count_ * sizeof(std::uint64_t), seed);
  }

 private:
  std::array<std::uint64_t, kMost> words_{};
  std::size_t count_ = 0;
};

}  // namespace palpate
