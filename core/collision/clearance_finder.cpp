#include "core/collision/clearance_finder.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/collision/clearance_search.h"
#include "core/collision/occupied_boxes.h"
#include "core/collision/rigid_pose.h"
#include "core/collision/shell_hierarchy.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

struct ClearanceFinder::Scratch {
  ClearanceScene scene;
  double reach = kFarthestClearance;
  ClearanceScratch search;
};

namespace {

std::vector<std::vector<std::uint32_t>> lowestIndices(const ShellHierarchy& shell) {
  std::vector<std::vector<std::uint32_t>> lowest(shell.level.size());
  for (std::size_t l = 0; l < lowest.size(); ++l) {
    const std::size_t points = ShellHierarchy::pointsPerNode(l);
    for (std::size_t first = 0; first < shell.size(); first += points) {
      const std::size_t last = std::min(first + points, shell.size());
      lowest[l].push_back(
          *std::min_element(shell.order.begin() + static_cast<std::ptrdiff_t>(first),
                            shell.order.begin() + static_cast<std::ptrdiff_t>(last)));
    }
  }
  return lowest;
}

ClearanceScene sceneOf(const VoxelTree::Data& tree, const PointShell& shell) {
  ClearanceScene scene;
  scene.tree = &tree;
  scene.shell = &shell.data().hierarchy;
  scene.boxes = occupiedBoxesOf(tree);
  scene.lowestIndex = lowestIndices(*scene.shell);
  scene.extent = shell.reach();
  for (const auto& face : scene.boxes.face) scene.extent += face.back() - face.front();
  return scene;
}

}  // namespace

Result<ClearanceFinder> ClearanceFinder::create(const VoxelTree& tree, const PointShell& shell,
                                                const ClearanceOptions& options) {
  const TreeOptions& built = tree.options();
  if (built.leaf != LeafModel::Voxel || built.surfaceOnly) {
    const bool distance = built.leaf != LeafModel::Voxel;
    return fail(usageError("Clearance is measured to whole voxels, which this tree does not hold.")
                    .inField(distance ? "leaf" : "surfaceOnly")
                    .butFound(distance ? "distance leaves" : "surface voxels only")
                    .wants("a tree of all solid voxels with voxel leaves")
                    .advise("Build a tree with voxel leaves for the labels in question."));
  }
  for (const std::int32_t voxels : tree.data().extent) {
    if (voxels <= OccupiedBox::kMostVoxels) continue;
    return fail(
        inputRefused("The label volume is too long for a clearance.")
            .inField("dims")
            .butFound(std::to_string(voxels))
            .wants("at most " + std::to_string(OccupiedBox::kMostVoxels) + " voxels along an axis")
            .advise("Crop or resample the volume."));
  }
  if (!(options.maxReach >= 0.0)) {
    return fail(usageError("The reach of the clearance is not a length.")
                    .inField("maxReach")
                    .butFound(std::to_string(options.maxReach))
                    .wants("0 or more, metres"));
  }
  auto scratch = std::make_unique<Scratch>();
  scratch->scene = sceneOf(tree.data(), shell);
  scratch->reach = std::min(options.maxReach, kFarthestClearance);
  return ClearanceFinder(std::move(scratch));
}

ClearanceFinder::ClearanceFinder(std::unique_ptr<Scratch> scratch) noexcept
    : scratch_(std::move(scratch)) {}
ClearanceFinder::ClearanceFinder(ClearanceFinder&&) noexcept = default;
ClearanceFinder& ClearanceFinder::operator=(ClearanceFinder&&) noexcept = default;
ClearanceFinder::~ClearanceFinder() = default;

Clearance ClearanceFinder::find(const Eigen::Isometry3d& X_VT) noexcept {
  if (!isRigidPose(X_VT)) {
    Clearance bad;
    bad.status = ClearanceStatus::BadPose;
    return bad;
  }
  return searchClearance(scratch_->scene, X_VT, scratch_->reach, scratch_->search);
}

}  // namespace palpate
