#pragma once
/// What every peer answers with: the points in contact, each with depth and outward normal.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate::bench {

/// Structure of arrays, sized before the steps; the order is the peer's own.
struct ContactList {
  explicit ContactList(std::size_t capacity)
      : index(capacity + kSlack),
        depth(capacity + kSlack),
        nx(capacity + kSlack),
        ny(capacity + kSlack),
        nz(capacity + kSlack) {}

  /// Whole vectors are stored past the end.
  static constexpr std::size_t kSlack = 64;

  std::size_t count = 0;
  std::vector<std::uint32_t> index;  ///< Of the shell's point, as in the input.
  std::vector<float> depth;          ///< Voxels (smallest spacing), >= 0.
  std::vector<float> nx, ny, nz;     ///< Unit, in V.
};

}  // namespace palpate::bench
