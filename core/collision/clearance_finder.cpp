#include "core/collision/clearance_finder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/collision/shell_hierarchy.h"
#include "core/voxels/node_mask.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {
namespace {

constexpr std::int32_t kMostVoxels = 0xFFFF;  // along an axis: what OccupiedBox can hold

/// The items of a node lie in [lo, hi) along each axis, and some at each end.
struct OccupiedBox {
  std::array<std::uint16_t, 3> lo{}, hi{};
};

OccupiedBox boxOfItem(const std::array<std::int32_t, 3>& item) noexcept {
  OccupiedBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.lo[a] = static_cast<std::uint16_t>(item[a]);
    box.hi[a] = static_cast<std::uint16_t>(item[a] + 1);
  }
  return box;
}

/// Boxes of voxels that a group of points may be nearest to, as far as there is room. More of them
/// than this are looked up in the tree again, point by point.
struct BoxList {
  static constexpr std::size_t kRoom = 256;
  std::array<std::array<double, kRoom>, 3> lower, upper;  // faces, V
  std::size_t count = 0;
  bool full = false;   // some did not fit
  double front = 0.0;  // the least u·x of them
};

/// What is computed from the tree once, so that boxes need no arithmetic.
struct TreeBoxes {
  /// Per axis the lower face of every item, V, up to the padded extent: neighbours share a face to
  /// the bit, and a node's box holds those of its items.
  std::array<std::vector<double>, 3> face;
  /// [level][node]. A node on the surface is half empty; far away that half costs most of the
  /// search, because a large ball about a point meets many such halves.
  std::vector<std::vector<OccupiedBox>> occupied;
};

}  // namespace

struct ClearanceFinder::Scratch {
  const VoxelTree::Data* tree = nullptr;
  const ShellHierarchy* shell = nullptr;
  TreeBoxes boxes;
  BoxList list;
  double reach = kFarthestClearance;
  double extent = 0.0;  // what a pose's translation is added to: the tool and the grid, metres
  std::vector<std::vector<std::uint32_t>> lowestIndex;  // of a shell node: [level][node]
  std::uint32_t lastRank = 0xFFFFFFFF;                  // nearest when last there was one
};

namespace {

using Item = std::array<std::int32_t, 3>;

constexpr std::uint32_t kNoPoint = 0xFFFFFFFF;

// How much nearer than the box found another may be to a sphere's centre, in radii. Only the order
// of the spheres follows from it: larger finds that box sooner and the best pair later.
constexpr double kTolerance = 0.5;

// As of the contact query (contact_finder.cpp): a pose off by this much moves a point a metre away
// from its rotation's axis by a micrometre.
constexpr double kRigidTolerance = 1e-6;

bool isRigidPose(const Eigen::Isometry3d& X) noexcept {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (!std::isfinite(X(i, j))) return false;
    }
  }
  double worst = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double dot = X(0, i) * X(0, j) + X(1, i) * X(1, j) + X(2, i) * X(2, j);
      worst = std::max(worst, std::abs(dot - (i == j ? 1.0 : 0.0)));
    }
  }
  const double det = X(0, 0) * (X(1, 1) * X(2, 2) - X(1, 2) * X(2, 1)) -
                     X(0, 1) * (X(1, 0) * X(2, 2) - X(1, 2) * X(2, 0)) +
                     X(0, 2) * (X(1, 0) * X(2, 1) - X(1, 1) * X(2, 0));
  return worst <= kRigidTolerance && det > 0.0;
}

struct Point {
  double v[3];
};

Point transformed(const Eigen::Isometry3d& X, double x, double y, double z) noexcept {
  Point p{};
  for (int i = 0; i < 3; ++i) p.v[i] = ((X(i, 0) * x + X(i, 1) * y) + X(i, 2) * z) + X(i, 3);
  return p;
}

// The next number above; of a finite one that is not negative. Never a subnormal one, which a
// thread may have set to count as 0; no squared distance but 0 is as small.
double justAbove(double value) noexcept {
  const double next = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) + 1);
  return std::max(next, std::numeric_limits<double>::min());
}

