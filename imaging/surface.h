#pragma once
/// The surface of a label as chunks, for drawing: VTK's flying edges over 32³-cell chunks, so that
/// an edit re-meshes only what changed.

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Float vertices and normals in P, millimetres, interleaved xyz; triangles counter-clockwise from
/// outside.
struct SurfaceChunk {
  std::array<std::int32_t, 3> chunk{0, 0, 0};
  std::vector<float> vertices_mm, normals;
  std::vector<std::uint32_t> triangles;
};

/// `step` 1: full resolution; 2: every second voxel. Normals from the smoothed label field, equal
/// on both sides of a chunk border.
[[nodiscard]] Result<std::vector<SurfaceChunk>> meshLabel(const LabelGrid& labels,
                                                          std::uint8_t value, int step,
                                                          const Progress& progress = {});

}  // namespace palpate
