#pragma once
/// A pose in voxels, as single precision numbers for the SIMD peers.

#include <Eigen/Geometry>

namespace palpate::bench {

/// u = m p + t, p in metres (T), u in voxels from the centre of the first one.
struct FieldPose {
  float m[3][3];
  float t[3];
  float perVoxel;  ///< 1 / spacing: radii to voxels

  FieldPose(const Eigen::Isometry3d& X_VT, double spacing)
      : perVoxel(static_cast<float>(1.0 / spacing)) {
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) m[a][b] = static_cast<float>(X_VT(a, b) / spacing);
      t[a] = static_cast<float>(X_VT(a, 3) / spacing);
    }
  }
};

}  // namespace palpate::bench
