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

}  // namespace

Result<MassProperties> massPropertiesOf(const TriangleMesh& mesh_T, double density_kgPerM3) {
  if (!(density_kgPerM3 > 0.0) || !std::isfinite(density_kgPerM3)) {
    return fail(inputRefused("A body needs a density above zero.")
                    .inField("density")
                    .butFound(std::to_string(density_kgPerM3))
                    .wants("a number above 0, kg/m^3"));
  }
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
  out.I_C = density_kgPerM3 * (aboutCentre.trace() * Eigen::Matrix3d::Identity() - aboutCentre);
  return out;
}

}  // namespace palpate
