#pragma once
/// Mass, centre and inertia of a closed mesh, or of voxels, of even density.

#include <Eigen/Core>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"
#include "core/voxels/label_grid.h"

namespace palpate {

struct MassProperties {
  double mass = 0.05;                                        ///< kg
  Eigen::Vector3d p_TC = Eigen::Vector3d::Zero();            ///< Centre of mass in T, m.
  Eigen::Matrix3d I_C = Eigen::Matrix3d::Identity() * 1e-5;  ///< About C, axes of T, kg·m².
};

/// Exact integrals over the mesh (divergence theorem). Refuses an open mesh or one of no volume.
[[nodiscard]] Result<MassProperties> massPropertiesOf(const TriangleMesh& mesh_T,
                                                      double density_kgPerM3);

/// Exact for the boxes of the voxels that are not zero, about P: `p_TC` and `I_C` are in P of the
/// grid. Refuses a grid without such a voxel.
[[nodiscard]] Result<MassProperties> massPropertiesOf(const LabelGrid& body,
                                                      double density_kgPerM3);

}  // namespace palpate
