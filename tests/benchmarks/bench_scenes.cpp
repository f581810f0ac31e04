#include "tests/benchmarks/bench_scenes.h"

#include <cmath>

namespace palpate::bench {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kBurr = 4e-3;
constexpr double kShaftRadius = 1.5e-3;
constexpr double kShaftLength = 60e-3;
const Eigen::Vector3d kHalfAxes(42e-3, 38e-3, 40e-3);
const Eigen::Vector3d kCentre = Eigen::Vector3d::Constant(kWorldSize / 2);

// Even points on a body of revolution about z: a spiral of equal areas (golden angle).
void spiral(std::size_t count, double (*radiusAt)(double), double (*zAt)(double),
            Eigen::Vector3d (*normalAt)(double, double), std::vector<Eigen::Vector3d>& points,
            std::vector<Eigen::Vector3d>& normals) {
  const double golden = kPi * (3.0 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double phi = golden * static_cast<double>(i);
    points.emplace_back(radiusAt(t) * std::cos(phi), radiusAt(t) * std::sin(phi), zAt(t));
    normals.push_back(normalAt(t, phi));
  }
}

}  // namespace

LabelGrid bone(int n) {
  LabelGrid grid;
  grid.geometry.dims = {n, n, n};
  const double s = kWorldSize / n;
  grid.geometry.spacing = Eigen::Vector3d::Constant(s);
  grid.labels.resize(grid.geometry.voxelCount());
  std::size_t at = 0;
  const double cell = 2 * kPi / 6e-3;  // a pore every 6 mm
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i, ++at) {
        const Eigen::Vector3d p(s * i, s * j, s * k);
        const Eigen::Vector3d q = (p - kCentre).cwiseQuotient(kHalfAxes);
        const double depth = (1.0 - q.norm()) * kHalfAxes.minCoeff();
        if (depth < 0) continue;
        const double gyroid = std::sin(cell * p.x()) * std::cos(cell * p.y()) +
                              std::sin(cell * p.y()) * std::cos(cell * p.z()) +
                              std::sin(cell * p.z()) * std::cos(cell * p.x());
        grid.labels[at] = depth < 2.5e-3 || std::abs(gyroid) < 0.15 ? 1 : 0;
      }
    }
  }
  return grid;
}

PointShell drill(std::size_t points) {
  const double burrArea = 4 * kPi * kBurr * kBurr;
  const double shaftArea = 2 * kPi * kShaftRadius * kShaftLength;
  const auto burr =
      static_cast<std::size_t>(static_cast<double>(points) * burrArea / (burrArea + shaftArea));
  std::vector<Eigen::Vector3d> p;
  std::vector<Eigen::Vector3d> n;
  spiral(
      burr, [](double t) { return kBurr * std::sqrt(1 - (2 * t - 1) * (2 * t - 1)); },
      [](double t) { return kBurr * (2 * t - 1); },
      [](double t, double phi) {
        const double r = std::sqrt(1 - (2 * t - 1) * (2 * t - 1));
        return Eigen::Vector3d(r * std::cos(phi), r * std::sin(phi), 2 * t - 1);
      },
      p, n);
  spiral(
      points - burr, [](double) { return kShaftRadius; },
      [](double t) { return kBurr + kShaftLength * t; },
      [](double, double phi) { return Eigen::Vector3d(std::cos(phi), std::sin(phi), 0); }, p, n);
  return PointShell::fromPoints(std::move(p), std::move(n)).value();
}

std::vector<Eigen::Isometry3d> slide(double press, int steps) {
  std::vector<Eigen::Isometry3d> poses;
  for (int i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    // Along an arc over the top, tilting and turning as a hand does.
    const double theta = 0.5 * std::sin(2 * kPi * t);
    const double phi = 2 * kPi * t;
    const Eigen::Vector3d out(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                              std::cos(theta));
    const Eigen::Vector3d surface = kCentre + out.cwiseProduct(kHalfAxes);
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = (Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), out) *
                  Eigen::AngleAxisd(3 * phi, Eigen::Vector3d::UnitZ()) *
                  Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
    X.translation() = surface + (kBurr - press) * out;
    poses.push_back(X);
  }
  return poses;
}

}  // namespace palpate::bench
