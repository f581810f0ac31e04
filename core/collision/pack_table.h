#pragma once
/// For every mask of eight lanes: the numbers of its lanes, in order.

#include <array>
#include <cstddef>
#include <cstdint>

namespace palpate {

struct alignas(64) PackTable {
  std::array<std::array<std::int32_t, 8>, 256> lane{};
  constexpr PackTable() {
    for (std::size_t mask = 0; mask < 256; ++mask) {
      std::size_t n = 0;
      for (std::size_t l = 0; l < 8; ++l) {
        if ((mask >> l & 1U) != 0) lane[mask][n++] = static_cast<std::int32_t>(l);
      }
    }
  }
};
inline constexpr PackTable kPackTable;

}  // namespace palpate
