#include "ui/grey_normals.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/units.h"

namespace palpate::ui {
namespace {

// Less than cos 66°: the gradient belongs to another edge (thin bone, a cut made by hand).
constexpr double kLeastAgreement = 0.4;
// Share of the gradient: all of it would show the scan's noise.
constexpr double kGreyShare = 0.8;

/// Trilinear value at a continuous voxel index, clamped to the grid.
double sampled(const Volume& volume, const Eigen::Vector3d& voxel) {
  const auto& dims = volume.geometry.dims;
  std::array<int, 3> low{};
  Eigen::Vector3d f;
  for (int a = 0; a < 3; ++a) {
    const int last = dims[static_cast<std::size_t>(a)] - 1;
    const double v = std::clamp(voxel[a], 0.0, static_cast<double>(last));
    low[static_cast<std::size_t>(a)] = std::min(static_cast<int>(v), std::max(0, last - 1));
    f[a] = v - low[static_cast<std::size_t>(a)];
  }
  double sum = 0.0;
  for (int c = 0; c < 8; ++c) {
    const std::array<int, 3> d{c & 1, (c >> 1) & 1, c >> 2};
    double weight = 1.0;
    std::array<std::int32_t, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double part = f[static_cast<Eigen::Index>(a)];
      weight *= d[a] == 1 ? part : 1.0 - part;
      at[a] = std::min(low[a] + d[a], dims[a] - 1);
    }
    if (weight > 0.0) sum += weight * volume.value(volume.geometry.index(at[0], at[1], at[2]));
  }
  return sum;
}

}  // namespace

Eigen::Vector3d greyGradient_P(const Volume& volume, const Eigen::Vector3d& p_P) {
  const GridGeometry& grid = volume.geometry;
  const Eigen::Vector3d voxel = (grid.X_PV.inverse() * p_P).cwiseQuotient(grid.spacing);
  for (int a = 0; a < 3; ++a) {
    if (voxel[a] < -0.5 || voxel[a] > grid.dims[static_cast<std::size_t>(a)] - 0.5) {
      return Eigen::Vector3d::Zero();
    }
  }
  Eigen::Vector3d g;
  for (int a = 0; a < 3; ++a) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    step[a] = 1.0;
    g[a] =
        (sampled(volume, voxel + step) - sampled(volume, voxel - step)) / (2.0 * grid.spacing[a]);
  }
  return grid.X_PV.linear() * g;
}

void shadeByGrey(std::vector<SurfaceChunk>& chunks, const Volume& volume) {
  for (SurfaceChunk& chunk : chunks) {
    for (std::size_t v = 0; v + 2 < chunk.vertices_mm.size(); v += 3) {
      Eigen::Map<Eigen::Vector3f> normal(&chunk.normals[v]);
      const Eigen::Vector3d p =
          Eigen::Map<const Eigen::Vector3f>(&chunk.vertices_mm[v]).cast<double>() *
          kMetresPerMillimetre;
      Eigen::Vector3d g = greyGradient_P(volume, p);
      if (g.norm() <= 0.0) continue;
      g.normalize();
      const Eigen::Vector3d own = normal.cast<double>();
      // Bone is brighter than what surrounds it, air darker: the label says which way is out.
      const double agreement = g.dot(own);
      if (std::abs(agreement) < kLeastAgreement) continue;
      if (agreement < 0.0) g = -g;
      normal = (kGreyShare * g + (1.0 - kGreyShare) * own).normalized().cast<float>();
    }
  }
}

}  // namespace palpate::ui
