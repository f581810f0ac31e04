#pragma once
/// Squared distances between voxel centres by plain loops: the oracle of everything that is made
/// of them. Shares no code with core.

#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "core/voxels/depth_palette.h"
#include "core/voxels/voxel_bits.h"
#include "tests/core/voxels/test_volumes.h"

namespace palpate::testing_volumes {

inline constexpr float kNoOther = std::numeric_limits<float>::infinity();

/// Voxels inside, one bit each.
inline VoxelBits bitsOf(const LabelGrid& grid) {
  VoxelBits bits(grid.geometry.dims);
  for (std::int32_t k = 0; k < grid.geometry.dims[2]; ++k) {
    for (std::int32_t j = 0; j < grid.geometry.dims[1]; ++j) {
      for (std::int32_t i = 0; i < grid.geometry.dims[0]; ++i) {
        if (grid.at(i, j, k) != 0) bits.set(i, j, k);
      }
    }
  }
  return bits;
}

/// From each voxel's centre to the nearest centre where `wanted(label)`, squared, in the palette's
/// unit; infinite where there is none. The minimum of a sum of three terms is taken axis by axis,
/// each voxel against all others of its line; sums of single precision as (x + y) + z, which are
/// monotone, so the minimum is that over all pairs to the bit.
template <class F>
std::vector<float> nearestSquares(const LabelGrid& grid, const std::array<float, 3>& weight,
                                  F&& wanted) {
  const GridGeometry& g = grid.geometry;
  std::vector<float> now(g.voxelCount());
  for (std::size_t v = 0; v < now.size(); ++v) now[v] = wanted(grid.labels[v]) ? 0.0f : kNoOther;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::vector<float> before = now;
    const std::size_t stride =
        a == 0   ? 1
        : a == 1 ? static_cast<std::size_t>(g.dims[0])
                 : static_cast<std::size_t>(g.dims[0]) * static_cast<std::size_t>(g.dims[1]);
    for (std::size_t v = 0; v < now.size(); ++v) {
      const auto at = static_cast<std::int32_t>(v / stride % static_cast<std::size_t>(g.dims[a]));
      const std::size_t line = v - static_cast<std::size_t>(at) * stride;
      float best = kNoOther;
      for (std::int32_t o = 0; o < g.dims[a]; ++o) {
        const auto step = static_cast<float>((o - at) * (o - at));
        best =
            std::min(best, before[line + static_cast<std::size_t>(o) * stride] + weight[a] * step);
      }
      now[v] = best;
    }
  }
  return now;
}

/// Signed: > 0 outside (to the nearest inside), < 0 inside; ± infinite in a grid of one kind.
inline std::vector<float> signedSquares(const LabelGrid& grid, const std::array<float, 3>& weight) {
  const auto toInside = nearestSquares(grid, weight, [](std::uint8_t l) { return l != 0; });
  const auto toOutside = nearestSquares(grid, weight, [](std::uint8_t l) { return l == 0; });
  std::vector<float> out(toInside.size());
  for (std::size_t v = 0; v < out.size(); ++v) {
    out[v] = grid.labels[v] != 0 ? -toOutside[v] : toInside[v];
  }
  return out;
}

/// Signed D in smallest spacings.
inline double depthOf(float signedSquare) {
  const double d = std::sqrt(std::abs(static_cast<double>(signedSquare))) - 0.5;
  return signedSquare > 0 ? d : -d;
}

/// Bone in small: a shell with pores and struts inside, in blobs; nothing is straight.
inline LabelGrid boneLike(std::int32_t side, const Eigen::Vector3d& spacing, std::uint32_t seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(0.5 * (side - 1));
  double phase[3];
  for (double& p : phase) p = 6.28 * uniform(rng);
  return makeGrid({side, side + 3, side - 2}, spacing, [&](int i, int j, int k) {
    const Eigen::Vector3d p = Eigen::Vector3d(i, j, k) - middle;
    const double r = p.norm() / (0.46 * side) +
                     0.1 * std::sin(4 * std::atan2(p.y(), p.x()) + phase[0] + 0.2 * p.z());
    if (r > 1) return 0;
    if (r > 0.8) return uniform(rng) < 0.02 ? 0 : 1;
    const double strut = std::sin(0.55 * i + phase[0]) * std::sin(0.6 * j + phase[1]) +
                         std::sin(0.5 * k + phase[2]) * std::sin(0.45 * i);
    return strut > 0.35 ? 2 : 0;
  });
}

inline LabelGrid ballGrid(std::int32_t side, const Eigen::Vector3d& spacing, double radius) {
  const Eigen::Vector3d c = 0.5 * (side - 1) * spacing;
  return makeGrid({side, side, side}, spacing, [&](int i, int j, int k) {
    return (Eigen::Vector3d(i, j, k).cwiseProduct(spacing) - c).norm() < radius ? 1 : 0;
  });
}

/// assortedGrids, and larger ones with interiors deeper than what is stored.
inline std::vector<NamedGrid> assortedAndDeepGrids(std::uint32_t seed) {
  auto all = assortedGrids(seed);
  const Eigen::Vector3d iso = Eigen::Vector3d::Constant(0.7e-3);
  const Eigen::Vector3d aniso(0.7e-3, 0.6e-3, 1.1e-3);
  all.push_back({"ball of 21 voxels", ballGrid(50, iso, 21.3 * 0.7e-3)});
  all.push_back({"deep anisotropic ball", ballGrid(46, aniso, 19 * 0.6e-3)});
  all.push_back({"bone", boneLike(44, iso, seed)});
  all.push_back({"anisotropic bone", boneLike(40, aniso, seed + 1)});
  std::mt19937 rng(seed);
  all.push_back({"deep cheese", makeGrid({64, 50, 42}, iso, [&rng](int, int, int) {
                   return rng() % 30000 < 1 ? 0 : 1 + static_cast<int>(rng() % 2);
                 })});
  all.push_back({"dust", makeGrid({41, 40, 47}, aniso,
                                  [&rng](int, int, int) { return rng() % 4000 < 1 ? 3 : 0; })});
  return all;
}

}  // namespace palpate::testing_volumes