// Every squared distance to a box is computed here and by childDistances below, with the same
// operations in the same order. All of them round monotonically, so that no item is found nearer
// than the node that holds it: pruning needs no allowance.
double axisSquared(double p, double lower, double upper) noexcept {
  const double d = std::max(0.0, std::max(lower - p, p - upper));
  return d * d;
}

double nearestSquared(const BoxList& list, const Point& p) noexcept {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < list.count; ++i) {
    const double x = axisSquared(p.v[0], list.lower[0][i], list.upper[0][i]);
    const double y = axisSquared(p.v[1], list.lower[1][i], list.upper[1][i]);
    const double z = axisSquared(p.v[2], list.lower[2][i], list.upper[2][i]);
    nearest = std::min(nearest, (x + y) + z);
  }
  return nearest;
}

template <int Bits>
Item childCorner(const Item& corner, int child, int shift) noexcept {
  constexpr int kLow = NodeMask<Bits>::kLow;
  return {corner[0] + ((child & kLow) << shift), corner[1] + (((child >> Bits) & kLow) << shift),
          corner[2] + ((child >> (2 * Bits)) << shift)};
}

/// The occupied box nearest to one point, by descent of the tree, nearer children first.
template <int Bits>
class NearestBox {
 public:
  using Mask = NodeMask<Bits>;

  NearestBox(const VoxelTree::Data& tree, const TreeBoxes& boxes, const Point& p) noexcept
      : tree_(tree), boxes_(boxes), p_(p) {}

  [[nodiscard]] double squaredTo(const Item& item) const noexcept {
    return squaredTo(boxOfItem(item));
  }

  /// A box need not be the nearest: one that is within `enough`, or less than `tolerance` farther
  /// than it, will do. Of a wall before the tool much is about equally near. Metres.
  void roughly(double enough, double tolerance) noexcept {
    enough2_ = enough * enough;
    tolerance_ = tolerance;
  }

  /// Boxes at `below` (squared) or farther do not count.
  /// @param seed  a box known to be occupied, or nullptr: the search need only better it.
  void search(double below, const Item* seed) noexcept {
    start(below, seed);
    descend(tree_.levels, 0, {0, 0, 0});
  }
  /// All boxes closer than `below` that are not wholly beyond a plane: u·x > offset.
  void list(double below, const Point& u, double offset, BoxList& out) noexcept {
    below_ = below;
    u_ = u;
    offset_ = offset;
    out.count = 0;
    out.full = false;
    out.front = std::numeric_limits<double>::infinity();
    listFrom(tree_.levels, 0, {0, 0, 0}, out);
  }
  /// Of the boxes exactly this far, the lowest in the grid's order.
  void searchLowestAt(double squared) noexcept {
    below_ = justAbove(squared);
    descendToLowest(tree_.levels, 0, {0, 0, 0});
  }

  [[nodiscard]] bool found() const noexcept { return found_; }
  [[nodiscard]] double squared() const noexcept { return squared_; }  ///< When found.
  [[nodiscard]] const Item& item() const noexcept { return item_; }
  [[nodiscard]] std::uint32_t nodesVisited() const noexcept { return nodesVisited_; }

 private:
  struct AxisDistances {
    double d2[3][Mask::kEdge];  // of the children's slabs
  };
  struct Child {
    double d2;
    std::int32_t child;
    std::uint32_t node;
  };

