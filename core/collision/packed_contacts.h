#pragma once
/// The contacts of a step side by side: what the query writes, and the cheapest form to read.

#include <algorithm>
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
  std::vector<float> depth;          ///< Penetration, metres, >= 0; saturated from 16 spacings on.
  std::vector<float> nx, ny, nz;     ///< Outward unit normal of the anatomy, V.
};

/// Contacts being written from a place of a PackedContacts on. Several runs may be written at a
/// time where each has room for all that it may get.
struct PackedRun {
  PackedRun(PackedContacts& to, std::size_t first) noexcept
      : index(to.index.data() + first),
        depth(to.depth.data() + first),
        nx(to.nx.data() + first),
        ny(to.ny.data() + first),
        nz(to.nz.data() + first) {}

  std::size_t count = 0;
  std::uint32_t* index;
  float *depth, *nx, *ny, *nz;
};

/// Moves `count` contacts at place `from` down to place `to`.
inline void movePacked(PackedContacts& packed, std::size_t from, std::size_t count,
                       std::size_t to) noexcept {
  const auto move = [&](auto& values) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(from);
    std::copy(first, first + static_cast<std::ptrdiff_t>(count),
              values.begin() + static_cast<std::ptrdiff_t>(to));
  };
  move(packed.index);
  move(packed.depth);
  move(packed.nx);
  move(packed.ny);
  move(packed.nz);
}

}  // namespace palpate
