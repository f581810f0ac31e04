#include "core/trade/grid_reference.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "core/geometry/units.h"

namespace palpate {
namespace {

struct Offset {
  std::int32_t i = 0, j = 0, k = 0;
  double distance = 0.0;  // m
};

/// All neighbours within `reach`, the nearest first.
std::vector<Offset> offsetsWithin(double reach, const Eigen::Vector3d& spacing) {
  const auto most = [&](int axis) {
    return static_cast<std::int32_t>(std::ceil(reach / spacing[axis]));
  };
  std::vector<Offset> offsets;
  for (std::int32_t k = -most(2); k <= most(2); ++k) {
    for (std::int32_t j = -most(1); j <= most(1); ++j) {
      for (std::int32_t i = -most(0); i <= most(0); ++i) {
        const double d = Eigen::Vector3d(i * spacing[0], j * spacing[1], k * spacing[2]).norm();
        if (d > 0.0 && d <= reach) offsets.push_back({i, j, k, d});
      }
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const Offset& a, const Offset& b) { return a.distance < b.distance; });
  return offsets;
}

class GridReference final : public ReferenceShape {
 public:
  GridReference(std::shared_ptr<const LabelGrid> grid, const std::array<bool, 256>& felt,
                double reach)
      : grid_(std::move(grid)),
        felt_(felt),
        X_VW_(grid_->geometry.X_PV.inverse()),
        half_(0.5 * grid_->geometry.spacing.minCoeff()),
        reach_(std::max(reach, 2.0 * grid_->geometry.spacing.maxCoeff())),
        offsets_(offsetsWithin(reach_, grid_->geometry.spacing)) {
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      side_[axis] = (static_cast<std::size_t>(grid_->geometry.dims[axis]) + kSide - 1) / kSide;
      count *= side_[axis];
    }
    bricks_ = std::vector<std::atomic<Brick*>>(count);
    // Between centres the interpolation's slope along each axis is at most that of the distance
    // along an edge, 1; more where voxels are not cubes.
    const Eigen::Vector3d ratio = 2.0 * half_ * grid_->geometry.spacing.cwiseInverse();
    steepest_ = (Eigen::Vector3d::Constant(2.0) - ratio).norm();
  }

  GridReference(const GridReference&) = delete;
  GridReference& operator=(const GridReference&) = delete;
  ~GridReference() override {
    for (const auto& brick : bricks_) delete brick.load();
  }

  double distance(const Eigen::Vector3d& p_W) const override {
    Cell cell;
    if (!locate(p_W, cell)) return std::numeric_limits<double>::infinity();
    const Eigen::Vector3d& far = cell.part;
    const Eigen::Vector3d near = Eigen::Vector3d::Ones() - far;
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
      const double weight = ((corner & 1) != 0 ? far : near).x() *
                            ((corner & 2) != 0 ? far : near).y() *
                            ((corner & 4) != 0 ? far : near).z();
      if (weight > 0.0) sum += weight * cornerValue(cell, corner);
    }
    return sum;
  }

