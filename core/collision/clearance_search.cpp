#include "core/collision/clearance_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "core/collision/box_distance.h"
#include "core/collision/nearest_box.h"

namespace palpate {
namespace {

// How much nearer than the box found another may be to a sphere's centre, in radii. Only the order
// of the spheres follows from it: larger finds that box sooner and the best pair later.
constexpr double kTolerance = 0.5;

Vec3 transformed(const Eigen::Isometry3d& X, double x, double y, double z) noexcept {
  Vec3 p{};
  for (int i = 0; i < 3; ++i) p.v[i] = ((X(i, 0) * x + X(i, 1) * y) + X(i, 2) * z) + X(i, 3);
  return p;
}

// More than rounding can err in a sphere's centre, radius and distance: a billionth of a voxel and
// 2^-40 of the lengths involved; a transform errs by a few 2^-53.
double slackOf(const ClearanceScene& scene, const Eigen::Isometry3d& X_VT) noexcept {
  const double far = X_VT.translation().cwiseAbs().maxCoeff() + scene.extent;
  return 1e-9 * scene.tree->geometry.spacing.minCoeff() + 0x1p-40 * far;
}

template <int Bits>
class ClearanceSearch {
 public:
  ClearanceSearch(const ClearanceScene& scene, const Eigen::Isometry3d& X_VT, double reach,
                  CandidateBoxes& candidates) noexcept
      : tree_(*scene.tree),
        shell_(*scene.shell),
        boxes_(scene.boxes),
        lowestIndex_(scene.lowestIndex),
        candidates_(candidates),
        X_VT_(X_VT),
        slack_(slackOf(scene, X_VT)),
        best2_(reach * reach),
        best_(reach) {}

  void run(std::uint32_t firstRank) noexcept {
    if (firstRank < shell_.size()) tryPoint(firstRank, pointOf(firstRank), nullptr);
    const std::size_t top = shell_.level.size() - 1;
    ShellNode root;
    if (reaches(top, 0, nullptr, root)) visit(top, root);
  }

  void writeTo(Clearance& out) noexcept {
    if (rank_ == kNoPoint) {
      out.status = ClearanceStatus::BeyondReach;
      out.tests = tests_;
      return;
    }
    const Vec3 p = pointOf(rank_);
    const NearestBox box = findLowestBoxAt<Bits>(tree_, boxes_, p, best2_);
    tests_ += box.nodesVisited;
    out.status = ClearanceStatus::Complete;
    out.distance = std::sqrt(best2_);
    out.shellIndex = index_;
    out.voxel = box.voxel;
    std::ranges::copy(p.v, out.tool);
    std::ranges::copy(nearestPointOf(boxes_, out.voxel, p).v, out.anatomy);
    out.tests = tests_;
  }
  [[nodiscard]] std::uint32_t rank() const noexcept { return rank_; }

 private:
  struct ShellNode {
    std::uint32_t node = 0;
    std::uint32_t lowestIndex = 0;
    double lower = 0.0;  // no point of the node is nearer, metres
    VoxelIndex box{};    // occupied, near the centre
    [[nodiscard]] bool before(const ShellNode& other) const noexcept {
      return lower != other.lower ? lower < other.lower : lowestIndex < other.lowestIndex;
    }
  };

  [[nodiscard]] Vec3 pointOf(std::uint32_t rank) const noexcept {
    return transformed(X_VT_, shell_.x[rank], shell_.y[rank], shell_.z[rank]);
  }
  [[nodiscard]] Vec3 centreOf(const ShellSphere& sphere) const noexcept {
    return transformed(X_VT_, sphere.c[0], sphere.c[1], sphere.c[2]);
  }
  // Where a point is in the anatomy already, only lower indices can win.
  [[nodiscard]] bool hopeless(double lower, std::uint32_t lowestIndex) const noexcept {
    return lower > best_ || (best2_ == 0.0 && lowestIndex > index_);
  }

  // Can a point of this sphere win? Then fills `out`.
  [[nodiscard]] bool reaches(std::size_t level, std::uint32_t node, const VoxelIndex* seed,
                             ShellNode& out) noexcept {
    out.node = node;
    out.lowestIndex = lowestIndex_[level][node];
    if (hopeless(0.0, out.lowestIndex)) return false;
    const ShellSphere& sphere = shell_.level[level][node];
    const double radius = sphere.r + slack_;
    const double limit = best_ + radius;
    const double tolerance = kTolerance * sphere.r;
    const NearestBox box = findNearestBox<Bits>(tree_, boxes_, centreOf(sphere), limit * limit,
                                                seed, {radius, tolerance});
    tests_ += 1 + box.nodesVisited;
    if (!box.found) return false;
    out.lower = std::max(0.0, std::sqrt(box.squared) - tolerance - radius);
    out.box = box.voxel;
    return true;
  }

  void visit(std::size_t level, const ShellNode& parent) noexcept {
    if (level == 0) return tryGroup(parent);
    std::array<ShellNode, ShellHierarchy::kArity> open;
    std::size_t count = 0;
    const std::size_t first = parent.node * ShellHierarchy::kArity;
    const std::size_t last =
        std::min(first + ShellHierarchy::kArity, shell_.level[level - 1].size());
    for (std::size_t c = first; c < last; ++c) {
      if (reaches(level - 1, static_cast<std::uint32_t>(c), &parent.box, open[count])) ++count;
    }
    while (count > 0) {
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < count; ++i) {
        if (open[i].before(open[nearest])) nearest = i;
      }
      const ShellNode next = open[nearest];
      open[nearest] = open[--count];
      if (!hopeless(next.lower, next.lowestIndex)) visit(level - 1, next);
    }
  }

