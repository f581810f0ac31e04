#pragma once
/// One contact: a shell point that the leaf model finds inside the anatomy.

#include <cstdint>
#include <type_traits>

namespace palpate {

/// Plain data; crosses threads. Which frame p and n are in, the function that fills it says.
struct Contact {
  double p[3] = {0, 0, 0};  ///< The shell point, metres.
  double n[3] = {0, 0, 1};  ///< Outward unit normal of the anatomy there.
  double depth = 0.0;       ///< Penetration, metres, >= 0.
  std::uint32_t shellIndex = 0;
  std::uint8_t label = 0;
  std::uint8_t flags = 0;  ///< ContactFlag bits.
  std::uint16_t body = 0;  ///< Which body of the scene was touched; 0 = the anatomy.
};
static_assert(std::is_trivially_copyable_v<Contact>);

enum ContactFlag : std::uint8_t {
  kContactApproximate = 1,  ///< Descent was cut here.
  kContactSaturated = 2,    ///< Deeper than the stored depth (16 voxels).
};

}  // namespace palpate
