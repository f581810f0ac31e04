#pragma once
/// Euclidean distances by ITK, behind plain values (ITK is alone in its library).

#include <array>
#include <cstdint>
#include <vector>

namespace palpate {

/// For each voxel the squared distance, mm², from its centre to the nearest set one's; what a set
/// voxel gets is not above zero. x fastest. At least one voxel must be set.
/// Source: Maurer, Qi, Raghavan, "A linear time algorithm for computing exact Euclidean distance
/// transforms of binary images in arbitrary dimensions", 2003 (itk::SignedMaurerDistanceMap).
[[nodiscard]] std::vector<float> squaredDistances_mm2(const std::vector<std::uint8_t>& set,
                                                      const std::array<std::int32_t, 3>& dims,
                                                      const std::array<double, 3>& spacing_mm);

}  // namespace palpate
