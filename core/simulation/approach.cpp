#include "core/simulation/approach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/simulation/felt_voxels.h"

namespace palpate {
namespace {

// How wide a hand slides, and how far up it starts (core/devices/hand.h), with room to spare.
constexpr double kPatchRadii[] = {4e-3, 8e-3, 12e-3};
constexpr int kRaysPerRing = 12;
constexpr double kFreeHeight = 60e-3;
// A patch whose points lie farther than this off its plane is a rim or a hole, not a surface.
constexpr double kMostUneven = 6e-3;
constexpr double kGoodShare = 0.9;
// Beside the centroid, how far and how densely other rays are tried.
constexpr double kSearchRadius = 60e-3;
constexpr double kSearchStep = 6e-3;

// From above and left first; P: x left, y posterior, z superior.
const Eigen::Vector3d kDirections[] = {{0.5, -0.2, 0.85}, {-0.5, -0.2, 0.85}, {0, 0, 1},
                                       {0, -1, 0},        {1, 0, 0},          {-1, 0, 0},
                                       {0, 1, 0},         {0, 0, -1}};

class Field {
 public:
  Field(const LabelGrid& grid, const FeltLabels& felt)
      : grid_(grid), felt_(felt), X_VP_(grid.geometry.X_PV.inverse()) {
    step_ = 0.5 * grid.geometry.spacing.minCoeff();
  }

  [[nodiscard]] bool solid(const Eigen::Vector3d& p_P) const {
    const auto v = grid_.geometry.voxelAt(X_VP_ * p_P);
    return grid_.geometry.contains(v[0], v[1], v[2]) && felt_[grid_.at(v[0], v[1], v[2])];
  }
  /// Distance along the ray to the first felt voxel.
  [[nodiscard]] std::optional<double> hit(const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                                          double most) const {
    for (double t = 0.0; t < most; t += step_) {
      if (solid(from + t * along)) return t;
    }
    return std::nullopt;
  }
  [[nodiscard]] double step() const { return step_; }

