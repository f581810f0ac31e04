#pragma once
/// The Surface Descriptor of every voxel (McNeely 1999; paper 2.1.1).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/grid_geometry.h"

namespace palpate {

enum class SurfaceDescriptor : std::uint8_t {
  Empty,
  Full,
  Surface,    ///< Full, and shares a face with an empty voxel or with the outside of the grid.
  Proximity,  ///< Empty, and shares a face with a surface voxel.
};

/// One descriptor a voxel, x fastest. `solid`: one byte a voxel, non-zero is full.
[[nodiscard]] std::vector<SurfaceDescriptor> classifySurface(const GridGeometry& geometry,
                                                             std::span<const std::uint8_t> solid);

/// Indices (i, j, k) of the surface voxels in ascending linear order: the points of a voxel body's
/// shell (design: "Between two voxel bodies").
[[nodiscard]] std::vector<std::array<std::int32_t, 3>> surfaceVoxels(
    const GridGeometry& geometry, std::span<const std::uint8_t> solid);

}  // namespace palpate
