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
#include <map>
#include <utility>
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
    std::map<std::array<int, 3>, Bin> bins;
    for (int k = 0; k + 1 < dims_[2]; ++k) {
      for (int j = 0; j + 1 < dims_[1]; ++j) {
        for (int i = 0; i + 1 < dims_[0]; ++i) {
          const int inside = insideCorners(i, j, k);
          if (inside == 0) continue;
          // What is inside all over is in the region; others like it hide behind those with a
          // neighbour that is not.
          if (inside == 8 && insideCorners(i - 1, j, k) == 8 && insideCorners(i + 1, j, k) == 8 &&
              insideCorners(i, j - 1, k) == 8 && insideCorners(i, j + 1, k) == 8 &&
              insideCorners(i, j, k - 1) == 8 && insideCorners(i, j, k + 1) == 8) {
            continue;
          }
          Bin& bin = bins[{i / kBin, j / kBin, k / kBin}];
          bin.low = {i / kBin * kBin, j / kBin * kBin, k / kBin * kBin};
          bin.cells.push_back({{i, j, k}, inside == 8});
        }
      }
    }
    for (auto& [at, bin] : bins) bins_.push_back(std::move(bin));
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
    const Bin* nearest = nullptr;
    double least = HUGE_VAL;
    for (const Bin& bin : bins_) {
      const double d2 = boxDistance2(bin.low, u, kBin);
      if (d2 >= least) continue;
      least = d2;
      nearest = &bin;
    }
    if (nearest != nullptr) best = binDistance2(*nearest, u, best);
    for (const Bin& bin : bins_) {
      if (boxDistance2(bin.low, u, kBin) < best) best = binDistance2(bin, u, best);
    }
    return std::sqrt(best);
  }

 private:
  static constexpr int kBin = 4;
  struct Bin {
    std::array<int, 3> low{};
    std::vector<std::pair<std::array<int, 3>, bool>> cells;  // and: inside all over
  };

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
  [[nodiscard]] double boxDistance2(const std::array<int, 3>& cell, const Eigen::Vector3d& u,
                                    int cells = 1) const {
    double sum = 0;
    for (int a = 0; a < 3; ++a) {
      const int lo = cell[static_cast<std::size_t>(a)];
      const double d = std::max({lo - u[a], u[a] - lo - cells, 0.0}) * edge_[a];
      sum += d * d;
    }
    return sum;
  }
  [[nodiscard]] double binDistance2(const Bin& bin, const Eigen::Vector3d& u, double best) const {
    for (const auto& [cell, full] : bin.cells) {
      const double d2 = boxDistance2(cell, u);
      if (d2 < best) best = full ? d2 : std::min(best, mixedDistance2(cell, u, best));
    }
    return best;
  }
  [[nodiscard]] double mixedDistance2(const std::array<int, 3>& cell, const Eigen::Vector3d& u,
                                      double best) const {
    // From afar few places do: the walk is towards u anyway.
    const int steps = best > 36 * edge_.squaredNorm() ? 2 : 4;
    const int side = steps + 1;
    const Eigen::Vector3d low(cell[0], cell[1], cell[2]);
    for (int s = 0; s < side * side * side; ++s) {
      const Eigen::Vector3d p =
          low + Eigen::Vector3d(s % side, s / side % side, s / (side * side)) / steps;
      const double d2 = (p - u).cwiseProduct(edge_).squaredNorm();
      // Towards u as long as the value is negative and the cell is not left.
      double in = 0, out = 1;
      for (int a = 0; a < 3; ++a) {
        const double step = u[a] - p[a];
        if (step > 0) out = std::min(out, (low[a] + 1 - p[a]) / step);
        if (step < 0) out = std::min(out, (low[a] - p[a]) / step);
      }
      // Nothing to win, or not in the region.
      if ((1 - out) * (1 - out) * d2 >= best || value(cell, p) >= 0) continue;
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
  std::vector<Bin> bins_;
};

/// A random place in a box of cells, its corners and faces now and then.
inline Eigen::Vector3d placeIn(std::mt19937& rng, const std::array<int, 3>& low, int cells) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Vector3d u;
  const bool corner = rng() % 2 == 0;  // where affine bounds are tight
  for (int a = 0; a < 3; ++a) {
    const double w = corner || rng() % 6 == 0 ? static_cast<double>(rng() % 2) : uniform(rng);
    u[a] = low[static_cast<std::size_t>(a)] + w * cells;
  }
  return u;
}

}  // namespace palpate::testing_volumes
