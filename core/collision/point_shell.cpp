#include "core/collision/point_shell.h"

#include <algorithm>
#include <string>

#include "core/collision/mesh_sampling.h"
#include "core/collision/shell_hierarchy.h"
#include "core/collision/thinned_shell.h"

namespace palpate {
namespace {

Result<void> check(const std::vector<Eigen::Vector3d>& points,
                   const std::vector<Eigen::Vector3d>& normals) {
  if (points.empty()) {
    return fail(inputRefused("The point shell has no points.").inField("points"));
  }
  if (points.size() != normals.size()) {
    return fail(inputRefused("The point shell does not have one normal for every point.")
                    .inField("normals")
                    .butFound(std::to_string(normals.size()))
                    .wants(std::to_string(points.size())));
  }
  if (points.size() >= 0xFFFFFFFFU) {
    return fail(inputRefused("The point shell has more points than can be numbered.")
                    .inField("points")
                    .butFound(std::to_string(points.size()))
                    .wants("fewer than 4294967295"));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      return fail(inputRefused("Point " + std::to_string(i) + " of the shell is not finite.")
                      .inField("points"));
    }
    const double length = normals[i].norm();
    if (!std::isfinite(length) || length <= 0.0) {
      return fail(inputRefused("The normal of point " + std::to_string(i) +
                               " of the shell has no direction.")
                      .inField("normals"));
    }
  }
  return {};
}

}  // namespace

Result<PointShell> PointShell::fromPoints(std::vector<Eigen::Vector3d> points_T,
                                          std::vector<Eigen::Vector3d> normals_T) {
  if (auto ok = check(points_T, normals_T); !ok) return fail(ok.error());
  auto data = std::make_shared<Data>();
  data->thinned = std::make_shared<ThinnedShells>();
  for (auto& n : normals_T) n.normalize();
  for (const auto& p : points_T) data->reach = std::max(data->reach, p.norm());
  data->hierarchy = buildShellHierarchy(points_T);
  data->blocks = buildShellBlocks(data->hierarchy);
  data->points_T = std::move(points_T);
  data->normals_T = std::move(normals_T);
  return PointShell(std::move(data));
}

Result<PointShell> PointShell::fromMesh(const TriangleMesh& mesh_T, double spacing) {
  auto samples = sampleSurface(mesh_T, spacing);
  if (!samples) return fail(samples.error());
  return fromPoints(std::move(samples->points), std::move(samples->normals));
}

std::size_t PointShell::size() const noexcept {
  return data_->points_T.size();
}
std::span<const Eigen::Vector3d> PointShell::points_T() const noexcept {
  return data_->points_T;
}
std::span<const Eigen::Vector3d> PointShell::normals_T() const noexcept {
  return data_->normals_T;
}
double PointShell::reach() const noexcept {
  return data_->reach;
}

}  // namespace palpate