  [[nodiscard]] double squaredTo(const OccupiedBox& box) const noexcept {
    double d2[3];
    for (std::size_t a = 0; a < 3; ++a) {
      d2[a] = axisSquared(p_.v[a], boxes_.face[a][box.lo[a]], boxes_.face[a][box.hi[a]]);
    }
    return (d2[0] + d2[1]) + d2[2];
  }
  // The least u·x of a box; without a plane everything is before it.
  [[nodiscard]] double leastAlong(const OccupiedBox& box) const noexcept {
    double least = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      least += u_.v[a] * boxes_.face[a][u_.v[a] > 0.0 ? box.lo[a] : box.hi[a]];
    }
    return least;
  }
  void start(double below, const Item* seed) noexcept {
    below_ = below;
    if (seed == nullptr) return;
    const double d2 = squaredTo(*seed);
    if (d2 < below_) accept(d2, *seed);
  }
  void accept(double d2, const Item& item) noexcept {
    found_ = true;
    item_ = item;
    squared_ = d2;
    below_ = d2;
    if (d2 <= enough2_) {
      below_ = 0.0;
    } else if (tolerance_ > 0.0) {
      const double rest = std::max(0.0, std::sqrt(d2) - tolerance_);
      below_ = rest * rest;
    }
  }
  [[nodiscard]] AxisDistances childDistances(int shift, const Item& corner) const noexcept {
    AxisDistances out;
    for (std::size_t a = 0; a < 3; ++a) {
      const double* face = boxes_.face[a].data() + corner[a];
      for (int i = 0; i < Mask::kEdge; ++i) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(i) << shift;
        const std::ptrdiff_t next = static_cast<std::ptrdiff_t>(i + 1) << shift;
        out.d2[a][i] = axisSquared(p_.v[a], face[at], face[next]);
      }
    }
    return out;
  }
  /// Calls f(child, squared distance) for every present child that is closer than the bound.
  template <class F>
  void forEachCloser(const Mask& mask, const AxisDistances& axis, F&& f) noexcept {
    constexpr std::uint64_t kRow = (std::uint64_t{1} << Mask::kEdge) - 1;
    for (int z = 0; z < Mask::kEdge; ++z) {
      if (!(axis.d2[2][z] < below_)) continue;
      for (int y = 0; y < Mask::kEdge; ++y) {
        const int first = Mask::child(0, y, z);
        std::uint64_t row =
            (mask.word[static_cast<std::size_t>(first) >> 6] >> (first & 63)) & kRow;
        if (row == 0 || !(axis.d2[1][y] + axis.d2[2][z] < below_)) continue;
        for (; row != 0; row &= row - 1) {
          const int x = std::countr_zero(row);
          const double d2 = (axis.d2[0][x] + axis.d2[1][y]) + axis.d2[2][z];
          if (d2 < below_) f(first + x, d2);
        }
      }
    }
  }
  [[nodiscard]] std::uint32_t nodeOf(int level, std::uint32_t node, const Mask& mask,
                                     int child) const noexcept {
    return tree_.level[static_cast<std::size_t>(level)].firstChild[node] +
           static_cast<std::uint32_t>(mask.rank(child));
  }

  void descend(int level, std::uint32_t node, const Item& corner) noexcept {
    ++nodesVisited_;
    const int shift = Bits * (level - 1);
    const Mask mask = Mask::load(tree_.level[static_cast<std::size_t>(level)].masks.data(), node);
    const AxisDistances axis = childDistances(shift, corner);
    if (level == 1) {
      forEachCloser(mask, axis,
                    [&](int child, double d2) { accept(d2, childCorner<Bits>(corner, child, 0)); });
      return;
    }
    // A selection as far as it is needed: mostly the first child leaves no other.
    Child open[Mask::kChildren];
    std::size_t count = 0;
    const auto& occupied = boxes_.occupied[static_cast<std::size_t>(level - 1)];
    forEachCloser(mask, axis, [&](int child, double) {
      const std::uint32_t below = nodeOf(level, node, mask, child);
      const double d2 = squaredTo(occupied[below]);
      if (!(d2 < below_)) return;
      open[count++] = {d2, child, below};
    });
    while (count > 0) {
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < count; ++i) {
        if (open[i].d2 < open[nearest].d2) nearest = i;
      }
      const Child next = open[nearest];
      if (!(next.d2 < below_)) return;
      open[nearest] = open[--count];
      descend(level - 1, next.node, childCorner<Bits>(corner, next.child, shift));
    }
  }
  void listFrom(int level, std::uint32_t node, const Item& corner, BoxList& out) noexcept {
    ++nodesVisited_;
    const int shift = Bits * (level - 1);
    const Mask mask = Mask::load(tree_.level[static_cast<std::size_t>(level)].masks.data(), node);
    forEachCloser(mask, childDistances(shift, corner), [&](int child, double) {
      if (out.full) return;
      const Item at = childCorner<Bits>(corner, child, shift);
      if (level == 1) return add(at, out);
      const std::uint32_t below = nodeOf(level, node, mask, child);
      const OccupiedBox& box = boxes_.occupied[static_cast<std::size_t>(level - 1)][below];
      if (!(squaredTo(box) < below_) || leastAlong(box) > offset_) return;
      listFrom(level - 1, below, at, out);
    });
  }
  void add(const Item& item, BoxList& out) const noexcept {
    const double least = leastAlong(boxOfItem(item));
    if (least > offset_) return;
    out.full = out.count == BoxList::kRoom;
    if (out.full) return;
    out.front = std::min(out.front, least);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(item[a]);
      out.lower[a][out.count] = boxes_.face[a][i];
      out.upper[a][out.count] = boxes_.face[a][i + 1];
    }
    ++out.count;
  }
  void descendToLowest(int level, std::uint32_t node, const Item& corner) noexcept {
    ++nodesVisited_;
    const int shift = Bits * (level - 1);
    const Mask mask = Mask::load(tree_.level[static_cast<std::size_t>(level)].masks.data(), node);
    forEachCloser(mask, childDistances(shift, corner), [&](int child, double) {
      const Item at = childCorner<Bits>(corner, child, shift);
      if (level > 1) {
        const std::uint32_t below = nodeOf(level, node, mask, child);
        const OccupiedBox& box = boxes_.occupied[static_cast<std::size_t>(level - 1)][below];
        if (squaredTo(box) < below_) descendToLowest(level - 1, below, at);
        return;
      }
      const bool lower = !found_ || std::pair(at[2], std::pair(at[1], at[0])) <
                                        std::pair(item_[2], std::pair(item_[1], item_[0]));
      if (lower) item_ = at;
      found_ = true;
    });
  }

  const VoxelTree::Data& tree_;
  const TreeBoxes& boxes_;
  Point p_;
  double enough2_ = 0.0;
  double tolerance_ = 0.0;
  double below_ = 0.0;  // squared: what is not nearer does not count, or no longer
  double squared_ = 0.0;
  Point u_{};
  double offset_ = 0.0;
  bool found_ = false;
  Item item_{};
  std::uint32_t nodesVisited_ = 0;
};

