#pragma once
/// The contact region by its definition, and how far it is from a point: the oracle of clearances.
///
/// Values are trilinear between the exhaustive distances; the region is where they are negative.
/// Cells are tried one after the other; in a mixed cell the nearest of a lattice of points of the
/// region is walked towards the place that asks. What comes out is the distance to a point that is
/// in the region, so it never lies below the true one.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/core/voxels/exhaustive_distance.h"

namespace palpate::testing_volumes {

class ContactRegion {
 public:
  explicit ContactRegion(const LabelGrid& grid)
      : dims_(grid.geometry.dims), edge_(grid.geometry.spacing / grid.geometry.spacing.minCoeff()) {
    const DepthPalette palette(grid.geometry.spacing);
    for (const float square : signedSquares(grid, palette.weight())) {
      depth_.push_back(std::clamp(depthOf(square), -1e3, 1e3));
    }
    for (int k = 0; k + 1 < dims_[2]; ++k) {
      for (int j = 0; j + 1 < dims_[1]; ++j) {
        for (int i = 0; i + 1 < dims_[0]; ++i) {
          const int inside = insideCorners(i, j, k);
          if (inside == 0) continue;
          if (inside < 8) {
            mixed_.push_back({i, j, k});
          } else if (insideCorners(i - 1, j, k) != 8 || insideCorners(i + 1, j, k) != 8 ||
                     insideCorners(i, j - 1, k) != 8 || insideCorners(i, j + 1, k) != 8 ||
                     insideCorners(i, j, k - 1) != 8 || insideCorners(i, j, k + 1) != 8) {
            full_.push_back({i, j, k});  // all of it is in the region; others are behind these
          }
        }
      }
    }
  }

  [[nodiscard]] const Eigen::Vector3d& edge() const { return edge_; }
  [[nodiscard]] double depth(int i, int j, int k) const {
    return depth_[static_cast<std::size_t>(i + dims_[0] * (j + dims_[1] * k))];
  }
  [[nodiscard]] bool hasCornerInside(int i, int j, int k) const {
    return insideCorners(i, j, k) > 0;
  }

  /// Value at u (cells), with u in this cell.
  [[nodiscard]] double value(const std::array<int, 3>& cell, const Eigen::Vector3d& u) const {
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      double weight = 1;
      for (int a = 0; a < 3; ++a) {
        const double w = u[a] - cell[static_cast<std::size_t>(a)];
        weight *= (c >> a & 1) != 0 ? w : 1 - w;
      }
      sum += weight * depth(cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2));
    }
    return sum;
  }

  /// From u (cells, anywhere in space) to the region, smallest spacings; at least the true one.
  [[nodiscard]] double distance(const Eigen::Vector3d& u) const {
    double best = HUGE_VAL;
    std::array<int, 3> own{};
    bool inGrid = true;
    for (std::size_t a = 0; a < 3; ++a) {
      const double x = u[static_cast<Eigen::Index>(a)];
      inGrid = inGrid && x >= 0 && x <= dims_[a] - 1;
      own[a] = std::clamp(static_cast<int>(std::floor(x)), 0, dims_[a] - 2);
    }
    if (inGrid && value(own, u) < 0) return 0;
    for (const auto& cell : full_) best = std::min(best, boxDistance2(cell, u));
    for (const auto& cell : mixed_) {
      for (int c = 0; c < 8; ++c) {
        const int i = cell[0] + (c & 1), j = cell[1] + (c >> 1 & 1), k = cell[2] + (c >> 2);
        if (depth(i, j, k) >= 0) continue;
        best = std::min(best, (Eigen::Vector3d(i, j, k) - u).cwiseProduct(edge_).squaredNorm());
      }
    }
    for (const auto& cell : mixed_) {
      if (boxDistance2(cell, u) < best) best = std::min(best, mixedDistance2(cell, u, best));
    }
    return std::sqrt(best);
  }

 private:
  [[nodiscard]] int insideCorners(int i, int j, int k) const {
    if (i < 0 || j < 0 || k < 0 || i + 1 >= dims_[0] || j + 1 >= dims_[1] || k + 1 >= dims_[2]) {
      return 0;
    }
    int inside = 0;
    for (int c = 0; c < 8; ++c) {
      inside += depth(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)) < 0 ? 1 : 0;
    }
    return inside;
  }
  [[nodiscard]] double boxDistance2(const std::array<int, 3>& cell,
                                    const Eigen::Vector3d& u) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const int lo = cell[static_cast<std::size_t>(a)];
      const double d = std::max({lo - u[a], u[a] - lo - 1, 0.0}) * edge_[a];
      sum += d * d;
    }
    return sum;
  }
  [[nodiscard]] double mixedDistance2(const std::array<int, 3>& cell, const Eigen::Vector3d& u,
                                      double best) const {
    constexpr int kSteps = 5;
    const Eigen::Vector3d low(cell[0], cell[1], cell[2]);
    for (int s = 0; s < (kSteps + 1) * (kSteps + 1) * (kSteps + 1); ++s) {
      Eigen::Vector3d p(s % (kSteps + 1), s / (kSteps + 1) % (kSteps + 1),
                        s / ((kSteps + 1) * (kSteps + 1)));
      p = low + p / kSteps;
      const double d2 = (p - u).cwiseProduct(edge_).squaredNorm();
      if (std::sqrt(d2) > std::sqrt(best) + 0.35 * edge_.maxCoeff()) continue;
      if (value(cell, p) >= 0) continue;
      // Towards u as long as the value is negative and the cell is not left.
      double in = 0, out = 1;
      for (int a = 0; a < 3; ++a) {
        const double step = u[a] - p[a];
        if (step > 0) out = std::min(out, (low[a] + 1 - p[a]) / step);
        if (step < 0) out = std::min(out, (low[a] - p[a]) / step);
      }
      if (value(cell, p + out * (u - p)) < 0) {
        in = out;
      } else {
        for (int n = 0; n < 20; ++n) {
          const double mid = 0.5 * (in + out);
          (value(cell, p + mid * (u - p)) < 0 ? in : out) = mid;
        }
      }
      best = std::min(best, (1 - in) * (1 - in) * d2);
    }
    return best;
  }

  std::array<std::int32_t, 3> dims_;
  Eigen::Vector3d edge_;
  std::vector<double> depth_;
  std::vector<std::array<int, 3>> mixed_, full_;
};

/// A random place in a box of cells, its corners and faces now and then.
inline Eigen::Vector3d placeIn(std::mt19937& rng, const std::array<int, 3>& low, int cells) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Vector3d u;
  const bool corner = rng() % 3 == 0;
  for (int a = 0; a < 3; ++a) {
    const double w = corner || rng() % 6 == 0 ? static_cast<double>(rng() % 2) : uniform(rng);
    u[a] = low[static_cast<std::size_t>(a)] + w * cells;
  }
  return u;
}

}  // namespace palpate::testing_volumes
