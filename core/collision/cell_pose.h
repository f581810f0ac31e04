#pragma once
/// A pose in cells of the tree and single precision: u = m p + t.
///
/// p from the shell's middle in metres (shell_blocks.h), u in voxels from the centre of the first
/// one. The sums are those of every reader, in the same order, so that a point lies in the same
/// cell for all of them.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/collision/pose_stretch.h"

namespace palpate {

struct CellPose {
  float m[3][3] = {};
  float t[3] = {};
  float perUnit = 1;  ///< Metres of a radius to smallest spacings, with what the pose stretches.
  float slack = 0;    ///< Smallest spacings added to every radius: more than rounding can err here.

  CellPose() = default;
  /// @param reach  of the shell's points from its middle, metres.
  CellPose(const Eigen::Isometry3d& X_VT, const Eigen::Vector3d& middle_T, double reach,
           const Eigen::Vector3d& spacing) {
    const Eigen::Vector3d middle_V = X_VT * middle_T;
    double axes[3][3];
    double farthest = 0.0;  // any coordinate, smallest spacings
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        axes[a][b] = X_VT(a, b);
        m[a][b] = static_cast<float>(X_VT(a, b) / spacing[a]);
      }
      t[a] = static_cast<float>(middle_V[a] / spacing[a]);
      farthest = std::max(farthest, (std::abs(middle_V[a]) + reach) / spacing.minCoeff());
    }
    // Rounded, and then rounded in products: what that loses of any radius is in the slack.
    perUnit = static_cast<float>(stretchOf(axes) / spacing.minCoeff());
    // Six roundings of 2^-24 of the largest coordinate, along three axes; 2e-3 is for the words'
    // and the sums' own.
    slack = static_cast<float>(2e-3 + 0x1p-20 * std::min(farthest, 1e15));
  }
  [[nodiscard]] float apply(int a, float x, float y, float z) const noexcept {
    return (m[a][0] * x + m[a][1] * y) + (m[a][2] * z + t[a]);
  }
};

}  // namespace palpate
