#pragma once
/// The surface of a label as chunks, for drawing: VTK's flying edges over 32-voxel chunks, so that
/// an edit re-meshes only what changed.
///
/// What is drawn is smoothed, what is felt is not: the mask is blurred (Gaussian, sigma 0.7 steps)
/// before it is contoured at one half, so that light shades it pleasingly. A flat face stays where
/// the voxel faces are; parts thinner than about one step shrink or vanish in the drawing, though
/// the tool still feels them.

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// Voxels along each side of a chunk, whatever the step.
inline constexpr int kSurfaceChunkVoxels = 32;

/// Float vertices and normals in P, millimetres, interleaved xyz; triangles counter-clockwise from
/// outside. A chunk has vertices of its own; on a border they equal the neighbour's bit for bit.
struct SurfaceChunk {
  std::array<std::int32_t, 3> chunk{0, 0, 0};
  std::vector<float> vertices_mm, normals;
  std::vector<std::uint32_t> triangles;
};

/// `step` 1: full resolution; 2: every second voxel. Normals from the smoothed label field, equal
/// on both sides of a chunk border. Chunks without a surface are left out; a label without voxels
/// gives none. A label that touches the border of the scan is closed there.
/// Same labels, same bits, whatever the number of threads. Any thread; uses TBB's workers.
[[nodiscard]] Result<std::vector<SurfaceChunk>> meshLabel(const LabelGrid& labels,
                                                          std::uint8_t value, int step,
                                                          const Progress& progress = {});

/// Chunks along x, y, z. Chunk c holds the cells between the samples 32c/step - 1 and
/// 32(c+1)/step - 1 along each axis; sample s is voxel s·step.
[[nodiscard]] std::array<std::int32_t, 3> surfaceChunkCounts(const GridGeometry& geometry,
                                                             int step);
/// One chunk again, after an edit: an edited voxel changes the chunks within 5·step voxels of it.
/// Empty where no surface passes.
[[nodiscard]] Result<SurfaceChunk> meshLabelChunk(const LabelGrid& labels, std::uint8_t value,
                                                  int step,
                                                  const std::array<std::int32_t, 3>& chunk);

}  // namespace palpate
