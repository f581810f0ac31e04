#pragma once
/// What the leaves of a tree carry: normals and depths of voxels, bricks of signed distance.

#include <cstdint>
#include <span>
#include <vector>

#include "core/voxels/label_grid.h"
#include "core/voxels/tree_topology.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// Outward unit normal at a voxel's centre: the gradient of the signed distance by central
/// differences, smoothed 1-2-1 across each (Sobel), for a distance between voxel centres jumps from
/// one to the next; one-sided at the grid's faces. Where it vanishes (a sheet of one voxel, a
/// single voxel) the forward differences decide, and +z where these vanish too.
[[nodiscard]] Eigen::Vector3d outwardNormal(const GridGeometry& geometry,
                                            std::span<const float> field, std::int32_t i,
                                            std::int32_t j, std::int32_t k);

/// Fills leafLabel, leafNormal and leafDepth of voxel leaves.
void fillVoxelPayload(const LabelGrid& grid, std::span<const float> field,
                      const TreeTopology& topology, VoxelTree::Data& data);

/// Fills the bricks of distance leaves. `solid` says which voxels are inside.
void fillBricks(const LabelGrid& grid, std::span<const std::uint8_t> solid,
                std::span<const float> field, const TreeTopology& topology, VoxelTree::Data& data);

}  // namespace palpate