/// One query: the shell's spheres, nearest first, down to the points.
///
/// The answer is the smallest (squared distance, shell index). It is one pair whatever the order of
/// the search, because what is pruned is behind the best pair in that order.
template <int Bits>
class ShellSearch {
 public:
  ShellSearch(const VoxelTree::Data& tree, const ShellHierarchy& shell, const TreeBoxes& boxes,
              const std::vector<std::vector<std::uint32_t>>& lowestIndex, BoxList& list,
              const Eigen::Isometry3d& X_VT, double reach, double slack) noexcept
      : tree_(tree),
        shell_(shell),
        boxes_(boxes),
        lowestIndex_(lowestIndex),
        list_(list),
        X_VT_(X_VT),
        slack_(slack),
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
    const Point p = pointOf(rank_);
    NearestBox<Bits> box(tree_, boxes_, p);
    box.searchLowestAt(best2_);
    tests_ += box.nodesVisited();
    out.status = ClearanceStatus::Complete;
    out.distance = std::sqrt(best2_);
    out.shellIndex = index_;
    out.voxel = box.item();
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(out.voxel[a]);
      out.tool[a] = p.v[a];
      out.anatomy[a] = std::clamp(p.v[a], boxes_.face[a][i], boxes_.face[a][i + 1]);
    }
    out.tests = tests_;
  }
  [[nodiscard]] std::uint32_t rank() const noexcept { return rank_; }

 private:
  struct ShellNode {
    std::uint32_t node = 0;
    std::uint32_t lowestIndex = 0;
    double lower = 0.0;  // no point of the node is nearer, metres
    Item box{};          // occupied, near the centre
    [[nodiscard]] bool before(const ShellNode& other) const noexcept {
      return lower != other.lower ? lower < other.lower : lowestIndex < other.lowestIndex;
    }
  };

  [[nodiscard]] Point pointOf(std::uint32_t rank) const noexcept {
    return transformed(X_VT_, shell_.x[rank], shell_.y[rank], shell_.z[rank]);
  }
  // Where a point is in the anatomy already, only lower indices can win.
  [[nodiscard]] bool hopeless(double lower, std::uint32_t lowestIndex) const noexcept {
    return lower > best_ || (best2_ == 0.0 && lowestIndex > index_);
  }

  // Can a point of this sphere win? Then fills `out`.
  [[nodiscard]] bool reaches(std::size_t level, std::uint32_t node, const Item* seed,
                             ShellNode& out) noexcept {
    out.node = node;
    out.lowestIndex = lowestIndex_[level][node];
    if (hopeless(0.0, out.lowestIndex)) return false;
    const ShellSphere& sphere = shell_.level[level][node];
    const double radius = sphere.r + slack_;
    const double limit = best_ + radius;
    NearestBox<Bits> box(tree_, boxes_, transformed(X_VT_, sphere.c[0], sphere.c[1], sphere.c[2]));
    const double tolerance = kTolerance * sphere.r;
    box.roughly(radius, tolerance);
    box.search(limit * limit, seed);
    tests_ += 1 + box.nodesVisited();
    if (!box.found()) return false;
    out.lower = std::max(0.0, std::sqrt(box.squared()) - tolerance - radius);
    out.box = box.item();
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
    std::array<Point, ShellHierarchy::kGroup> p;
    for (std::size_t i = 0; i < count; ++i) p[i] = pointOf(static_cast<std::uint32_t>(first + i));
    const Point c = transformed(X_VT_, sphere.c[0], sphere.c[1], sphere.c[2]);
    Point u{};
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
    NearestBox<Bits> near(tree_, boxes_, c);
    near.list(limit * limit, u, ahead[front] + best_ + slack_, list_);
    tests_ += 1 + near.nodesVisited();
    if (list_.count == 0) return;
    for (std::size_t i = 0; i < count; ++i) {
      const auto rank = static_cast<std::uint32_t>(first + i);
      if (list_.full) {
        tryPoint(rank, p[i], &group.box);
      } else if (list_.front - ahead[i] <= best_ + slack_) {
        ++tests_;
        offer(rank, nearestSquared(list_, p[i]));
      }
    }
  }

  [[nodiscard]] Point directionTo(const Item& box, const Point& from) const noexcept {
    Point u{};
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(box[a]);
      u.v[a] = std::clamp(from.v[a], boxes_.face[a][i], boxes_.face[a][i + 1]) - from.v[a];
      squared += u.v[a] * u.v[a];
    }
    const double length = std::sqrt(squared);
    for (double& v : u.v) v /= length;
    return u;
  }

  void tryPoint(std::uint32_t rank, const Point& p, const Item* seed) noexcept {
    const double below = bound(shell_.order[rank]);
    if (below == 0.0) return;
    NearestBox<Bits> box(tree_, boxes_, p);
    box.search(below, seed);
    tests_ += 1 + box.nodesVisited();
    if (box.found()) offer(rank, box.squared());
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
  const TreeBoxes& boxes_;
  const std::vector<std::vector<std::uint32_t>>& lowestIndex_;
  BoxList& list_;
  const Eigen::Isometry3d& X_VT_;
  double slack_;  // more than rounding can err in a sphere's centre, radius and distance
  double best2_;
  double best_;
  std::uint32_t index_ = kNoPoint;
  std::uint32_t rank_ = kNoPoint;
  std::uint32_t tests_ = 0;
};

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

