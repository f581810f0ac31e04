#pragma once
/// Mass, centre and inertia of a closed mesh of even density.

#include <Eigen/Core>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace palpate {

struct MassProperties {
  double mass = 0.05;                                        ///< kg
  Eigen::Vector3d p_TC = Eigen::Vector3d::Zero();            ///< Centre of mass in T, m.
  Eigen::Matrix3d I_C = Eigen::Matrix3d::Identity() * 1e-5;  ///< About C, axes of T, kg·m².
};

/// Exact integrals over the mesh (divergence theorem). Refuses an open mesh or one of no volume.
[[nodiscard]] Result<MassProperties> massPropertiesOf(const TriangleMesh& mesh_T,
                                                      double density_kgPerM3);

}  // namespace palpate
