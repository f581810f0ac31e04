/// QueryMethod::Paper: both trees descended breadth-first by sphere tests (paper 3.2).
///
/// Both spheres are compared in V, where the tree's axes are the frame's own, so that turning the
/// tool costs one transform a shell sphere and nothing on the tree's side. Departures from the
/// paper: the shell's tree is one of stored spheres over points (its points are not on a lattice),
/// not a second octree; of a pair the larger side is descended; where the frontier would outgrow
/// its scratch the rest is descended depth-first, which visits the same pairs.

#include <algorithm>
#include <utility>

#include "core/collision/query_work.h"

namespace palpate {
namespace {

struct Sphere {
  double c[3] = {0, 0, 0};
  double r = 0;
};

bool overlap(const Sphere& a, const Sphere& b) noexcept {
  const double dx = a.c[0] - b.c[0];
  const double dy = a.c[1] - b.c[1];
  const double dz = a.c[2] - b.c[2];
  const double r = a.r + b.r;
  return dx * dx + dy * dy + dz * dz <= r * r;
}

template <int Bits>
class PairDescent {
 public:
  explicit PairDescent(QueryWork& work) noexcept
      : work_(work),
        tree_(*work.tree),
        shell_(*work.shell),
        sink_(work),
        kind_(work.options.tightSpheres ? SphereKind::Tight
              : work.options.sideOffset ? SphereKind::SideOffset
                                        : SphereKind::Full) {}

  void run() noexcept {
    NodePair root;
    root.shellLevel = static_cast<std::int16_t>(shell_.level.size() - 1);
    root.treeLevel = static_cast<std::int16_t>(tree_.levels);
    ++work_.tests;
    if (!overlap(shellSphere(root.shellLevel, 0), treeSphere(root))) return;
    std::size_t count = 0;
    if (!atLeaf(root)) work_.pairs[count++] = root;
    while (count > 0) {
      nextCount_ = 0;
      for (std::size_t i = 0; i < count; ++i) descend(work_.pairs[i]);
      std::swap(work_.pairs, work_.nextPairs);
      count = nextCount_;
    }
  }

 private:
  using Mask = NodeMask<Bits>;

  [[nodiscard]] Sphere shellSphere(std::int16_t level, std::uint32_t node) const noexcept {
    Sphere s;
    if (level == kPointLevel) {
      work_.pose.apply(shell_.x[node], shell_.y[node], shell_.z[node], s.c);
      s.r = work_.slack;
    } else {
      const ShellSphere& from = shell_.level[static_cast<std::size_t>(level)][node];
      work_.pose.apply(from.c[0], from.c[1], from.c[2], s.c);
      s.r = from.r + work_.slack;
    }
    return s;
  }

  // Centre and radius follow from the address, the level and, where tight, the mask.
  [[nodiscard]] Sphere treeSphere(const NodePair& p) const noexcept {
    NodeSphere relative;
    if (p.treeLevel <= work_.stopLevel) {
      // An item; or a node that stands for all of its box, since descent stops here.
      relative.radius = tree_.spheres.fullRadius(p.treeLevel);
    } else {
      const TreeLevel& at = tree_.level[static_cast<std::size_t>(p.treeLevel)];
      relative = tree_.spheres.sphere(Mask::load(at.masks.data(), p.tree), p.treeLevel, kind_);
    }
    Sphere s;
    const double edge = std::ldexp(1.0, Bits * p.treeLevel);
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      s.c[a] = tree_.origin[axis] + (p.address[a] + 0.5) * edge * tree_.geometry.spacing[axis] +
               relative.offset[axis];
    }
    s.r = relative.radius;
    return s;
  }

  // A point in an item (or in a node where descent stops): to the leaf test, if it is its own.
  [[nodiscard]] bool atLeaf(const NodePair& p) noexcept {
    if (p.shellLevel != kPointLevel || p.treeLevel > work_.stopLevel) return false;
    Item item;
    if (!sink_.itemOf(p.shell, item)) return true;
    for (std::size_t a = 0; a < 3; ++a) {
      if ((item[a] >> (Bits * p.treeLevel)) != p.address[a]) return true;
    }
    sink_.offer(p.shell);
    return true;
  }

  void push(const NodePair& p) noexcept {
    if (atLeaf(p)) return;
    if (nextCount_ < work_.nextPairs.size()) {
      work_.nextPairs[nextCount_++] = p;
    } else {
      descend(p);
    }
  }

  void descend(const NodePair& p) noexcept {
    const Sphere shell = shellSphere(p.shellLevel, p.shell);
    const bool canTree = p.treeLevel > work_.stopLevel;
    const bool canShell = p.shellLevel != kPointLevel;
    if (canTree && (!canShell || tree_.spheres.fullRadius(p.treeLevel) >= shell.r)) {
      descendTree(p, shell);
    } else {
      descendShell(p);
    }
  }

  void descendTree(const NodePair& p, const Sphere& shell) noexcept {
    const TreeLevel& at = tree_.level[static_cast<std::size_t>(p.treeLevel)];
    const Mask mask = Mask::load(at.masks.data(), p.tree);
    const bool skip = work_.options.oneChildSkip && mask.count() == 1;
    std::uint32_t next = p.treeLevel == 1 ? 0 : at.firstChild[p.tree];  // items need no index
    forEachChild(mask, [&](int c) {
      NodePair child = p;
      child.tree = next++;
      child.treeLevel = static_cast<std::int16_t>(p.treeLevel - 1);
      child.address = {(p.address[0] << Bits) + (c & Mask::kLow),
                       (p.address[1] << Bits) + ((c >> Bits) & Mask::kLow),
                       (p.address[2] << Bits) + (c >> (2 * Bits))};
      if (!skip) {
        ++work_.tests;
        if (!overlap(shell, treeSphere(child))) return;
      }
      push(child);
    });
  }

  void descendShell(const NodePair& p) noexcept {
    const Sphere tree = treeSphere(p);
    const bool toPoints = p.shellLevel == 0;
    const std::size_t arity = toPoints ? ShellHierarchy::kGroup : ShellHierarchy::kArity;
    const std::size_t below =
        toPoints ? shell_.size() : shell_.level[static_cast<std::size_t>(p.shellLevel - 1)].size();
    const std::size_t first = p.shell * arity;
    const std::size_t last = std::min(first + arity, below);
    const bool skip = work_.options.oneChildSkip && last - first == 1;
    for (std::size_t c = first; c < last; ++c) {
      NodePair child = p;
      child.shell = static_cast<std::uint32_t>(c);
      child.shellLevel = static_cast<std::int16_t>(p.shellLevel - 1);
      if (!skip) {
        ++work_.tests;
        if (!overlap(shellSphere(child.shellLevel, child.shell), tree)) continue;
      }
      push(child);
    }
  }

  QueryWork& work_;
  const VoxelTree::Data& tree_;
  const ShellHierarchy& shell_;
  PointSink<Bits> sink_;
  SphereKind kind_;
  std::size_t nextCount_ = 0;
};

}  // namespace

template <int Bits>
void runPaper(QueryWork& work) noexcept {
  PairDescent<Bits>(work).run();
}

template void runPaper<1>(QueryWork&) noexcept;
template void runPaper<2>(QueryWork&) noexcept;
template void runPaper<3>(QueryWork&) noexcept;

}  // namespace palpate