std::vector<double> facesAlong(const VoxelTree::Data& tree, std::size_t axis) {
  const auto a = static_cast<Eigen::Index>(axis);
  const std::size_t padded = std::size_t{1} << (tree.bits * tree.levels);
  std::vector<double> face;
  for (std::size_t i = 0; i <= padded; ++i) {
    face.push_back(tree.origin[a] + static_cast<double>(i) * tree.geometry.spacing[a]);
  }
  return face;
}

template <int Bits>
OccupiedBox fillOccupied(const VoxelTree::Data& tree, int level, std::uint32_t node,
                         const Item& corner, TreeBoxes& out) {
  using Mask = NodeMask<Bits>;
  const TreeLevel& at = tree.level[static_cast<std::size_t>(level)];
  const int shift = Bits * (level - 1);
  std::uint32_t next = level > 1 ? at.firstChild[node] : 0;
  OccupiedBox box;
  box.lo.fill(0xFFFF);
  forEachChild(Mask::load(at.masks.data(), node), [&](int child) {
    const Item lower = childCorner<Bits>(corner, child, shift);
    OccupiedBox part = boxOfItem(lower);
    if (level > 1) part = fillOccupied<Bits>(tree, level - 1, next++, lower, out);
    for (std::size_t a = 0; a < 3; ++a) {
      box.lo[a] = std::min(box.lo[a], part.lo[a]);
      box.hi[a] = std::max(box.hi[a], part.hi[a]);
    }
  });
  return out.occupied[static_cast<std::size_t>(level)][node] = box;
}

