#pragma once
/// The voxels inside a closed surface.
///
/// A voxel belongs to the label when a ray from its centre crosses the surface an odd number of
/// times: so holes inside a body stay holes, and where two bodies of one file overlap there is
/// none. Corners are rounded to 2^-20 voxel and crossings then decided in whole numbers, so that no
/// ray slips through an edge; the same file gives the same voxels.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/geometry/grid_geometry.h"
#include "imaging/exchange/label_surface.h"

namespace palpate {

/// Edges that an odd number of triangles share: 0 in a closed surface.
[[nodiscard]] std::size_t openEdges(const SurfaceMesh& mesh);

struct InsideVoxels {
  std::vector<std::uint8_t> mask;  ///< 1 inside, else 0; as the grid's voxels.
  bool reachesOut = false;         ///< A part of the surface lies outside the volume, and is cut.
};

/// Refused, in the name of `file`: an open surface, a vertex further than 2^24 voxels away, a
/// surface that holds no voxel centre, one that crosses more than 2^31 rows of voxels.
[[nodiscard]] Result<InsideVoxels> voxelsInside(const SurfaceMesh& mesh,
                                                const GridGeometry& geometry,
                                                const std::filesystem::path& file,
                                                const Progress& progress = {});

}  // namespace palpate
