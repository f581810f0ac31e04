#include "core/trade/reference_shape.h"

#include <array>
#include <cmath>

namespace palpate {
namespace {

constexpr double kSphere = 24e-3, kCylinder = 20e-3, kRing = 18e-3, kTube = 9e-3;
constexpr double kCube = 64e-3;
constexpr std::array<const char*, 5> kNames{"sphere", "plane", "cylinder", "wedge", "torus"};

/// Towards `v` where that has a direction, else up.
Eigen::Vector3d direction(const Eigen::Vector3d& v) {
  const double norm = v.norm();
  return norm > 0.0 ? Eigen::Vector3d(v / norm) : Eigen::Vector3d::UnitZ();
}

/// Nearest point of a wedge's two half planes, whose edge is the x axis: (0, y, z).
Eigen::Vector3d nearestOfWedge(const Eigen::Vector3d& p) {
  const double side = p.y() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d down = Eigen::Vector3d(0.0, side, -1.0) / std::sqrt(2.0);
  const double along = std::max(p.y() * down.y() + p.z() * down.z(), 0.0);
  return {p.x(), along * down.y(), along * down.z()};
}

bool insideWedge(const Eigen::Vector3d& p) {
  return p.z() < -std::abs(p.y());
}

class ClosedForm final : public ReferenceShape {
 public:
  explicit ClosedForm(KnownShape shape) : shape_(shape) {}

  double distance(const Eigen::Vector3d& p) const override {
    switch (shape_) {
      case KnownShape::Sphere:
        return p.norm() - kSphere;
      case KnownShape::Plane:
        return p.z();
      case KnownShape::Cylinder:
        return std::hypot(p.y(), p.z()) - kCylinder;
      case KnownShape::Wedge:
        return (insideWedge(p) ? -1.0 : 1.0) * (p - nearestOfWedge(p)).norm();
      case KnownShape::Torus:
        return std::hypot(std::hypot(p.x(), p.y()) - kRing, p.z()) - kTube;
    }
    return 0.0;
  }

  double clearance(const Eigen::Vector3d& p, double margin) const override {
    return distance(p) - margin;  // a distance changes by no more than what a point moves
  }

  Eigen::Vector3d normal(const Eigen::Vector3d& p) const override {
    switch (shape_) {
      case KnownShape::Sphere:
        return direction(p);
      case KnownShape::Plane:
        return Eigen::Vector3d::UnitZ();
      case KnownShape::Cylinder:
        return direction({0.0, p.y(), p.z()});
      case KnownShape::Wedge:
        return direction((insideWedge(p) ? -1.0 : 1.0) * (p - nearestOfWedge(p)));
      case KnownShape::Torus: {
        const double r = std::hypot(p.x(), p.y());
        if (r == 0.0) return direction({0.0, 0.0, p.z()});
        return direction({p.x() * (1.0 - kRing / r), p.y() * (1.0 - kRing / r), p.z()});
      }
    }
    return Eigen::Vector3d::UnitZ();
  }

 private:
  KnownShape shape_;
};

}  // namespace

Result<KnownShape> knownShapeNamed(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<KnownShape>(i);
  }
  return fail(usageError("There is no shape of that name.")
                  .inField("--shape")
                  .butFound(name)
                  .wants("sphere, plane, cylinder, wedge or torus")
                  .advise("Choose one of these."));
}

const char* nameOf(KnownShape shape) noexcept {
  return kNames[static_cast<std::size_t>(shape)];
}

Eigen::Vector3d topOf(KnownShape shape) noexcept {
  switch (shape) {
    case KnownShape::Sphere:
      return {0.0, 0.0, kSphere};
    case KnownShape::Cylinder:
      return {0.0, 0.0, kCylinder};
    case KnownShape::Torus:
      return {kRing, 0.0, kTube};
    default:
      return Eigen::Vector3d::Zero();
  }
}

std::unique_ptr<ReferenceShape> closedForm(KnownShape shape) {
  return std::make_unique<ClosedForm>(shape);
}

LabelGrid voxelsOf(KnownShape shape, double spacing) {
  const auto n = static_cast<std::int32_t>(std::lround(kCube / spacing));
  LabelGrid grid;
  grid.geometry.dims = {n, n, n};
  grid.geometry.spacing = Eigen::Vector3d::Constant(spacing);
  grid.geometry.X_PV.translation() = Eigen::Vector3d::Constant(-0.5 * (n - 1) * spacing);
  grid.labels.reserve(grid.geometry.voxelCount());
  ClosedForm form(shape);
  for (std::int32_t k = 0; k < n; ++k) {
    for (std::int32_t j = 0; j < n; ++j) {
      for (std::int32_t i = 0; i < n; ++i) {
        const Eigen::Vector3d p = grid.geometry.X_PV * grid.geometry.centre_V(i, j, k);
        grid.labels.push_back(form.distance(p) < 0.0 ? 1 : 0);
      }
    }
  }
  return grid;
}

}  // namespace palpate
