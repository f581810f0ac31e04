#include "core/simulation/bits.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate {

std::uint64_t hashBits(const void* data, std::size_t bytes, std::uint64_t seed) noexcept {
  return XXH3_64bits_withSeed(data, bytes, seed);
}

}  // namespace palpate
