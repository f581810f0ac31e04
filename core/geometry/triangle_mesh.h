#pragma once
/// A triangle mesh as plain arrays: instruments, and surfaces handed to the ui.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

/// Vertices in metres in the frame its owner names; triangles counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// True if every edge is shared by exactly two triangles that run along it in opposite directions.
[[nodiscard]] bool isClosed(const TriangleMesh& mesh);

/// Enclosed volume in m³ by the divergence theorem; positive when the triangles face outwards.
[[nodiscard]] double signedVolume(const TriangleMesh& mesh);

}  // namespace palpate
