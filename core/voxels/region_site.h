#pragma once
/// Where the contact region is in one cell, in twelve bytes.
///
/// The contact region N is where the trilinear value is negative. Outside N its nearest point lies
/// in a *mixed* cell, one with corners of both kinds. A site bounds N within such a cell by a box
/// and by a plane n·p <= h with |n| <= 1, both rounded outwards. Length unit: the smallest spacing;
/// p from the cell's lower corner.

#include <array>
#include <cstdint>

namespace palpate {

struct RegionSite {
  static constexpr float kBoxSteps = 255.0f;     ///< Of lo and hi in a cell's edge.
  static constexpr float kNormalSteps = 127.0f;  ///< Of n in 1.
  static constexpr float kPlaneSteps = 512.0f;   ///< Of h in a unit of length.

  std::array<std::uint8_t, 3> lo{}, hi{};
  std::array<std::int8_t, 3> n{};
  std::uint8_t cell = 0;  ///< Within its block of 4³ cells, x fastest.
  std::int16_t h = 0;
};
static_assert(sizeof(RegionSite) == 12);

/// The site of a cell with these corner values (x fastest) and edges. False where N does not reach
/// into the cell. Values below `slack` count as negative, for what a query computes from stored
/// depths may differ by that much.
[[nodiscard]] bool siteOfCell(const std::array<float, 8>& corner, const std::array<float, 3>& edge,
                              float slack, RegionSite& site);

}  // namespace palpate
