#pragma once
/// A unit vector in four bytes: octahedral mapping, 16 bits a coordinate.
///
/// Source: Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors",
/// 2014. Largest error 7e-5 rad, so a depth of the voxel model moves by less than 1e-4 voxel.

#include <Eigen/Core>
#include <cstdint>

namespace palpate {

struct UnitNormal {
  std::int16_t u = 0, v = 0;  ///< Default: +z.
};
static_assert(sizeof(UnitNormal) == 4);

/// n must be of unit length.
[[nodiscard]] UnitNormal encodeNormal(const Eigen::Vector3d& n) noexcept;
/// Of unit length up to rounding.
[[nodiscard]] Eigen::Vector3d decodeNormal(UnitNormal n) noexcept;

}  // namespace palpate