 private:
  const LabelGrid& grid_;
  const FeltLabels& felt_;
  Eigen::Isometry3d X_VP_;
  double step_ = 0.0;
};

struct Extent {
  Eigen::Vector3d centroid_P = Eigen::Vector3d::Zero();
  Eigen::Vector3d highest_P = Eigen::Vector3d::Zero();  ///< The most superior felt voxel.
  double radius = 0.0;  ///< About the centroid, m: holds the whole grid.
  bool any = false;
};

Extent extentOf(const LabelGrid& grid, const FeltLabels& felt) {
  Extent extent;
  const GridGeometry& geometry = grid.geometry;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  forEachFelt(grid, felt, [&](std::size_t, auto i, auto j, auto k) {
    sum += Eigen::Vector3d(i, j, k);
    count += 1.0;
    const Eigen::Vector3d p_P = geometry.X_PV * geometry.centre_V(i, j, k);
    if (!extent.any || p_P.z() > extent.highest_P.z()) extent.highest_P = p_P;
    extent.any = true;
  });
  if (!extent.any) return extent;
  sum /= count;
  extent.centroid_P = geometry.X_PV * geometry.centre_V(sum.x(), sum.y(), sum.z());
  for (const auto& corner : geometry.cornerCentres_P()) {
    extent.radius = std::max(extent.radius, (corner - extent.centroid_P).norm());
  }
  return extent;
}

/// Two directions square to `n`, always the same for the same n.
void squareTo(const Eigen::Vector3d& n, Eigen::Vector3d& u, Eigen::Vector3d& v) {
  const Eigen::Vector3d other =
      std::abs(n.y()) < 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  u = (other - other.dot(n) * n).normalized();
  v = n.cross(u);
}

struct Patch {
  Eigen::Vector3d p_P = Eigen::Vector3d::Zero();
  Eigen::Vector3d outward_P = Eigen::Vector3d::UnitZ();
  double share = 0.0;  ///< Of the rays around that meet the same surface.
  bool free = false;   ///< The way down to it is.
  [[nodiscard]] bool good() const { return free && share >= kGoodShare; }
  [[nodiscard]] double score() const { return share + (free ? 1.0 : 0.0); }
};

/// The surface where the ray against `n` through `target` meets it, seen with the rays around.
std::optional<Patch> patchAt(const Field& field, const Eigen::Vector3d& target,
                             const Eigen::Vector3d& n, double radius) {
  const Eigen::Vector3d start = target + radius * n;
  const auto centre = field.hit(start, -n, radius);
  if (!centre) return std::nullopt;
  Eigen::Vector3d u, v;
  squareTo(n, u, v);
  // Plane height = c + a·x + b·y over the rays that meet the surface near the middle one.
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int met = 0, cast = 0;
  for (const double r : kPatchRadii) {
    for (int k = 0; k < kRaysPerRing; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kRaysPerRing;
      const Eigen::Vector3d row(1.0, r * std::cos(angle), r * std::sin(angle));
      ++cast;
      const auto t = field.hit(start + row.y() * u + row.z() * v, -n, *centre + r + kMostUneven);
      if (!t || std::abs(*t - *centre) > r + kMostUneven) continue;
      ++met;
      normal += row * row.transpose();
      right += (*centre - *t) * row;
    }
  }
  Patch patch;
  patch.p_P = start - *centre * n;
  patch.outward_P = n;
  patch.share = static_cast<double>(met) / cast;
  if (met >= 6) {
    const Eigen::Vector3d plane = normal.ldlt().solve(right);
    patch.outward_P = (n - plane.y() * u - plane.z() * v).normalized();
  }
  // The first voxel above the surface may still be solid where the plane tilts against the grid.
  const Eigen::Vector3d above = patch.p_P + kFreeHeight * patch.outward_P;
  const auto down = field.hit(above, -patch.outward_P, kFreeHeight);
  patch.free = !down || *down > kFreeHeight - 4e-3;
  return patch;
}

Eigen::Isometry3d devicePose(const Patch& patch) {
  const Eigen::Vector3d y = patch.outward_P;
  Eigen::Vector3d front(0, -1, 0);
  if (std::abs(front.dot(y)) > 0.9) front = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d z = (front - front.dot(y) * y).normalized();
  Eigen::Isometry3d X_PD = Eigen::Isometry3d::Identity();
  X_PD.linear().col(0) = y.cross(z);
  X_PD.linear().col(1) = y;
  X_PD.linear().col(2) = z;
  X_PD.translation() = patch.p_P;
  return X_PD;
}

/// Places beside the middle, nearest first, in a fixed order.
std::vector<Eigen::Vector2d> searchOffsets() {
  std::vector<Eigen::Vector2d> offsets;
  const int most = static_cast<int>(kSearchRadius / kSearchStep);
  for (int a = -most; a <= most; ++a) {
    for (int b = -most; b <= most; ++b) {
      if (a * a + b * b <= most * most) offsets.emplace_back(a * kSearchStep, b * kSearchStep);
    }
  }
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const auto& a, const auto& b) { return a.squaredNorm() < b.squaredNorm(); });
  return offsets;
}

}  // namespace

Result<Approach> planApproach(const LabelGrid& grid, const FeltLabels& felt) {
  const Extent extent = extentOf(grid, felt);
  if (!extent.any) {
    return fail(inputRefused("Nothing that can be felt is labelled.")
                    .advise("Segment the scan first, for example with the preset ct-bone."));
  }
  const Field field(grid, felt);
  const double radius = extent.radius + 2.0 * field.step() + kSearchRadius;
  std::optional<Patch> best;
  const auto offsets = searchOffsets();
  for (const Eigen::Vector3d& direction : kDirections) {
    const Eigen::Vector3d n = direction.normalized();
    Eigen::Vector3d u, v;
    squareTo(n, u, v);
    for (const auto& offset : offsets) {
      const Eigen::Vector3d target = extent.centroid_P + offset.x() * u + offset.y() * v;
      const auto patch = patchAt(field, target, n, radius);
      if (!patch) continue;
      if (patch->good()) return Approach{devicePose(*patch), true};
      if (!best || patch->score() > best->score()) best = patch;
    }
  }
  if (!best) {  // every ray missed: thin and hollow; its highest voxel can still be touched
    best = Patch{extent.highest_P, Eigen::Vector3d::UnitZ(), 0.0, true};
  }
  return Approach{devicePose(*best), false};
}

}  // namespace palpate