  void tryGroup(const ShellNode& group) noexcept {
    const ShellSphere& sphere = shell_.level[0][group.node];
    const std::size_t first = group.node * ShellHierarchy::kGroup;
    const std::size_t count = std::min(ShellHierarchy::kGroup, shell_.size() - first);
    std::array<Vec3, ShellHierarchy::kGroup> p;
    for (std::size_t i = 0; i < count; ++i) p[i] = pointOf(static_cast<std::uint32_t>(first + i));
    const Vec3 c = centreOf(sphere);
    Vec3 u{};
    if (group.lower > 0.0) u = directionTo(group.box, c);
    std::array<double, ShellHierarchy::kGroup> ahead;
    std::size_t front = 0;  // the foremost point
    for (std::size_t i = 0; i < count; ++i) {
      ahead[i] = u.v[0] * p[i].v[0] + u.v[1] * p[i].v[1] + u.v[2] * p[i].v[2];
      if (ahead[i] > ahead[front]) front = i;
    }
    // Some point is at most this far: where the bound is worse, improve it before it is used.
    if (best_ > group.lower + 2.0 * (sphere.r + slack_)) {
      tryPoint(static_cast<std::uint32_t>(first + front), p[front], &group.box);
    }
    if (best2_ == 0.0) {  // inside or not is told sooner without a list
      for (std::size_t i = 0; i < count; ++i) {
        tryPoint(static_cast<std::uint32_t>(first + i), p[i], nullptr);
      }
      return;
    }
    // A group is a flat patch of the tool, and its sphere much deeper than it is towards what it
    // faces. Seen along u, nothing that is more than the best distance ahead of the foremost point
    // can win: of a wall before the tool that leaves next to nothing.
    const double limit = best_ + sphere.r + slack_;
    tests_ += 1 + listCandidates<Bits>(tree_, boxes_, c, limit * limit, u,
                                       ahead[front] + best_ + slack_, candidates_);
    if (candidates_.count == 0) return;
    for (std::size_t i = 0; i < count; ++i) {
      const auto rank = static_cast<std::uint32_t>(first + i);
      if (candidates_.full) {
        tryPoint(rank, p[i], &group.box);
      } else if (candidates_.front - ahead[i] <= best_ + slack_) {
        ++tests_;
        offer(rank, nearestSquared(candidates_, p[i]));
      }
    }
  }

  // Unit; `from` is outside the box.
  [[nodiscard]] Vec3 directionTo(const VoxelIndex& box, const Vec3& from) const noexcept {
    Vec3 u = nearestPointOf(boxes_, box, from);
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      u.v[a] -= from.v[a];
      squared += u.v[a] * u.v[a];
    }
    const double length = std::sqrt(squared);
    for (double& v : u.v) v /= length;
    return u;
  }

  void tryPoint(std::uint32_t rank, const Vec3& p, const VoxelIndex* seed) noexcept {
    const double below = bound(shell_.order[rank]);
    if (below == 0.0) return;
    const NearestBox box = findNearestBox<Bits>(tree_, boxes_, p, below, seed);
    tests_ += 1 + box.nodesVisited;
    if (box.found) offer(rank, box.squared);
  }
  // Only squared distances below this make a pair with this point the best: of equally near points
  // the lowest index wins.
  [[nodiscard]] double bound(std::uint32_t index) const noexcept {
    return index < index_ ? justAbove(best2_) : best2_;
  }
  void offer(std::uint32_t rank, double squared) noexcept {
    const std::uint32_t index = shell_.order[rank];
    if (!(squared < bound(index))) return;
    best2_ = squared;
    best_ = std::sqrt(squared);
    index_ = index;
    rank_ = rank;
  }

  const VoxelTree::Data& tree_;
  const ShellHierarchy& shell_;
  const OccupiedBoxes& boxes_;
  const std::vector<std::vector<std::uint32_t>>& lowestIndex_;
  CandidateBoxes& candidates_;
  const Eigen::Isometry3d& X_VT_;
  double slack_;
  double best2_;
  double best_;
  std::uint32_t index_ = kNoPoint;
  std::uint32_t rank_ = kNoPoint;
  std::uint32_t tests_ = 0;
};

}  // namespace

Clearance searchClearance(const ClearanceScene& scene, const Eigen::Isometry3d& X_VT, double reach,
                          ClearanceScratch& scratch) noexcept {
  Clearance result;
  const auto run = [&](auto bits) {
    ClearanceSearch<decltype(bits)::value> search(scene, X_VT, reach, scratch.candidates);
    search.run(scratch.lastRank);
    search.writeTo(result);
    if (search.rank() != kNoPoint) scratch.lastRank = search.rank();
  };
  switch (scene.tree->bits) {
    case 1:
      run(std::integral_constant<int, 1>{});
      break;
    case 2:
      run(std::integral_constant<int, 2>{});
      break;
    default:
      run(std::integral_constant<int, 3>{});
      break;
  }
  return result;
}

}  // namespace palpate
