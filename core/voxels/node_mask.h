#pragma once
/// The occupancy mask of a node: one bit a child, for 8, 64 and 512 children with one code.
///
/// Bits = bits per axis and level: 1, 2, 3. Child (x, y, z) is bit x | y << Bits | z << 2·Bits.
/// Masks lie in memory as kBytes bytes a node, lowest bit first; the k-th child that is present
/// follows the first one at distance k (its rank), so a node needs one link for all its children.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate {

template <int Bits>
struct NodeMask {
  static_assert(Bits >= 1 && Bits <= 3);
  static constexpr int kEdge = 1 << Bits;
  static constexpr int kChildren = 1 << (3 * Bits);
  static constexpr std::size_t kBytes = kChildren / 8;
  static constexpr std::size_t kWords = (kChildren + 63) / 64;
  static constexpr int kLow = kEdge - 1;  ///< Mask of a coordinate within the node.

  std::array<std::uint64_t, kWords> word{};

  [[nodiscard]] static NodeMask load(const std::uint8_t* masks, std::size_t node) noexcept {
    static_assert(std::endian::native == std::endian::little, "masks are read as little-endian");
    NodeMask mask;
    std::memcpy(mask.word.data(), masks + node * kBytes, kBytes);
    return mask;
  }
  void store(std::uint8_t* masks, std::size_t node) const noexcept {
    std::memcpy(masks + node * kBytes, word.data(), kBytes);
  }
  [[nodiscard]] static int child(int x, int y, int z) noexcept {
    return x | (y << Bits) | (z << (2 * Bits));
  }
  void set(int c) noexcept {
    word[static_cast<std::size_t>(c) >> 6] |= std::uint64_t{1} << (c & 63);
  }
  [[nodiscard]] bool test(int c) const noexcept {
    return ((word[static_cast<std::size_t>(c) >> 6] >> (c & 63)) & 1U) != 0;
  }
  [[nodiscard]] int count() const noexcept {
    int n = 0;
    for (const std::uint64_t w : word) n += std::popcount(w);
    return n;
  }
  /// How many present children come before child c.
  [[nodiscard]] int rank(int c) const noexcept {
    int n = 0;
    const auto last = static_cast<std::size_t>(c) >> 6;
    for (std::size_t w = 0; w < last; ++w) n += std::popcount(word[w]);
    return n + std::popcount(word[last] & ((std::uint64_t{1} << (c & 63)) - 1));
  }
  [[nodiscard]] bool empty() const noexcept {
    std::uint64_t any = 0;
    for (const std::uint64_t w : word) any |= w;
    return any == 0;
  }
};

/// Calls f(child) for every child that is present, in order.
template <int Bits, class F>
void forEachChild(const NodeMask<Bits>& mask, F&& f) {
  for (std::size_t w = 0; w < NodeMask<Bits>::kWords; ++w) {
    for (std::uint64_t bits = mask.word[w]; bits != 0; bits &= bits - 1) {
      f(static_cast<int>(w * 64) + std::countr_zero(bits));
    }
  }
}

}  // namespace palpate
