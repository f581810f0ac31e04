#pragma once
/// A pose in voxels, as single precision numbers for the SIMD peers.

#include <Eigen/Geometry>
#include <array>

namespace palpate::bench {

/// u = m p + t, p in metres (T), u in voxels from the centre of the first one.
struct FieldPose {
  float m[3][3];
  float t[3];
  float perUnit;  ///< radii to the field's unit of length

  FieldPose(const Eigen::Isometry3d& X_VT, const std::array<double, 3>& spacing, double unit)
      : perUnit(static_cast<float>(1.0 / unit)) {
    for (int a = 0; a < 3; ++a) {
      const double step = spacing[static_cast<std::size_t>(a)];
      for (int b = 0; b < 3; ++b) m[a][b] = static_cast<float>(X_VT(a, b) / step);
      t[a] = static_cast<float>(X_VT(a, 3) / step);
    }
  }
};

}  // namespace palpate::bench
