#pragma once
/// One query of the clearance: the shell's spheres, nearest first, down to its points. Internal.
///
/// A sphere asks the tree for a box about as near to its centre as any (nearest_box.h); what that
/// is at the least for its points orders the spheres and drops those that cannot win. A group of
/// points, the smallest sphere, compares the boxes that may be nearest to it (candidate_boxes.h).
///
/// The answer is the smallest (squared distance, shell index). It is one pair whatever the order of
/// the search, because what is pruned is behind the best pair in that order. Then the tree is asked
/// once more for the lowest voxel at that distance.
///
/// Frames: V = voxel axes of the tree's grid, T = tool. Lengths: metres.

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "core/collision/candidate_boxes.h"
#include "core/collision/clearance_finder.h"
#include "core/collision/occupied_boxes.h"
#include "core/collision/shell_hierarchy.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

inline constexpr std::uint32_t kNoPoint = 0xFFFFFFFF;

/// What every query reads and none changes. Tree and shell belong to the finder's caller.
struct ClearanceScene {
  const VoxelTree::Data* tree = nullptr;
  const ShellHierarchy* shell = nullptr;
  OccupiedBoxes boxes;                                  ///< Of the tree.
  std::vector<std::vector<std::uint32_t>> lowestIndex;  ///< Of a shell node: [level][node].
  double extent = 0.0;  ///< What a pose's translation is added to: the tool and the grid, metres.
};

/// What a query writes. One thread at a time.
struct ClearanceScratch {
  CandidateBoxes candidates;          ///< Means nothing between queries.
  std::uint32_t lastRank = kNoPoint;  ///< Nearest when last there was one; tried first.
};

/// Real-time safe: no allocation, lock, exception or log.
/// @param X_VT   rigid tool pose: p_V = X_VT * p_T
/// @param reach  farther than this is BeyondReach; 0 .. kFarthestClearance
[[nodiscard]] Clearance searchClearance(const ClearanceScene& scene, const Eigen::Isometry3d& X_VT,
                                        double reach, ClearanceScratch& scratch) noexcept;

}  // namespace palpate
