#include "ui/smooth_normals.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/units.h"

namespace palpate::ui {

DrawableMesh drawable(const TriangleMesh& mesh_m, double crease) {
  const std::size_t faces = mesh_m.triangles.size();
  std::vector<Eigen::Vector3d> area(faces);  // normal times twice the area
  std::vector<std::vector<std::uint32_t>> facesOf(mesh_m.vertices.size());
  for (std::size_t f = 0; f < faces; ++f) {
    const auto& t = mesh_m.triangles[f];
    const Eigen::Vector3d& a = mesh_m.vertices[t[0]];
    area[f] = (mesh_m.vertices[t[1]] - a).cross(mesh_m.vertices[t[2]] - a);
    for (const std::uint32_t v : t) facesOf[v].push_back(static_cast<std::uint32_t>(f));
  }
  const double least = std::cos(crease);
  DrawableMesh out;
  out.interleaved.reserve(faces * 18);
  for (std::size_t f = 0; f < faces; ++f) {
    const Eigen::Vector3d own = area[f].normalized();
    for (const std::uint32_t v : mesh_m.triangles[f]) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (const std::uint32_t g : facesOf[v]) {
        if (area[g].normalized().dot(own) >= least) sum += area[g];
      }
      const Eigen::Vector3d n = sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : own;
      for (int c = 0; c < 3; ++c) {
        out.interleaved.push_back(static_cast<float>(mesh_m.vertices[v][c] * kMillimetresPerMetre));
      }
      for (int c = 0; c < 3; ++c) out.interleaved.push_back(static_cast<float>(n[c]));
      out.triangles.push_back(static_cast<std::uint32_t>(out.triangles.size()));
    }
  }
  return out;
}

}  // namespace palpate::ui
