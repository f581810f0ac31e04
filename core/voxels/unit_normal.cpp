#include "core/voxels/unit_normal.h"

#include <cmath>

namespace palpate {
namespace {

constexpr double kScale = 32767.0;

double signOf(double v) noexcept {
  return v < 0.0 ? -1.0 : 1.0;
}

}  // namespace

UnitNormal encodeNormal(const Eigen::Vector3d& n) noexcept {
  const double sum = n.cwiseAbs().sum();
  double u = n.x() / sum;
  double v = n.y() / sum;
  if (n.z() < 0.0) {  // fold the lower half over the diagonals
    const double folded = (1.0 - std::abs(v)) * signOf(u);
    v = (1.0 - std::abs(u)) * signOf(v);
    u = folded;
  }
  return {static_cast<std::int16_t>(std::lround(u * kScale)),
          static_cast<std::int16_t>(std::lround(v * kScale))};
}

Eigen::Vector3d decodeNormal(UnitNormal n) noexcept {
  const double u = n.u / kScale;
  const double v = n.v / kScale;
  Eigen::Vector3d out(u, v, 1.0 - std::abs(u) - std::abs(v));
  if (out.z() < 0.0) {
    out.x() = (1.0 - std::abs(v)) * signOf(u);
    out.y() = (1.0 - std::abs(u)) * signOf(v);
  }
  return out.normalized();
}

}  // namespace palpate
