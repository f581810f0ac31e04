#include "core/dynamics/mass_properties.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace palpate {
namespace {

/// Volume, first and second moments of a solid, about a reference point.
struct Moments {
  double volume = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/// Each triangle and the reference point make a signed tetrahedron. With its apex at the reference,
/// corners a, b, c, s = a + b + c and d = a·(b × c): volume d/6, first moment d/24·s, second moment
/// d/120·(aaᵀ + bbᵀ + ccᵀ + ssᵀ). All exact.
Moments momentsOf(const TriangleMesh& mesh, const Eigen::Vector3d& reference) {
  Moments m;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]] - reference;
    const Eigen::Vector3d b = mesh.vertices[triangle[1]] - reference;
    const Eigen::Vector3d c = mesh.vertices[triangle[2]] - reference;
    const Eigen::Vector3d s = a + b + c;
    const double d = a.dot(b.cross(c));
    m.volume += d / 6.0;
    m.first += d / 24.0 * s;
    m.second +=
        d / 120.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  return m;
}

Result<void> checkDensity(double density_kgPerM3) {
  if (density_kgPerM3 > 0.0 && std::isfinite(density_kgPerM3)) return {};
  return fail(inputRefused("A body needs a density above zero.")
                  .inField("density")
                  .butFound(std::to_string(density_kgPerM3))
                  .wants("a number above 0, kg/m^3"));
}

/// Sums over the solid voxels, in whole voxels from the first voxel: exact up to 2^53.
struct VoxelSums {
  double count = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

VoxelSums sumsOf(const LabelGrid& body) {
  VoxelSums sums;
  const auto& dims = body.geometry.dims;
  std::size_t at = 0;
  for (std::int32_t k = 0; k < dims[2]; ++k) {
    for (std::int32_t j = 0; j < dims[1]; ++j) {
      for (std::int32_t i = 0; i < dims[0]; ++i, ++at) {
        if (body.labels[at] == 0) continue;
        const Eigen::Vector3d p(i, j, k);
        sums.count += 1.0;
        sums.first += p;
        sums.second += p * p.transpose();
      }
    }
  }
  return sums;
}

/// Second moments about the centre -> inertia about it.
Eigen::Matrix3d inertiaOf(const Eigen::Matrix3d& second) {
  return second.trace() * Eigen::Matrix3d::Identity() - second;
}

}  // namespace

Result<MassProperties> massPropertiesOf(const LabelGrid& body, double density_kgPerM3) {
  if (auto checked = checkDensity(density_kgPerM3); !checked) return fail(checked.error());
  const VoxelSums sums = sumsOf(body);
  if (sums.count == 0.0) {
    return fail(inputRefused("The body has no solid voxel.")
                    .advise("Give a label volume with voxels that are not zero."));
  }
  const GridGeometry& g = body.geometry;
  const Eigen::Vector3d centre = sums.first / sums.count;
  Eigen::Matrix3d aboutCentre = sums.second - sums.count * centre * centre.transpose();
  aboutCentre.diagonal().array() += sums.count / 12.0;  // of the boxes themselves
  const Eigen::Matrix3d toP = g.X_PV.linear() * g.spacing.asDiagonal();
  const double voxelMass = density_kgPerM3 * g.spacing.prod();
  MassProperties out;
  out.mass = voxelMass * sums.count;
  out.p_TC = g.X_PV * g.spacing.cwiseProduct(centre);
  out.I_C = voxelMass * inertiaOf(toP * aboutCentre * toP.transpose());
  return out;
}

Result<MassProperties> massPropertiesOf(const TriangleMesh& mesh_T, double density_kgPerM3) {
  if (auto checked = checkDensity(density_kgPerM3); !checked) return fail(checked.error());
  if (mesh_T.triangles.empty() || !isClosed(mesh_T)) {
    return fail(inputRefused("The mesh is not closed, so it encloses no mass.")
                    .advise("Close its holes and make all triangles wind the same way."));
  }
  // About the vertices' mean, so that a body far from its origin loses no digits.
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& v : mesh_T.vertices) reference += v;
  reference /= static_cast<double>(mesh_T.vertices.size());

  const Moments m = momentsOf(mesh_T, reference);
  if (!(m.volume > 0.0) || !std::isfinite(m.volume)) {
    return fail(inputRefused("The mesh encloses no volume.")
                    .butFound(std::to_string(m.volume) + " m^3")
                    .wants("more than 0")
                    .advise("Turn its triangles so that they face outwards."));
  }
  const Eigen::Vector3d centre = m.first / m.volume;
  const Eigen::Matrix3d aboutCentre = m.second - m.volume * centre * centre.transpose();

  MassProperties out;
  out.mass = density_kgPerM3 * m.volume;
  out.p_TC = reference + centre;
  out.I_C = density_kgPerM3 * inertiaOf(aboutCentre);
  return out;
}

}  // namespace palpate
