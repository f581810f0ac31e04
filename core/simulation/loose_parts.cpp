#include "core/simulation/loose_parts.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace palpate {
namespace {

constexpr std::int32_t kMargin = 2;  // a distance leaf reads a voxel beyond the surface

using Voxel = std::array<std::int32_t, 3>;

/// Takes the part that holds `start` out of `left`, the linear indices of all its voxels.
std::vector<std::size_t> takePart(const GridGeometry& g, std::vector<std::uint8_t>& left,
                                  std::size_t start) {
  std::vector<std::size_t> part = {start};
  left[start] = 0;
  const auto nx = static_cast<std::size_t>(g.dims[0]), ny = static_cast<std::size_t>(g.dims[1]);
  for (std::size_t done = 0; done < part.size(); ++done) {
    const std::size_t at = part[done];
    const Voxel v = {static_cast<std::int32_t>(at % nx), static_cast<std::int32_t>(at / nx % ny),
                     static_cast<std::int32_t>(at / (nx * ny))};
    for (std::int32_t n = 0; n < 27; ++n) {
      const Voxel near = {v[0] + n % 3 - 1, v[1] + n / 3 % 3 - 1, v[2] + n / 9 - 1};
      if (!g.contains(near[0], near[1], near[2])) continue;
      const std::size_t index = g.index(near[0], near[1], near[2]);
      if (left[index] == 0) continue;
      left[index] = 0;
      part.push_back(index);
    }
  }
  return part;
}

LabelGrid cutOut(const GridGeometry& g, const std::vector<std::size_t>& part, std::uint8_t value) {
  const auto nx = static_cast<std::size_t>(g.dims[0]), ny = static_cast<std::size_t>(g.dims[1]);
  const auto voxelOf = [nx, ny](std::size_t at) {
    return Voxel{static_cast<std::int32_t>(at % nx), static_cast<std::int32_t>(at / nx % ny),
                 static_cast<std::int32_t>(at / (nx * ny))};
  };
  Voxel low = voxelOf(part.front()), high = low;
  for (const std::size_t at : part) {
    const Voxel v = voxelOf(at);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], v[axis]);
      high[axis] = std::max(high[axis], v[axis]);
    }
  }
  LabelGrid out;
  out.geometry = g;
  Eigen::Vector3d corner;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] -= kMargin;
    out.geometry.dims[axis] = high[axis] + kMargin + 1 - low[axis];
    corner[static_cast<Eigen::Index>(axis)] = low[axis];
  }
  out.geometry.X_PV.translation() = g.X_PV * g.spacing.cwiseProduct(corner);
  out.labels.assign(out.geometry.voxelCount(), 0);
  for (const std::size_t at : part) {
    const Voxel v = voxelOf(at);
    out.labels[out.geometry.index(v[0] - low[0], v[1] - low[1], v[2] - low[2])] = value;
  }
  return out;
}

}  // namespace

std::vector<LabelGrid> looseParts(const LabelGrid& grid, std::uint8_t value,
                                  const SceneBody& body) {
  const GridGeometry& g = grid.geometry;
  std::vector<std::uint8_t> left(grid.labels.size());
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (grid.labels[i] != value) continue;
    left[i] = 1;
    all.push_back(i);
  }
  const double least = body.leastVolume_mm3 * 1e-9;
  const auto largeEnough = [&g, least](const std::vector<std::size_t>& part) {
    return static_cast<double>(part.size()) * g.spacing.prod() >= least;
  };
  std::vector<LabelGrid> parts;
  if (!body.separate) {
    if (!all.empty() && largeEnough(all)) parts.push_back(cutOut(g, all, value));
    return parts;
  }
  for (const std::size_t start : all) {
    if (left[start] == 0) continue;
    std::vector<std::size_t> part = takePart(g, left, start);
    if (largeEnough(part)) parts.push_back(cutOut(g, part, value));
  }
  return parts;
}

}  // namespace palpate
