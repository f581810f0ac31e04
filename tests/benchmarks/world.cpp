#include "tests/benchmarks/world.h"

#include <array>
#include <cmath>
#include <thread>

namespace palpate::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kShell = 2.6e-3;    // thickness of the cortical bone, metres
constexpr double kPore = 26e-3;      // period of the gyroid, metres
constexpr double kWall = 0.2;        // half width of the gyroid's walls, of its range +-1.5
constexpr double kRounding = 10e-3;  // radius of the box's edges, metres
const Eigen::Vector3d kHalf(39e-3, 37e-3, kBoneTop);

const Eigen::Matrix3d& turn() {
  static const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.21, Eigen::Vector3d::UnitX()) *
                                    Eigen::AngleAxisd(-0.13, Eigen::Vector3d::UnitY()) *
                                    Eigen::AngleAxisd(0.17, Eigen::Vector3d::UnitZ()))
                                       .toRotationMatrix();
  return R;
}

double roundedBox(const Eigen::Vector3d& q) {
  const Eigen::Vector3d d = q.cwiseAbs() - (kHalf - Eigen::Vector3d::Constant(kRounding));
  const double outside = d.cwiseMax(0.0).norm();
  return outside + std::min(d.maxCoeff(), 0.0) - kRounding;
}

using Waves = std::array<std::vector<std::array<double, 2>>, 3>;  // sine and cosine along each axis

void fillSlices(LabelGrid& grid, const Waves& wave, int from, int to) {
  const auto& g = grid.geometry;
  for (int k = from; k < to; ++k) {
    for (int j = 0; j < g.dims[1]; ++j) {
      for (int i = 0; i < g.dims[0]; ++i) {
        const double d = boneSurface(g.centre_V(i, j, k));
        if (d > 0) continue;
        const auto& x = wave[0][static_cast<std::size_t>(i)];
        const auto& y = wave[1][static_cast<std::size_t>(j)];
        const auto& z = wave[2][static_cast<std::size_t>(k)];
        const double gyroid = x[0] * y[1] + y[0] * z[1] + z[0] * x[1];
        if (d > -kShell || std::abs(gyroid) < kWall) grid.labels[g.index(i, j, k)] = 1;
      }
    }
  }
}

}  // namespace

Eigen::Isometry3d boneFrame() {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = turn();
  X.translation() = Eigen::Vector3d::Constant(0.5 * kWorldSize);
  return X;
}

double boneSurface(const Eigen::Vector3d& p_V) {
  return roundedBox(turn().transpose() * (p_V - Eigen::Vector3d::Constant(0.5 * kWorldSize)));
}

LabelGrid syntheticBone(int n) {
  return syntheticBone(n, n, n);
}

LabelGrid syntheticBone(int nx, int ny, int nz) {
  LabelGrid grid;
  grid.geometry.dims = {nx, ny, nz};
  grid.geometry.spacing = kWorldSize * Eigen::Vector3d(1.0 / nx, 1.0 / ny, 1.0 / nz);
  grid.labels.resize(grid.geometry.voxelCount());
  Waves waves;
  for (std::size_t a = 0; a < 3; ++a) {
    const double s = grid.geometry.spacing[static_cast<Eigen::Index>(a)];
    for (int i = 0; i < grid.geometry.dims[a]; ++i) {
      const double phase = 2 * kPi / kPore * s * i;
      waves[a].push_back({std::sin(phase), std::cos(phase)});
    }
  }
  std::thread half([&] { fillSlices(grid, waves, 0, nz / 2); });
  fillSlices(grid, waves, nz / 2, nz);
  half.join();
  return grid;
}

}  // namespace palpate::bench
