#include "imaging/segment/nearest_label.h"

#include <algorithm>
#include <cmath>

namespace palpate {

std::optional<Eigen::Vector3d> nearestOf(const LabelGrid& labels, std::uint8_t value,
                                         const Eigen::Vector3d& p_mm, double reach_mm) {
  const GridGeometry& g = labels.geometry;
  const Eigen::Vector3d at_V = g.X_PV.inverse() * (p_mm * 1e-3);
  std::array<std::int32_t, 3> low{}, high{};
  for (std::size_t d = 0; d < 3; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    const double at = at_V[axis] / g.spacing[axis];
    const double reach = reach_mm * 1e-3 / g.spacing[axis] * (1.0 + 1e-9);
    low[d] = std::max(0, static_cast<std::int32_t>(std::ceil(at - reach)));
    high[d] = std::min(g.dims[d] - 1, static_cast<std::int32_t>(std::floor(at + reach)));
  }
  double nearest = reach_mm * 1e-3 * (1.0 + 1e-9);
  std::optional<Eigen::Vector3d> found_V;
  for (std::int32_t z = low[2]; z <= high[2]; ++z) {
    for (std::int32_t y = low[1]; y <= high[1]; ++y) {
      for (std::int32_t x = low[0]; x <= high[0]; ++x) {
        if (labels.at(x, y, z) != value) continue;
        const double distance = (g.centre_V(x, y, z) - at_V).norm();
        if (distance > nearest || (found_V && distance == nearest)) continue;
        nearest = distance;
        found_V = g.centre_V(x, y, z);
      }
    }
  }
  if (!found_V) return std::nullopt;
  return Eigen::Vector3d(g.X_PV * *found_V * 1e3);
}

}  // namespace palpate
