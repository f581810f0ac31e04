#include "core/collision/voxel_body_shell.h"

#include <memory>

#include "core/collision/shell_hierarchy.h"
#include "core/voxels/distance_field.h"
#include "core/voxels/outward_normal.h"
#include "core/voxels/surface_descriptor.h"

namespace palpate {

Result<PointShell> shellOfVoxelBody(const LabelGrid& body, const Progress& progress) {
  const GridGeometry& g = body.geometry;
  std::vector<std::uint8_t> solid(body.labels.size());
  for (std::size_t i = 0; i < solid.size(); ++i) solid[i] = body.labels[i] != 0 ? 1 : 0;
  const auto voxels = surfaceVoxels(g, solid);
  if (voxels.empty()) {
    return fail(inputRefused("The body has no solid voxel.")
                    .advise("Give a label volume with voxels that are not zero."));
  }
  const auto field = signedDistanceField(g, solid, progress);
  if (!field) return fail(field.error());
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  for (const auto& v : voxels) {
    points.push_back(g.X_PV * g.centre_V(v[0], v[1], v[2]));
    normals.push_back(g.X_PV.linear() * outwardNormal(g, *field, v[0], v[1], v[2]));
  }
  const auto shell = PointShell::fromPoints(std::move(points), std::move(normals));
  if (!shell) return fail(shell.error());
  auto data = std::make_shared<PointShell::Data>(shell->data());
  auto trees = buildVoxelBody(g, voxels, data->points_T, data->hierarchy.order);
  if (!trees) return fail(trees.error());
  data->body = std::move(*trees);
  return PointShell::adopt(std::move(data));
}

}  // namespace palpate
