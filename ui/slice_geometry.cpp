#include "ui/slice_geometry.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/units.h"
#include "ui/orientation.h"

namespace palpate::ui {
namespace {

/// Which voxel axis is nearest to each patient axis: the permutation with the largest sum of
/// |cosines|, so that no voxel axis is taken twice even at 45°.
std::array<int, 3> voxelAxisOf(const GridGeometry& grid) {
  constexpr std::array<std::array<int, 3>, 6> kOrders{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  const Eigen::Matrix3d R = grid.X_PV.linear();
  std::array<int, 3> best = kOrders[0];
  double most = -1.0;
  for (const auto& order : kOrders) {
    double sum = 0.0;
    for (int p = 0; p < 3; ++p) sum += std::abs(R(p, order[static_cast<std::size_t>(p)]));
    if (sum > most + 1e-12) {
      most = sum;
      best = order;
    }
  }
  return best;
}

double length_mm(const GridGeometry& grid, int axis) {
  return millimetres(grid.spacing[axis]) * grid.dims[static_cast<std::size_t>(axis)];
}

}  // namespace

Eigen::Vector3d SlicePlane::right_P(const GridGeometry& grid) const {
  return grid.X_PV.linear().col(right) * (rightFlipped ? -1.0 : 1.0);
}

Eigen::Vector3d SlicePlane::down_P(const GridGeometry& grid) const {
  return grid.X_PV.linear().col(down) * (downFlipped ? -1.0 : 1.0);
}

SlicePlane slicePlane(const GridGeometry& grid, View view) {
  // Screen right and down as patient axes with their wanted sign: axial +L and +P; coronal +L and
  // +F; sagittal +P and +F (face to the left).
  struct Wanted {
    int right, down, through;
    double rightSign, downSign;
  };
  Wanted w{0, 1, 2, 1.0, 1.0};
  if (view == View::Coronal) w = {0, 2, 1, 1.0, -1.0};
  if (view == View::Sagittal) w = {1, 2, 0, 1.0, -1.0};
  const auto axis = voxelAxisOf(grid);
  const Eigen::Matrix3d R = grid.X_PV.linear();
  SlicePlane plane;
  plane.right = axis[static_cast<std::size_t>(w.right)];
  plane.down = axis[static_cast<std::size_t>(w.down)];
  plane.through = axis[static_cast<std::size_t>(w.through)];
  plane.rightFlipped = R(w.right, plane.right) * w.rightSign < 0.0;
  plane.downFlipped = R(w.down, plane.down) * w.downSign < 0.0;
  return plane;
}

std::array<std::string, 4> edgeLetters(const GridGeometry& grid, const SlicePlane& plane) {
  const Eigen::Vector3d right = plane.right_P(grid);
  const Eigen::Vector3d down = plane.down_P(grid);
  return {orientationLetters(-right), orientationLetters(right), orientationLetters(-down),
          orientationLetters(down)};
}

Eigen::Vector2d SliceFit::toScreen(const GridGeometry& grid, const SlicePlane& plane,
                                   const Eigen::Vector3d& voxel) const {
  const auto part = [&](int axis, bool flipped) {
    const double middle = 0.5 * (grid.dims[static_cast<std::size_t>(axis)] - 1);
    return (voxel[axis] - middle) * millimetres(grid.spacing[axis]) * (flipped ? -1.0 : 1.0);
  };
  return centre + pixelsPerMm * Eigen::Vector2d(part(plane.right, plane.rightFlipped),
                                                part(plane.down, plane.downFlipped));
}

Eigen::Vector3d SliceFit::toVoxel(const GridGeometry& grid, const SlicePlane& plane,
                                  const Eigen::Vector2d& screen, double slice) const {
  const Eigen::Vector2d mm = (screen - centre) / pixelsPerMm;
  Eigen::Vector3d voxel;
  const auto put = [&](int axis, bool flipped, double part) {
    const double middle = 0.5 * (grid.dims[static_cast<std::size_t>(axis)] - 1);
    voxel[axis] = middle + part * (flipped ? -1.0 : 1.0) / millimetres(grid.spacing[axis]);
  };
  put(plane.right, plane.rightFlipped, mm.x());
  put(plane.down, plane.downFlipped, mm.y());
  voxel[plane.through] = slice;
  return voxel;
}

SliceFit fitSlice(const GridGeometry& grid, const SlicePlane& plane, double width, double height,
                  double zoom, const Eigen::Vector2d& pan) {
  SliceFit fit;
  const double wide = std::max(1e-6, length_mm(grid, plane.right));
  const double high = std::max(1e-6, length_mm(grid, plane.down));
  fit.pixelsPerMm = std::max(1e-6, std::min(width / wide, height / high) * zoom);
  fit.centre = Eigen::Vector2d(0.5 * width, 0.5 * height) + pan;
  return fit;
}

Eigen::Vector3d voxelOf(const GridGeometry& grid, const Eigen::Vector3d& p_P) {
  return (grid.X_PV.inverse() * p_P).cwiseQuotient(grid.spacing);
}

Eigen::Vector3d pointOf(const GridGeometry& grid, const Eigen::Vector3d& voxel) {
  return grid.X_PV * voxel.cwiseProduct(grid.spacing);
}

double scaleBarLength_mm(double pixelsPerMm, double pixels) {
  const double most = 0.4 * pixels / std::max(1e-9, pixelsPerMm);
  double decade = std::pow(10.0, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= most) return step * decade;
  }
  return decade;
}

}  // namespace palpate::ui
