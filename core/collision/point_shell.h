#pragma once
/// The instrument's surface as points with outward normals (paper 3.3: the "point shell").

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/triangle_mesh.h"

namespace palpate {

/// Immutable; any thread may read it. Frame T of the instrument, metres.
class PointShell {
 public:
  /// Takes points and unit normals of equal count (at least one, all finite, normals non-zero;
  /// they are normalised). Indices of points stay those of the input.
  [[nodiscard]] static Result<PointShell> fromPoints(std::vector<Eigen::Vector3d> points_T,
                                                     std::vector<Eigen::Vector3d> normals_T);
  /// Samples a closed mesh evenly: no point of the surface is farther than `spacing` metres from
  /// the nearest shell point. Normals point out of the mesh. Same mesh, same points.
  [[nodiscard]] static Result<PointShell> fromMesh(const TriangleMesh& mesh_T, double spacing);

  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] std::span<const Eigen::Vector3d> points_T() const noexcept;
  [[nodiscard]] std::span<const Eigen::Vector3d> normals_T() const noexcept;
  /// Radius about the origin of T that holds every point, metres.
  [[nodiscard]] double reach() const noexcept;

  struct Data;  ///< The trees over the points, for the traversal.
  [[nodiscard]] const Data& data() const noexcept { return *data_; }
  /// For what makes a shell with more than points (voxel_body_shell); `data` fits together.
  [[nodiscard]] static PointShell adopt(std::shared_ptr<const Data> data) noexcept {
    return PointShell(std::move(data));
  }

 private:
  explicit PointShell(std::shared_ptr<const Data> data) noexcept : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

}  // namespace palpate
