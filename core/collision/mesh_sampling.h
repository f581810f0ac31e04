#pragma once
/// Even points on the surface of a mesh.

#include <Eigen/Core>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace palpate {

struct SurfaceSamples {
  std::vector<Eigen::Vector3d> points, normals;  ///< Frame of the mesh, metres; unit normals.
};

/// Every point of the surface has a sample within `spacing` whose normal lies on its side (their
/// dot product is positive), so both faces of a thin blade get samples; samples on one side are
/// 0.75 spacing or more apart. Same mesh, same samples.
///
/// Method: the faces are cut into slivers of at most 0.375 spacing (their centroids are within
/// 0.25 spacing of any of their points), then centroids are taken greedily, in order, wherever no
/// earlier sample is nearer than 0.75 spacing: 0.25 + 0.75 = 1.
/// Refuses a mesh that is empty, open, inside out or not finite, and a spacing that is not
/// positive or asks for more than 20 million candidates.
[[nodiscard]] Result<SurfaceSamples> sampleSurface(const TriangleMesh& mesh, double spacing);

}  // namespace palpate
