#include "tests/benchmarks/world.h"

#include <array>
#include <cmath>
#include <thread>

namespace palpate::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kShell = 3e-3;      // thickness of the cortical bone, metres
constexpr double kPore = 6e-3;       // period of the gyroid, metres
constexpr double kWall = 0.08;       // half width of the gyroid's walls, of its range +-1.5
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

void fillSlices(LabelGrid& grid, const std::vector<std::array<double, 2>>& wave, int from, int to) {
  const int n = grid.geometry.dims[0];
  const double s = grid.geometry.spacing.x();
  for (int k = from; k < to; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double d = boneSurface({s * i, s * j, s * k});
        if (d > 0) continue;
        const auto& x = wave[static_cast<std::size_t>(i)];
        const auto& y = wave[static_cast<std::size_t>(j)];
        const auto& z = wave[static_cast<std::size_t>(k)];
        const double gyroid = x[0] * y[1] + y[0] * z[1] + z[0] * x[1];
        if (d > -kShell || std::abs(gyroid) < kWall) grid.labels[grid.geometry.index(i, j, k)] = 1;
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
  LabelGrid grid;
  grid.geometry.dims = {n, n, n};
  const double s = kWorldSize / n;
  grid.geometry.spacing = Eigen::Vector3d::Constant(s);
  grid.labels.resize(grid.geometry.voxelCount());
  std::vector<std::array<double, 2>> wave;
  for (int i = 0; i < n; ++i) {
    const double phase = 2 * kPi / kPore * s * i;
    wave.push_back({std::sin(phase), std::cos(phase)});
  }
  std::thread half([&] { fillSlices(grid, wave, 0, n / 2); });
  fillSlices(grid, wave, n / 2, n);
  half.join();
  return grid;
}

}  // namespace palpate::bench