TreeBoxes boxesOf(const VoxelTree::Data& tree) {
  TreeBoxes boxes;
  for (std::size_t a = 0; a < 3; ++a) boxes.face[a] = facesAlong(tree, a);
  for (const TreeLevel& level : tree.level) boxes.occupied.emplace_back(level.firstChild.size());
  switch (tree.bits) {
    case 1:
      (void)fillOccupied<1>(tree, tree.levels, 0, {0, 0, 0}, boxes);
      break;
    case 2:
      (void)fillOccupied<2>(tree, tree.levels, 0, {0, 0, 0}, boxes);
      break;
    default:
      (void)fillOccupied<3>(tree, tree.levels, 0, {0, 0, 0}, boxes);
      break;
  }
  return boxes;
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
    if (voxels <= kMostVoxels) continue;
    return fail(inputRefused("The label volume is too long for a clearance.")
                    .inField("dims")
                    .butFound(std::to_string(voxels))
                    .wants("at most " + std::to_string(kMostVoxels) + " voxels along an axis")
                    .advise("Crop or resample the volume."));
  }
  if (!(options.maxReach >= 0.0)) {
    return fail(usageError("The reach of the clearance is not a length.")
                    .inField("maxReach")
                    .butFound(std::to_string(options.maxReach))
                    .wants("0 or more, metres"));
  }
  auto scratch = std::make_unique<Scratch>();
  scratch->tree = &tree.data();
  scratch->shell = &shell.data().hierarchy;
  scratch->reach = std::min(options.maxReach, kFarthestClearance);
  const VoxelTree::Data& data = tree.data();
  scratch->boxes = boxesOf(data);
  scratch->lowestIndex = lowestIndices(*scratch->shell);
  scratch->extent = shell.reach();
  for (const auto& face : scratch->boxes.face) scratch->extent += face.back() - face.front();
  return ClearanceFinder(std::move(scratch));
}

ClearanceFinder::ClearanceFinder(std::unique_ptr<Scratch> scratch) noexcept
    : scratch_(std::move(scratch)) {}
ClearanceFinder::ClearanceFinder(ClearanceFinder&&) noexcept = default;
ClearanceFinder& ClearanceFinder::operator=(ClearanceFinder&&) noexcept = default;
ClearanceFinder::~ClearanceFinder() = default;

Clearance ClearanceFinder::find(const Eigen::Isometry3d& X_VT) noexcept {
  Clearance result;
  if (!isRigidPose(X_VT)) {
    result.status = ClearanceStatus::BadPose;
    return result;
  }
  Scratch& s = *scratch_;
  // A billionth of a voxel and 2^-40 of the lengths involved; a transform errs by a few 2^-53.
  const double far = X_VT.translation().cwiseAbs().maxCoeff() + s.extent;
  const double slack = 1e-9 * s.tree->geometry.spacing.minCoeff() + 0x1p-40 * far;
  const auto run = [&](auto bits) {
    ShellSearch<decltype(bits)::value> search(*s.tree, *s.shell, s.boxes, s.lowestIndex, s.list,
                                              X_VT, s.reach, slack);
    search.run(s.lastRank);
    search.writeTo(result);
    if (search.rank() != kNoPoint) s.lastRank = search.rank();
  };
  switch (s.tree->bits) {
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
