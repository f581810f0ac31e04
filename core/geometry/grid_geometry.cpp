#include "core/geometry/grid_geometry.h"

#include <algorithm>
#include <cmath>

namespace palpate {

std::size_t GridGeometry::voxelCount() const noexcept {
  return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) *
         static_cast<std::size_t>(dims[2]);
}

std::array<std::int32_t, 3> GridGeometry::voxelAt(const Eigen::Vector3d& p_V) const noexcept {
  std::array<std::int32_t, 3> voxel{};
  for (int axis = 0; axis < 3; ++axis) {
    const double cell = std::floor(p_V[axis] / spacing[axis] + 0.5);
    // Clamped so that a far point cannot overflow; it stays outside any grid.
    voxel[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::clamp(cell, -2.0, 2147483000.0));
  }
  return voxel;
}

std::array<Eigen::Vector3d, 8> GridGeometry::cornerCentres_P() const noexcept {
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t c = 0; c < 8; ++c) {
    const double i = (c & 1U) != 0 ? dims[0] - 1 : 0;
    const double j = (c & 2U) != 0 ? dims[1] - 1 : 0;
    const double k = (c & 4U) != 0 ? dims[2] - 1 : 0;
    corners[c] = X_PV * centre_V(i, j, k);
  }
  return corners;
}

double GridGeometry::cornerDistance(const GridGeometry& other) const noexcept {
  const auto mine = cornerCentres_P();
  const auto theirs = other.cornerCentres_P();
  double worst = 0.0;
  for (std::size_t c = 0; c < 8; ++c) worst = std::max(worst, (mine[c] - theirs[c]).norm());
  return worst;
}

bool GridGeometry::sameAs(const GridGeometry& other) const noexcept {
  return dims == other.dims && cornerDistance(other) <= kSameGeometry_m;
}

}  // namespace palpate
