#pragma once
/// The surface of one label as a single mesh, for files.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Patient frame, LPS, millimetres; triangles counter-clockwise seen from outside.
struct SurfaceMesh {
  std::vector<Eigen::Vector3f> vertices_mm;
  std::vector<Eigen::Vector3f> normals;  ///< Unit, outward, one a vertex; empty in a mesh read in.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Vertices of the same bits become one, and triangles without a side vanish.
void weld(SurfaceMesh& mesh);

/// The surface that the window draws at full detail (imaging/surface.h), its chunks made one closed
/// mesh. Refused: a label without voxels, or too thin to have a surface once smoothed.
[[nodiscard]] Result<SurfaceMesh> labelSurface(const LabelGrid& labels, std::uint8_t value,
                                               const Progress& progress = {});

}  // namespace palpate
