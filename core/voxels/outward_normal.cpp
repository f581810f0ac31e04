#include "core/voxels/outward_normal.h"

namespace palpate {
namespace {

// A gradient of a distance has length 1 where it exists; below this share of the largest
// difference that there could be it is a balance of sides.
constexpr double kNoDirection = 1e-6;

constexpr int kStride[3] = {1, 3, 9};

// Difference along each axis between two planes, 1-2-1 across.
Eigen::Vector3d difference(const Neighbourhood& around, const Eigen::Vector3d& spacing, int back,
                           int ahead) noexcept {
  constexpr double kWeight[3] = {0.25, 0.5, 0.25};
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const int steps = (around.above[a] ? ahead : 0) - (around.below[a] ? back : 0);
    if (steps == 0) continue;
    double sum = 0.0;
    for (int u = 0; u < 3; ++u) {
      for (int v = 0; v < 3; ++v) {
        const int line = u * kStride[(axis + 1) % 3] + v * kStride[(axis + 2) % 3];
        sum += kWeight[u] * kWeight[v] *
               (around.value[static_cast<std::size_t>(line + (1 + ahead) * kStride[axis])] -
                around.value[static_cast<std::size_t>(line + (1 + back) * kStride[axis])]);
      }
    }
    g[axis] = sum / (steps * spacing[axis]);
  }
  return g;
}

}  // namespace

Eigen::Vector3d outwardNormal(const Neighbourhood& around,
                              const Eigen::Vector3d& spacing) noexcept {
  Eigen::Vector3d g = difference(around, spacing, -1, 1);
  if (g.norm() < kNoDirection) g = difference(around, spacing, 0, 1);
  if (g.norm() < kNoDirection) return Eigen::Vector3d::UnitZ();
  return g.normalized();
}

Eigen::Vector3d outwardNormal(const GridGeometry& geometry, std::span<const float> field,
                              std::int32_t i, std::int32_t j, std::int32_t k) {
  return outwardNormal(
      neighbourhoodOf({i, j, k}, geometry.dims,
                      [&](const std::array<std::int32_t, 3>& at) {
                        return static_cast<double>(field[geometry.index(at[0], at[1], at[2])]);
                      }),
      geometry.spacing);
}

}  // namespace palpate
