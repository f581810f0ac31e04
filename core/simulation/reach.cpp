#include "core/simulation/reach.h"

#include <algorithm>

#include "core/geometry/units.h"
#include "core/simulation/felt_voxels.h"
#include "core/voxels/depth_palette.h"
#include "core/voxels/sealed_cavities.h"

namespace palpate {
namespace {

double distanceTo(const SceneBox& box, const Eigen::Vector3d& p) {
  Eigen::Vector3d off;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = metres(box.least_mm[axis]), high = metres(box.most_mm[axis]);
    off[axis] = std::max({low - p[axis], p[axis] - high, 0.0});
  }
  return off.norm();
}

/// The least that the instrument measures along some line: its longest side.
double lengthOf(const PointShell& shell) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : shell.points_T()) box.extend(p);
  return box.sizes().maxCoeff();
}

/// How far apart two points of a cavity can be, at most: it goes on to the next voxels' centres.
double widthOf(const SealedCavity& cavity, const Eigen::Vector3d& spacing) {
  Eigen::Vector3d side;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<Eigen::Index>(a);
    side[axis] = (cavity.box.size(a) + 1) * spacing[axis];
  }
  return side.norm();
}

/// Fills what may be filled. Null where there is nothing to fill.
std::shared_ptr<LabelGrid> filled(const LabelGrid& grid, const FeltLabels& anatomy,
                                  const FeltLabels& moves, const PointShell& shell, LeafModel leaf,
                                  ReachSaving& saving) {
  const SealedCavities found = findSealedCavities(grid, anatomy);
  if (found.cavity.empty()) return nullptr;
  const double length = lengthOf(shell);
  std::vector<bool> wanted(found.cavity.size());
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    saving.cavities += 1;
    saving.cavityVoxels += found.cavity[c].voxels;
    wanted[c] = widthOf(found.cavity[c], grid.geometry.spacing) < length;
  }
  for (const CavityRun& run : found.runs) {
    const std::uint8_t* voxel = grid.labels.data() + run.first;
    const bool body =
        std::any_of(voxel, voxel + run.count, [&moves](std::uint8_t v) { return moves[v]; });
    if (body) wanted[run.cavity] = false;
  }
  const auto fill = fillableCavities(grid, anatomy, found, std::move(wanted), leaf);
  if (std::find(fill.begin(), fill.end(), true) == fill.end()) return nullptr;
  auto whole = std::make_shared<LabelGrid>(grid);
  for (const CavityRun& run : found.runs) {
    if (!fill[run.cavity]) continue;
    std::fill_n(whole->labels.begin() + static_cast<std::ptrdiff_t>(run.first), run.count,
                found.cavity[run.cavity].wall);
    saving.filledVoxels += run.count;
  }
  saving.cavitiesFilled = static_cast<std::size_t>(std::count(fill.begin(), fill.end(), true));
  return whole;
}

/// Where the device's workspace, the shell about it and what depths are measured over end, a voxel
/// is background.
std::shared_ptr<LabelGrid> withinWorkspace(const std::shared_ptr<const LabelGrid>& grid,
                                           const FeltLabels& anatomy, const SceneBox& workspace,
                                           const PointShell& shell, const Eigen::Isometry3d& X_WD,
                                           ReachSaving& saving) {
  const Eigen::Vector3d& spacing = grid->geometry.spacing;
  // A depth saturates at kSaturationVoxels; its cell's corners and their neighbours are read.
  const double support = (kSaturationVoxels + 1.0) * spacing.minCoeff() + 3.0 * spacing.norm();
  const double farthest = shell.reach() + kWorkspaceMargin + support;
  const Eigen::Isometry3d X_DW = X_WD.inverse();
  auto near = std::make_shared<LabelGrid>(*grid);
  forEachFelt(*grid, anatomy, [&](std::size_t at, auto i, auto j, auto k) {
    const Eigen::Vector3d p_W = grid->geometry.X_PV * grid->geometry.centre_V(i, j, k);
    if (distanceTo(workspace, X_DW * p_W) <= farthest) return;
    near->labels[at] = 0;
    ++saving.outsideDevice;
  });
  return saving.outsideDevice > 0 ? near : nullptr;
}

}  // namespace

std::shared_ptr<const LabelGrid> withinRegion(std::shared_ptr<const LabelGrid> grid,
                                              const std::optional<SceneBox>& region,
                                              const FeltLabels& felt, ReachSaving& saving) {
  if (!region) return grid;
  FeltLabels any;
  any.fill(true);
  any[0] = false;
  auto inside = std::make_shared<LabelGrid>(*grid);
  forEachFelt(*grid, any, [&](std::size_t at, auto i, auto j, auto k) {
    const Eigen::Vector3d p_P = grid->geometry.X_PV * grid->geometry.centre_V(i, j, k);
    if (distanceTo(*region, p_P) == 0.0) return;
    saving.outsideRegion += felt[grid->labels[at]] ? 1U : 0U;
    inside->labels[at] = 0;
  });
  return inside;
}

ReachableAnatomy reachableAnatomy(const Scene& scene, std::shared_ptr<const LabelGrid> grid,
                                  const FeltLabels& anatomy, const FeltLabels& moves,
                                  const PointShell& shell, const Eigen::Isometry3d& X_WD,
                                  ReachSaving saving) {
  ReachableAnatomy found{std::move(grid), saving, ReachLimit::None};
  if (scene.reach == Reach::All) return found;
  const QueryOptions& query = scene.setting.query;
  if (query.stopLevel > 0 || query.perceptualBound > 0.0) {
    found.limit = ReachLimit::CutDescent;
    return found;
  }
  const LeafModel leaf = scene.setting.tree.leaf;
  if (auto whole = filled(*found.labels, anatomy, moves, shell, leaf, found.saving)) {
    found.labels = std::move(whole);
  }
  if (scene.reach != Reach::Device) return found;
  if (!scene.workspace) {
    found.limit = ReachLimit::NoWorkspace;
  } else if (!scene.bodies.empty()) {
    found.limit = ReachLimit::LooseBodies;
  } else if (auto near = withinWorkspace(found.labels, anatomy, *scene.workspace, shell, X_WD,
                                         found.saving)) {
    found.labels = std::move(near);
  }
  return found;
}

}  // namespace palpate
