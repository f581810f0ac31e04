#pragma once
/// The three planes along a volume's own voxel axes, and where a point of the patient is in them.
///
/// Planes follow the voxels (nothing is invented by resampling); which voxel axis is "axial" is
/// decided by the direction nearest to the patient's axes, and the letters say the true direction.
/// Display: axial from the feet (patient's right on the left), coronal from the front, sagittal
/// from the left, as radiologists read them.

#include <Eigen/Core>
#include <array>
#include <string>

#include "core/geometry/grid_geometry.h"
#include "ui/layout.h"

namespace palpate::ui {

struct SlicePlane {
  int right = 0, down = 1, through = 2;            ///< Voxel axes of the screen and of the stack.
  bool rightFlipped = false, downFlipped = false;  ///< The screen runs against the voxel axis.

  /// Directions in P of the screen's right and down.
  [[nodiscard]] Eigen::Vector3d right_P(const GridGeometry& grid) const;
  [[nodiscard]] Eigen::Vector3d down_P(const GridGeometry& grid) const;
};

/// `view` is one of Axial, Coronal, Sagittal.
[[nodiscard]] SlicePlane slicePlane(const GridGeometry& grid, View view);

/// Letters at the screen's left, right, top, bottom.
[[nodiscard]] std::array<std::string, 4> edgeLetters(const GridGeometry& grid,
                                                     const SlicePlane& plane);

/// How the plane lies in a view: zoom and pan on top of "all of it fits".
struct SliceFit {
  Eigen::Vector2d centre{
      0, 0};  ///< Screen point of the slice's centre, pixels from the view's corner.
  double pixelsPerMm = 1.0;

  /// Continuous voxel index (i, j, k) to the screen, and back for a slice.
  [[nodiscard]] Eigen::Vector2d toScreen(const GridGeometry& grid, const SlicePlane& plane,
                                         const Eigen::Vector3d& voxel) const;
  [[nodiscard]] Eigen::Vector3d toVoxel(const GridGeometry& grid, const SlicePlane& plane,
                                        const Eigen::Vector2d& screen, double slice) const;
};

/// Fits the slice into a view of that size with a margin, then zooms and pans (pixels).
[[nodiscard]] SliceFit fitSlice(const GridGeometry& grid, const SlicePlane& plane, double width,
                                double height, double zoom, const Eigen::Vector2d& pan);

/// A point of P (metres) as a continuous voxel index.
[[nodiscard]] Eigen::Vector3d voxelOf(const GridGeometry& grid, const Eigen::Vector3d& p_P);
[[nodiscard]] Eigen::Vector3d pointOf(const GridGeometry& grid, const Eigen::Vector3d& voxel);

/// A length for the scale bar, 1-2-5 series, that is 15 to 40 % of `pixels` wide. Millimetres.
[[nodiscard]] double scaleBarLength_mm(double pixelsPerMm, double pixels);

}  // namespace palpate::ui
