#pragma once
/// Which way is out at a voxel's centre: the gradient of a signed distance by central differences,
/// smoothed 1-2-1 across each (Sobel), for a distance between voxel centres jumps from one to the
/// next; one-sided at the grid's faces. Where it vanishes (a sheet of one voxel, a single voxel)
/// the forward differences decide, and +z where these vanish too.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "core/geometry/grid_geometry.h"

namespace palpate {

/// The 27 values around a voxel, x fastest; beyond the grid its edge goes on.
struct Neighbourhood {
  std::array<double, 27> value{};
  std::array<bool, 3> below{}, above{};  ///< Is there a voxel before, behind, along each axis?
};

/// The value of an empty voxel among depths in smallest spacings: half of one outside is the least
/// that it can be, and all that a tree knows of it.
inline constexpr double kEmptyValue = 0.5;

/// Asks valueAt(voxel) for a voxel and the 26 around it.
template <class F>
[[nodiscard]] Neighbourhood neighbourhoodOf(const std::array<std::int32_t, 3>& voxel,
                                            const std::array<std::int32_t, 3>& dims, F&& valueAt) {
  Neighbourhood around;
  for (std::size_t a = 0; a < 3; ++a) {
    around.below[a] = voxel[a] > 0;
    around.above[a] = voxel[a] + 1 < dims[a];
  }
  for (std::int32_t n = 0; n < 27; ++n) {
    const std::array<std::int32_t, 3> step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    std::array<std::int32_t, 3> at;
    for (std::size_t a = 0; a < 3; ++a) at[a] = std::clamp(voxel[a] + step[a], 0, dims[a] - 1);
    around.value[static_cast<std::size_t>(n)] = valueAt(at);
  }
  return around;
}

/// Unit. Values in any unit of length, spacing in metres.
[[nodiscard]] Eigen::Vector3d outwardNormal(const Neighbourhood& around,
                                            const Eigen::Vector3d& spacing) noexcept;

/// The same from a field of signed distances, one value a voxel.
[[nodiscard]] Eigen::Vector3d outwardNormal(const GridGeometry& geometry,
                                            std::span<const float> field, std::int32_t i,
                                            std::int32_t j, std::int32_t k);

}  // namespace palpate
