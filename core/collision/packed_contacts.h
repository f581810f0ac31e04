#pragma once
/// The contacts of a step side by side: what the query writes, and the cheapest form to read.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

/// Sized once; structure of arrays. The order is that of the shell's hierarchy (the same for equal
/// inputs), not of the indices.
struct PackedContacts {
  /// Whole vectors are stored past the last contact.
  static constexpr std::size_t kSlack = 64;

  PackedContacts() = default;
  explicit PackedContacts(std::size_t capacity)
      : index(capacity + kSlack),
        depth(capacity + kSlack),
        nx(capacity + kSlack),
        ny(capacity + kSlack),
        nz(capacity + kSlack) {}

  std::size_t count = 0;
  std::vector<std::uint32_t> index;  ///< Of the shell's point.
  std::vector<float> depth;  ///< Penetration, metres, >= 0; 16 smallest spacings where saturated.
  std::vector<float> nx, ny, nz;  ///< Outward unit normal of the anatomy, V.
};

}  // namespace palpate
