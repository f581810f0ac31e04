#pragma once
/// How far the instrument is from chosen anatomy, and where: the nearest pair of a shell point and
/// a point of the solid. For structures that must not be touched: a nerve, the dura, a vessel.
///
/// The solid is the union of the closed boxes of the tree's occupied voxels, so build the tree for
/// the chosen labels: VoxelTree::build(grid, labels, {branching, LeafModel::Voxel, false}). The
/// distance is exact and Euclidean, from a point to the nearest such box; 0 when the point is
/// inside. Between shell points the instrument may come closer by up to the shell's spacing.
///
/// Branch and bound over two trees: the spheres of the shell's hierarchy, nearest first; each asks
/// the voxel tree for a box within the best distance so far of its points. Of a group of points
/// only those boxes are compared that are not too far ahead of its foremost point. Only masks and
/// links of the voxel tree are read, none of what its leaves store.
///
/// Frames: V = voxel axes of the tree's grid, T = tool. Lengths: metres.

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <type_traits>

#include "core/base/error.h"
#include "core/collision/point_shell.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

struct ClearanceOptions {
  /// Farther than this is not looked at: a cheap answer where the instrument is far away. Metres,
  /// >= 0; infinite means the farthest that can be ranked, kFarthestClearance.
  double maxReach = std::numeric_limits<double>::infinity();
};

/// Beyond this a squared distance in double would no longer tell one voxel from the next.
inline constexpr double kFarthestClearance = 1e6;

enum class ClearanceStatus : std::uint8_t {
  Complete,
  BeyondReach,  ///< No point within maxReach; nothing else of the result is set but `tests`.
  BadPose,      ///< X_VT not finite or not rigid; nothing else is set.
};

/// Plain data; may cross threads.
struct Clearance {
  ClearanceStatus status = ClearanceStatus::Complete;
  double distance = 0.0;                ///< Metres; 0 inside.
  std::uint32_t shellIndex = 0;         ///< The nearest shell point; of equals the lowest.
  double tool[3] = {0, 0, 0};           ///< That point, V.
  double anatomy[3] = {0, 0, 0};        ///< The nearest point of the solid, V; `tool` if inside.
  std::array<std::int32_t, 3> voxel{};  ///< The voxel whose box holds `anatomy`; of equally near
                                        ///< ones the lowest in the grid's order (x fastest). Its
                                        ///< label is the grid's: LabelGrid::at(voxel).
  std::uint32_t tests = 0;              ///< Nodes and points looked at.
};
static_assert(std::is_trivially_copyable_v<Clearance>);

/// Owns what a query needs, taken at construction; the tree and the shell must outlive it. One
/// thread at a time.
class ClearanceFinder {
 public:
  /// Refuses a tree with distance leaves (its items are cells between voxels, not voxels), one of
  /// the surface alone (inside it a depth would pass for a clearance), one longer than 65,535
  /// voxels along an axis, and a reach that is negative or not a number. Takes 12 bytes a node of
  /// the tree for the boxes of what they hold; another tree needs another finder.
  [[nodiscard]] static Result<ClearanceFinder> create(const VoxelTree& tree,
                                                      const PointShell& shell,
                                                      const ClearanceOptions& options = {});
  ClearanceFinder(ClearanceFinder&&) noexcept;
  ClearanceFinder& operator=(ClearanceFinder&&) noexcept;
  ~ClearanceFinder();

  /// Real-time safe: no allocation, lock, exception or log. The point that was nearest last time is
  /// tried first; that shortens the search and never changes what it finds: equal inputs give equal
  /// bits (all but `tests`) whatever was asked before.
  /// @param X_VT  tool pose in the voxel frame: p_V = X_VT * p_T.
  [[nodiscard]] Clearance find(const Eigen::Isometry3d& X_VT) noexcept;

 private:
  struct Scratch;
  explicit ClearanceFinder(std::unique_ptr<Scratch> scratch) noexcept;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace palpate