  double clearance(const Eigen::Vector3d& p_W, double margin) const override {
    const double d = distance(p_W);
    if (std::isfinite(d)) return (d - margin) / steepest_;
    double outside = 0.0;
    const Eigen::Vector3d p_V = X_VW_ * p_W;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t last = grid_->geometry.dims[static_cast<std::size_t>(axis)] - 1;
      const double end = last * grid_->geometry.spacing[axis];
      outside = std::max({outside, -p_V[axis], p_V[axis] - end});
    }
    return outside;
  }

  Eigen::Vector3d normal(const Eigen::Vector3d& p_W) const override {
    Cell cell;
    if (!locate(p_W, cell)) return Eigen::Vector3d::UnitZ();
    Eigen::Vector3d gradient_V = Eigen::Vector3d::Zero();
    for (int corner = 0; corner < 8; ++corner) {
      const double value = cornerValue(cell, corner);
      for (int axis = 0; axis < 3; ++axis) {
        double slope = ((corner >> axis) & 1 ? 1.0 : -1.0) / grid_->geometry.spacing[axis];
        for (int other = 0; other < 3; ++other) {
          if (other != axis) slope *= weightOf(cell, corner, other);
        }
        gradient_V[axis] += slope * value;
      }
    }
    const double norm = gradient_V.norm();
    if (!(norm > 0.0)) return Eigen::Vector3d::UnitZ();
    return grid_->geometry.X_PV.linear() * gradient_V / norm;
  }

 private:
  struct Cell {
    std::array<std::int32_t, 3> low{0, 0, 0};
    Eigen::Vector3d part = Eigen::Vector3d::Zero();  // 0..1 from low to the next centre
  };

  /// The cell of eight centres around a point; false outside the box of centres.
  [[nodiscard]] bool locate(const Eigen::Vector3d& p_W, Cell& cell) const {
    const Eigen::Vector3d p_V = X_VW_ * p_W;
    for (int axis = 0; axis < 3; ++axis) {
      const double u = p_V[axis] / grid_->geometry.spacing[axis];
      const std::int32_t last = grid_->geometry.dims[static_cast<std::size_t>(axis)] - 1;
      if (!(u >= 0.0 && u <= last)) return false;
      const std::int32_t low = std::min(static_cast<std::int32_t>(u), std::max(last - 1, 0));
      cell.low[static_cast<std::size_t>(axis)] = low;
      cell.part[axis] = u - low;
    }
    return true;
  }

  [[nodiscard]] static double weightOf(const Cell& cell, int corner, int axis) {
    return (corner >> axis) & 1 ? cell.part[axis] : 1.0 - cell.part[axis];
  }

  [[nodiscard]] double cornerValue(const Cell& cell, int corner) const {
    return valueAt(cell.low[0] + (corner & 1), cell.low[1] + ((corner >> 1) & 1),
                   cell.low[2] + ((corner >> 2) & 1));
  }

  [[nodiscard]] bool isFelt(std::int32_t i, std::int32_t j, std::int32_t k) const {
    return felt_[grid_->at(i, j, k)];
  }

  /// The signed D of a voxel's centre, m; remembered. Threads that work out the same one find the
  /// same.
  [[nodiscard]] double valueAt(std::int32_t i, std::int32_t j, std::int32_t k) const {
    std::atomic<double>& remembered = placeOf(i, j, k);
    const double known = remembered.load(std::memory_order_relaxed);
    if (!std::isnan(known)) return known;
    const double value = searched(i, j, k);
    remembered.store(value, std::memory_order_relaxed);
    return value;
  }

  [[nodiscard]] double searched(std::int32_t i, std::int32_t j, std::int32_t k) const {
    const bool in = isFelt(i, j, k);
    double nearest = reach_;
    for (const Offset& o : offsets_) {
      if (!grid_->geometry.contains(i + o.i, j + o.j, k + o.k)) continue;
      if (isFelt(i + o.i, j + o.j, k + o.k) == in) continue;
      nearest = o.distance;
      break;
    }
    return (in ? -1.0 : 1.0) * (nearest - half_);
  }

  static constexpr std::size_t kSide = 8;
  /// Not a number until it is known.
  struct Brick {
    Brick() {
      for (auto& value : values) value = std::numeric_limits<double>::quiet_NaN();
    }
    std::array<std::atomic<double>, kSide * kSide * kSide> values;
  };

  [[nodiscard]] std::atomic<double>& placeOf(std::int32_t i, std::int32_t j, std::int32_t k) const {
    const auto x = static_cast<std::size_t>(i), y = static_cast<std::size_t>(j),
               z = static_cast<std::size_t>(k);
    Brick& brick = made(bricks_[(z / kSide * side_[1] + y / kSide) * side_[0] + x / kSide]);
    return brick.values[(z % kSide * kSide + y % kSide) * kSide + x % kSide];
  }

  static Brick& made(std::atomic<Brick*>& brick) {
    Brick* known = brick.load(std::memory_order_acquire);
    if (known != nullptr) return *known;
    auto fresh = std::make_unique<Brick>();
    if (brick.compare_exchange_strong(known, fresh.get())) return *fresh.release();
    return *known;  // another thread was faster
  }

  std::shared_ptr<const LabelGrid> grid_;
  std::array<bool, 256> felt_;
  Eigen::Isometry3d X_VW_;
  double half_, reach_;  // m
  std::vector<Offset> offsets_;
  double steepest_ = 1.0;
  std::array<std::size_t, 3> side_{};                // bricks along each axis
  mutable std::vector<std::atomic<Brick*>> bricks_;  // made as they are needed
};

}  // namespace

std::unique_ptr<ReferenceShape> gridReference(std::shared_ptr<const LabelGrid> grid,
                                              const std::array<bool, 256>& felt, double reach_mm) {
  return std::make_unique<GridReference>(std::move(grid), felt, metres(reach_mm));
}

}  // namespace palpate
