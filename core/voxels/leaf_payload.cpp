#include "core/voxels/leaf_payload.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace palpate {
namespace {

// A gradient of a distance has length 1 where it exists; below this it is a balance of sides.
constexpr double kNoDirection = 1e-6;

using Address = std::array<std::int32_t, 3>;

template <int Bits>
void fillVoxels(const LabelGrid& grid, std::span<const float> field, const TreeTopology& topology,
                VoxelTree::Data& data) {
  using Mask = NodeMask<Bits>;
  const TreeLevel& level = data.level[1];
  const auto& nodes = topology.address[1];
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      std::size_t leaf = level.firstChild[n];
      forEachChild(Mask::load(level.masks.data(), n), [&](int c) {
        const std::int32_t i = nodes[n][0] * Mask::kEdge + (c & Mask::kLow);
        const std::int32_t j = nodes[n][1] * Mask::kEdge + ((c >> Bits) & Mask::kLow);
        const std::int32_t k = nodes[n][2] * Mask::kEdge + (c >> (2 * Bits));
        const std::size_t at = grid.geometry.index(i, j, k);
        data.leafLabel[leaf] = grid.labels[at];
        data.leafNormal[leaf] = encodeNormal(outwardNormal(grid.geometry, field, i, j, k));
        data.leafDepth[leaf] = -field[at];
        ++leaf;
      });
    }
  });
}

std::uint8_t onlyLabel(const LabelGrid& grid, std::span<const std::uint8_t> solid) {
  std::uint8_t only = 0;
  for (std::size_t i = 0; i < solid.size(); ++i) {
    if (solid[i] == 0 || grid.labels[i] == only) continue;
    if (only != 0) return 0;
    only = grid.labels[i];
  }
  return only;
}

}  // namespace

Eigen::Vector3d outwardNormal(const GridGeometry& geometry, std::span<const float> field,
                              std::int32_t i, std::int32_t j, std::int32_t k) {
  const Address at{i, j, k};
  double value[27];  // the neighbourhood, x fastest; beyond the grid its edge
  for (std::int32_t n = 0; n < 27; ++n) {
    const Address step{n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    Address p;
    for (std::size_t a = 0; a < 3; ++a) {
      p[a] = std::clamp(at[a] + step[a], 0, geometry.dims[a] - 1);
    }
    value[n] = static_cast<double>(field[geometry.index(p[0], p[1], p[2])]);
  }
  constexpr int kStride[3] = {1, 3, 9};
  constexpr double kWeight[3] = {0.25, 0.5, 0.25};
  // Difference along each axis between two planes, 1-2-1 across.
  const auto difference = [&](int back, int ahead) {
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const int steps = (at[a] + 1 < geometry.dims[a] ? ahead : 0) - (at[a] > 0 ? back : 0);
      if (steps == 0) continue;
      double sum = 0.0;
      for (int u = 0; u < 3; ++u) {
        for (int v = 0; v < 3; ++v) {
          const int line = u * kStride[(axis + 1) % 3] + v * kStride[(axis + 2) % 3];
          sum += kWeight[u] * kWeight[v] *
                 (value[line + (1 + ahead) * kStride[axis]] -
                  value[line + (1 + back) * kStride[axis]]);
        }
      }
      g[axis] = sum / (steps * geometry.spacing[axis]);
    }
    return g;
  };
  Eigen::Vector3d g = difference(-1, 1);
  if (g.norm() < kNoDirection) g = difference(0, 1);
  if (g.norm() < kNoDirection) return Eigen::Vector3d::UnitZ();
  return g.normalized();
}

void fillVoxelPayload(const LabelGrid& grid, std::span<const float> field,
                      const TreeTopology& topology, VoxelTree::Data& data) {
  data.leafLabel.resize(topology.leaves);
  data.leafNormal.resize(topology.leaves);
  data.leafDepth.resize(topology.leaves);
  switch (data.bits) {
    case 1:
      return fillVoxels<1>(grid, field, topology, data);
    case 2:
      return fillVoxels<2>(grid, field, topology, data);
    default:
      return fillVoxels<3>(grid, field, topology, data);
  }
}

void fillBricks(const LabelGrid& grid, std::span<const std::uint8_t> solid,
                std::span<const float> field, const TreeTopology& topology, VoxelTree::Data& data) {
  data.brickLevel = brickLevelOf(data.bits, data.levels);
  data.brickEdge = 1 << (data.bits * data.brickLevel);
  data.uniformLabel = onlyLabel(grid, solid);
  const auto& nodes = topology.address[static_cast<std::size_t>(data.brickLevel)];
  const std::size_t size = data.brickSize();
  data.brick.resize(nodes.size() * size);
  if (data.uniformLabel == 0) data.brickLabel.resize(nodes.size() * size);
  const GridGeometry& g = grid.geometry;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      std::size_t to = n * size;
      for (std::int32_t z = 0; z <= data.brickEdge; ++z) {
        for (std::int32_t y = 0; y <= data.brickEdge; ++y) {
          for (std::int32_t x = 0; x <= data.brickEdge; ++x, ++to) {
            // Beyond the grid there is no cell to interpolate in; the edge value is as good as any.
            const std::size_t from =
                g.index(std::min(nodes[n][0] * data.brickEdge + x, g.dims[0] - 1),
                        std::min(nodes[n][1] * data.brickEdge + y, g.dims[1] - 1),
                        std::min(nodes[n][2] * data.brickEdge + z, g.dims[2] - 1));
            data.brick[to] = field[from];
            if (data.uniformLabel == 0) {
              data.brickLabel[to] = solid[from] != 0 ? grid.labels[from] : std::uint8_t{0};
            }
          }
        }
      }
    }
  });
}

}  // namespace palpate
