#include <algorithm>
#include <cmath>

#include "imaging/segment/edit.h"

namespace palpate {
namespace {

/// Distance of a point to a polyline, all in the same frame.
double distanceTo(const std::vector<Eigen::Vector3d>& path, const Eigen::Vector3d& p) {
  double nearest2 = (p - path.front()).squaredNorm();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector3d along = path[i] - path[i - 1];
    const double length2 = along.squaredNorm();
    const double t =
        length2 > 0.0 ? std::clamp((p - path[i - 1]).dot(along) / length2, 0.0, 1.0) : 0.0;
    nearest2 = std::min(nearest2, (p - path[i - 1] - t * along).squaredNorm());
  }
  return std::sqrt(nearest2);
}

/// What a stroke covers, in V, mm.
struct Stroke {
  std::vector<Eigen::Vector3d> path;
  double radius = 0.0;
  bool disk = false;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double halfThickness = 0.0;

  [[nodiscard]] bool covers(const Eigen::Vector3d& p) const {
    if (!disk) return distanceTo(path, p) <= radius * (1.0 + 1e-12);
    const double off = (p - path.front()).dot(normal);
    if (off < -halfThickness || off >= halfThickness) return false;
    return distanceTo(path, p - off * normal) <= radius * (1.0 + 1e-12);
  }
};

Stroke strokeOf(const Edit& edit, const tool::Brush& tool) {
  const GridGeometry& g = edit.geometry();
  Stroke stroke;
  stroke.radius = tool.radius_mm;
  const Eigen::Isometry3d X_VP = g.X_PV.inverse();
  for (const Eigen::Vector3d& p : tool.path_mm) stroke.path.push_back(X_VP * (p * 1e-3) * 1e3);
  if (tool.normal) {
    stroke.disk = true;
    stroke.normal = (X_VP.linear() * *tool.normal).normalized();
    stroke.halfThickness = 0.5 * stroke.normal.cwiseAbs().dot(spacing_mm(g));
    for (Eigen::Vector3d& p : stroke.path) {  // into the plane of the first point
      p -= (p - stroke.path.front()).dot(stroke.normal) * stroke.normal;
    }
  }
  return stroke;
}

Result<void> check(const tool::Brush& tool) {
  if (auto fits = within(tool.radius_mm, 0.0, kMostMm, "radius_mm"); !fits) return fits;
  if (tool.path_mm.empty()) {
    return fail(usageError("The stroke has no points.").inField("path").wants("at least one"));
  }
  if (tool.normal && !(tool.normal->allFinite() && tool.normal->norm() > 1e-9)) {
    return fail(usageError("The disk's normal has no direction.").inField("normal"));
  }
  // A stroke may leave the scan; it may not be nowhere.
  constexpr double kFarthest_mm = 1e5;
  for (std::size_t i = 0; i < tool.path_mm.size(); ++i) {
    if (tool.path_mm[i].allFinite() && tool.path_mm[i].cwiseAbs().maxCoeff() < kFarthest_mm)
      continue;
    return fail(inputRefused("The point is not near the scan.")
                    .inField("path[" + std::to_string(i) + "]")
                    .wants("a point of the scan, patient coordinates (LPS)"));
  }
  return {};
}

}  // namespace

Result<void> carryOut(Edit& edit, const tool::Brush& tool) {
  if (auto fits = check(tool); !fits) return fits;
  const GridGeometry& g = edit.geometry();
  VoxelBox box;
  for (const Eigen::Vector3d& p : tool.path_mm) {
    const auto voxel = g.voxelAt(g.X_PV.inverse() * (p * 1e-3));
    box = unite(box, {voxel, voxel});
  }
  box = grownBy(box, tool.radius_mm + g.spacing.maxCoeff() * 1e3, g);
  if (box.empty()) return {};
  MaskBlock block = blockOf(edit.labels, edit.value, box);
  const Stroke stroke = strokeOf(edit, tool);
  const std::uint8_t paint = tool.erase ? std::uint8_t{0} : plane::kMask;
  forEachRow(g, box, [&](std::size_t, std::int32_t count, std::int32_t y, std::int32_t z) {
    std::uint8_t* row = block.voxels.data() + block.index(0, y - box.low[1], z - box.low[2]);
    for (std::int32_t x = 0; x < count; ++x) {
      if (stroke.covers(g.centre_V(box.low[0] + x, y, z) * 1e3)) row[x] = paint;
    }
  });
  writeBack(edit, block);
  return {};
}

}  // namespace palpate
