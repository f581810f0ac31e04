#include "tests/core/collision/oracle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::oracle {

std::vector<double> signedDistances(const LabelGrid& grid) {
  const GridGeometry& g = grid.geometry;
  std::vector<Eigen::Vector3d> kind[2];
  for (int k = 0; k < g.dims[2]; ++k) {
    for (int j = 0; j < g.dims[1]; ++j) {
      for (int i = 0; i < g.dims[0]; ++i) {
        kind[grid.at(i, j, k) != 0 ? 1 : 0].emplace_back(i * g.spacing.x(), j * g.spacing.y(),
                                                         k * g.spacing.z());
      }
    }
  }
  const double s = std::min({g.spacing.x(), g.spacing.y(), g.spacing.z()});
  std::vector<double> out;
  for (int k = 0; k < g.dims[2]; ++k) {
    for (int j = 0; j < g.dims[1]; ++j) {
      for (int i = 0; i < g.dims[0]; ++i) {
        const bool inside = grid.at(i, j, k) != 0;
        const Eigen::Vector3d c(i * g.spacing.x(), j * g.spacing.y(), k * g.spacing.z());
        double best = HUGE_VAL;
        for (const auto& o : kind[inside ? 0 : 1]) best = std::min(best, (o - c).squaredNorm());
        const double d = std::sqrt(best) - s / 2;
        out.push_back(inside ? -d : d);
      }
    }
  }
  return out;
}

Truth contactAt(const LabelGrid& grid, const std::vector<double>& distance, LeafModel leaf,
                const Eigen::Vector3d& p_V) {
  const GridGeometry& g = grid.geometry;
  const auto at = [&](int i, int j, int k) {
    return static_cast<std::size_t>(i + g.dims[0] * (j + g.dims[1] * k));
  };
  double u[3];
  for (int a = 0; a < 3; ++a) u[a] = p_V[a] / g.spacing[a];
  if (leaf == LeafModel::Voxel) {
    int v[3];
    for (int a = 0; a < 3; ++a) {
      const double cell = std::floor(u[a] + 0.5);
      if (!(cell >= 0 && cell < g.dims[static_cast<std::size_t>(a)])) return {};
      v[a] = static_cast<int>(cell);
    }
    return {grid.labels[at(v[0], v[1], v[2])] != 0, 0.0};
  }
  int lo[3];
  for (int a = 0; a < 3; ++a) {
    const int last = g.dims[static_cast<std::size_t>(a)] - 1;
    if (!(u[a] >= 0 && u[a] <= last)) return {};
    lo[a] = std::min(static_cast<int>(std::floor(u[a])), last - 1);
  }
  double value = 0;
  for (int c = 0; c < 8; ++c) {
    double weight = 1;
    int v[3];
    for (int a = 0; a < 3; ++a) {
      const bool upper = ((c >> a) & 1) != 0;
      v[a] = lo[a] + (upper ? 1 : 0);
      weight *= upper ? u[a] - lo[a] : 1 - (u[a] - lo[a]);
    }
    if (weight != 0) value += weight * distance[at(v[0], v[1], v[2])];
  }
  return {value < 0, value};
}

Eigen::Isometry3d randomPose(std::mt19937& rng, const Eigen::Vector3d& around, double spread) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-spread, spread);
  Eigen::Quaterniond q(normal(rng), normal(rng), normal(rng), normal(rng));
  q.normalize();
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = q.toRotationMatrix();
  X.translation() = around + Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng));
  return X;
}

PointShell randomShell(std::mt19937& rng, std::size_t count, const Eigen::Vector3d& half) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)).cwiseProduct(half));
    normals.emplace_back(normal(rng), normal(rng), normal(rng) + 1e-3);
  }
  return PointShell::fromPoints(points, normals).value();
}

Eigen::Vector3d middleOf(const GridGeometry& g) {
  return 0.5 * g.centre_V(g.dims[0] - 1, g.dims[1] - 1, g.dims[2] - 1);
}

std::vector<Contact> findAll(const VoxelTree& tree, const PointShell& shell,
                             const QueryOptions& options, const Eigen::Isometry3d& X_VT) {
  ContactFinder finder(tree, shell, options);
  std::vector<Contact> out(shell.size());
  const QueryResult result = finder.find(X_VT, out);
  EXPECT_NE(result.status, QueryStatus::BadPose);
  EXPECT_NE(result.status, QueryStatus::OutputFull);
  out.resize(result.contactCount);
  return out;
}

}  // namespace palpate::oracle
