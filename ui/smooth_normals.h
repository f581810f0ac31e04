#pragma once
/// A closed mesh as drawable vertices: normals smooth over gentle bends, sharp over edges.

#include <cstdint>
#include <vector>

#include "core/geometry/triangle_mesh.h"

namespace palpate::ui {

struct DrawableMesh {
  std::vector<float> interleaved;  ///< Position (mm) and unit normal.
  std::vector<std::uint32_t> triangles;
};

/// Faces that meet at less than `crease` (rad) share a normal, weighted by area.
[[nodiscard]] DrawableMesh drawable(const TriangleMesh& mesh_m, double crease);

}  // namespace palpate::ui
