/// QueryMethod::Paper: both trees descended breadth-first by sphere tests (paper 3.2).
///
/// The world is its implicit sphere tree, in V. A voxel body is its own implicit sphere tree (over
/// its surface voxels, whose centres are the shell points) with the same branching: its axes are
/// turned into V and scaled for each level once a query, then a node's sphere follows from level,
/// address and mask as on the world's side. A shell of points without voxels is the tree of stored
/// spheres over its points.
///
/// Departures from the paper: a leaf of a body is its shell point, since the point alone decides
/// (testing the voxel's sphere instead costs up to 1 % more tests); where the frontier would
/// outgrow its scratch the rest is descended depth-first, the larger sphere of a pair at a time,
/// which finds the same points.
///
/// Which side is descended, measured in tests a query (a bent rod of 2802 surface voxels through a
/// rough tube of 96 x 96 x 80; voxel leaves, tight spheres, one-child skip; 8, 64, 512 children):
///   a body, both sides at once as the paper has it   18.5, 32.3, 105.2 thousand
///   a body, the larger side                          18.4, 36.9, 131.5 thousand
///   points, both sides at once                       28.4, 24.8,  32.9 thousand
///   points, the larger side                          18.8, 26.1,  33.3 thousand
/// so both for bodies and the larger for points.

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/collision/pose_stretch.h"
#include "core/collision/query_work.h"

namespace palpate {
namespace {

using Sphere = PaperSphere;

// Levels that a tree can have: 2^30 items along an axis, and level 0.
constexpr std::size_t kMaxLevels = 32;

bool overlap(const Sphere& a, const Sphere& b) noexcept {
  const double dx = a.c[0] - b.c[0];
  const double dy = a.c[1] - b.c[1];
  const double dz = a.c[2] - b.c[2];
  const double r = a.r + b.r;
  return dx * dx + dy * dy + dz * dz <= r * r;
}

SphereKind kindOf(const QueryOptions& options) noexcept {
  return options.tightSpheres ? SphereKind::Tight
         : options.sideOffset ? SphereKind::SideOffset
                              : SphereKind::Full;
}

// An N-tree of voxels as it stands in V: the world's with the frame's own axes, a body's with
// turned ones. Nothing of a node is stored but its mask and its link.
//
// One-child skip: a node with one child gets the sphere of the last node of its chain, which holds
// all that the node holds, and the chain is not tested again. (Testing the chain's first node and
// no other, as the words would have it, costs more tests than it saves where spheres are full.)
template <int Bits>
class VoxelSide {
 public:
  /// @param origin  lower corner of item (0, 0, 0).
  /// @param edges   columns: the edges of an item.
  /// @param last    level of the nodes that are not descended; they stand for their whole box.
  VoxelSide(std::span<const TreeLevel> level, const PatternSpheres& spheres, const double origin[3],
            const double edges[3][3], int last, bool oneChildSkip) noexcept
      : level_(level), spheres_(spheres), last_(last), skip_(oneChildSkip) {
    for (int i = 0; i < 3; ++i) origin_[i] = origin[i];
    for (std::size_t l = 0; l < level.size(); ++l) {
      scale_[l] = std::ldexp(1.0, Bits * (static_cast<int>(l) - 1));
      for (int i = 0; i < 3; ++i) {
        for (int a = 0; a < 3; ++a) childEdge_[l][i][a] = scale_[l] * edges[i][a];
      }
    }
  }

  [[nodiscard]] TreeNode root() const noexcept {
    TreeNode node;
    node.level = static_cast<std::int32_t>(level_.size()) - 1;
    return node;
  }
  [[nodiscard]] bool ends(const TreeNode& node) const noexcept { return node.level <= last_; }
  /// Is the node's child already tested with it?
  [[nodiscard]] bool skips(const TreeNode& node) const noexcept {
    return skip_ && hasOneChild(maskOf(node));
  }
  /// The node whose sphere stands for this one.
  [[nodiscard]] TreeNode standIn(const TreeNode& node) const noexcept {
    return skip_ ? endOfChain(node) : node;
  }
  [[nodiscard]] Sphere sphere(const TreeNode& node) const noexcept {
    return ownSphere(standIn(node));
  }
  [[nodiscard]] Sphere ownSphere(const TreeNode& node) const noexcept {
    const PatternSphere& s = ends(node) ? spheres_.full() : spheres_.of(maskOf(node));
    const auto l = static_cast<std::size_t>(node.level);
    double u[3];  // from the origin, in edges of a child
    for (std::size_t a = 0; a < 3; ++a) {
      u[a] = (node.address[a] + 0.5) * Mask::kEdge + s.offset[a];
    }
    Sphere out;
    for (int i = 0; i < 3; ++i) {
      const auto& e = childEdge_[l][i];
      out.c[i] = origin_[i] + ((u[0] * e[0] + u[1] * e[1]) + u[2] * e[2]);
    }
    out.r = s.radius * scale_[l];
    return out;
  }
  /// Of the node's whole box.
  [[nodiscard]] double fullRadius(const TreeNode& node) const noexcept {
    return spheres_.full().radius * scale_[static_cast<std::size_t>(node.level)];
  }

  template <class F>
  void forEachChild(const TreeNode& node, F&& f) const noexcept {
    TreeNode child = firstChild(node);
    palpate::forEachChild(maskOf(node), [&](int c) {
      child.address = addressOf(node, c);
      f(std::as_const(child));
      ++child.index;
    });
  }

 private:
  using Mask = NodeMask<Bits>;

  [[nodiscard]] Mask maskOf(const TreeNode& node) const noexcept {
    return Mask::load(level_[static_cast<std::size_t>(node.level)].masks.data(), node.index);
  }
  [[nodiscard]] static bool hasOneChild(const Mask& mask) noexcept {
    std::size_t words = 0;
    bool single = true;
    for (const std::uint64_t w : mask.word) {
      words += w != 0 ? 1 : 0;
      single = single && (w & (w - 1)) == 0;
    }
    return single && words == 1;
  }
  [[nodiscard]] TreeNode firstChild(const TreeNode& node) const noexcept {
    const auto& links = level_[static_cast<std::size_t>(node.level)].firstChild;
    TreeNode child;
    child.level = node.level - 1;
    child.index = links.empty() ? 0 : links[node.index];  // cells carry nothing of their own
    return child;
  }
  [[nodiscard]] static Item addressOf(const TreeNode& node, int c) noexcept {
    return {(node.address[0] << Bits) + (c & Mask::kLow),
            (node.address[1] << Bits) + ((c >> Bits) & Mask::kLow),
            (node.address[2] << Bits) + (c >> (2 * Bits))};
  }
  [[nodiscard]] TreeNode endOfChain(TreeNode node) const noexcept {
    while (!ends(node)) {
      const Mask mask = maskOf(node);
      if (!hasOneChild(mask)) break;
      TreeNode child = firstChild(node);
      palpate::forEachChild(mask, [&](int c) { child.address = addressOf(node, c); });
      node = child;
    }
    return node;
  }

  std::span<const TreeLevel> level_;
  const PatternSpheres& spheres_;
  int last_;
  bool skip_;
  double origin_[3];
  double scale_[kMaxLevels];            // by a node's level: edge of its child, items
  double childEdge_[kMaxLevels][3][3];  // by a node's level: edges of its child, columns
};

template <int Bits>
VoxelSide<Bits> worldSide(const QueryWork& work) noexcept {
  const VoxelTree::Data& tree = *work.tree;
  double origin[3];
  double edges[3][3] = {};
  for (int a = 0; a < 3; ++a) {
    origin[a] = tree.origin[a];
    edges[a][a] = tree.geometry.spacing[a];
  }
  return {tree.level, work.paper.worldSpheres, origin,
          edges,      work.stopLevel,          work.options.oneChildSkip};
}

// The shell's point of a rank, where the pose puts it.
Sphere pointSphere(const QueryWork& work, std::uint32_t rank) noexcept {
  Sphere s;
  work.pose.apply(work.shell->x[rank], work.shell->y[rank], work.shell->z[rank], s.c);
  s.r = work.slack;
  return s;
}

// The tool as a voxel body: its own tree.
template <int Bits>
class BodySide {
 public:
  static constexpr bool kDescendBoth = true;

  explicit BodySide(const QueryWork& work) noexcept
      : BodySide(work, *work.paper.body, Placed(work.pose, *work.paper.body)) {}

  [[nodiscard]] TreeNode root() const noexcept { return voxels_.root(); }
  [[nodiscard]] bool ends(const TreeNode& node) const noexcept { return voxels_.ends(node); }
  [[nodiscard]] bool skips(const TreeNode& node) const noexcept { return voxels_.skips(node); }
  [[nodiscard]] Sphere sphere(const TreeNode& node) const noexcept {
    const TreeNode at = voxels_.standIn(node);
    if (ends(at)) return pointSphere(work_, rankOf(at));
    Sphere s = voxels_.ownSphere(at);
    s.r = s.r * stretch_ + slack_;
    return s;
  }
  template <class F>
  void forEachChild(const TreeNode& node, F&& f) const noexcept {
    voxels_.forEachChild(node, f);
  }
  [[nodiscard]] std::uint32_t rankOf(const TreeNode& leaf) const noexcept {
    return tree_.rank[leaf.index];
  }

 private:
  // The body's corner and axes in V: turned once a query.
  struct Placed {
    Placed(const QueryPose& pose, const VoxelBody& body) noexcept {
      pose.apply(body.origin_T.x(), body.origin_T.y(), body.origin_T.z(), origin);
      double axes[3][3];
      for (int i = 0; i < 3; ++i) {
        const double* r = pose.r[i];
        for (int a = 0; a < 3; ++a) {
          axes[i][a] =
              (r[0] * body.axes_T(0, a) + r[1] * body.axes_T(1, a)) + r[2] * body.axes_T(2, a);
          edges[i][a] = axes[i][a] * body.spacing[a];
        }
      }
      stretch = stretchOf(axes);
    }
    double origin[3];
    double edges[3][3];
    double stretch = 1.0;
  };

  BodySide(const QueryWork& work, const VoxelBody& body, const Placed& placed) noexcept
      : work_(work),
        tree_(body.tree[Bits - 1]),
        stretch_(placed.stretch),
        slack_(work.slack + body.slack),
        voxels_(tree_.level, work.paper.bodySpheres, placed.origin, placed.edges, 0,
                work.options.oneChildSkip) {}

  const QueryWork& work_;
  const BodyTree& tree_;
  double stretch_;
  double slack_;
  VoxelSide<Bits> voxels_;
};

// The tool as points: the spheres of its hierarchy. Level 0 are the points, level l + 1 is the
// hierarchy's level l.
class PointSide {
 public:
  static constexpr bool kDescendBoth = false;

  explicit PointSide(const QueryWork& work) noexcept
      : work_(work), shell_(*work.shell), stretch_(stretchOf(work.pose.r)) {}

  [[nodiscard]] TreeNode root() const noexcept {
    TreeNode node;
    node.level = static_cast<std::int32_t>(shell_.level.size());
    return node;
  }
  [[nodiscard]] bool ends(const TreeNode& node) const noexcept { return node.level == 0; }
  /// A child that holds the same points has the same sphere.
  [[nodiscard]] bool skips(const TreeNode& node) const noexcept {
    const auto [first, last] = children(node);
    return work_.options.oneChildSkip && last - first == 1;
  }
  [[nodiscard]] Sphere sphere(const TreeNode& node) const noexcept {
    if (ends(node)) return pointSphere(work_, rankOf(node));
    const ShellSphere& from = shell_.level[static_cast<std::size_t>(node.level - 1)][node.index];
    Sphere s;
    work_.pose.apply(from.c[0], from.c[1], from.c[2], s.c);
    s.r = from.r * stretch_ + work_.slack;
    return s;
  }
  template <class F>
  void forEachChild(const TreeNode& node, F&& f) const noexcept {
    const auto [first, last] = children(node);
    TreeNode child;
    child.level = node.level - 1;
    for (std::size_t c = first; c < last; ++c) {
      child.index = static_cast<std::uint32_t>(c);
      f(std::as_const(child));
    }
  }
  [[nodiscard]] std::uint32_t rankOf(const TreeNode& leaf) const noexcept { return leaf.index; }

 private:
  [[nodiscard]] std::pair<std::size_t, std::size_t> children(const TreeNode& node) const noexcept {
    const bool toPoints = node.level == 1;
    const std::size_t arity = toPoints ? ShellHierarchy::kGroup : ShellHierarchy::kArity;
    const std::size_t below =
        toPoints ? shell_.size() : shell_.level[static_cast<std::size_t>(node.level - 2)].size();
    const std::size_t first = node.index * arity;
    return {first, std::min(first + arity, below)};
  }

  const QueryWork& work_;
  const ShellHierarchy& shell_;
  double stretch_;
};

template <int Bits, class ToolSide>
class PairDescent {
 public:
  explicit PairDescent(QueryWork& work) noexcept
      : work_(work), paper_(work.paper), tool_(work), world_(worldSide<Bits>(work)), sink_(work) {}

  void run() noexcept {
    const NodePair root{tool_.root(), world_.root()};
    if (!meet(tool_.sphere(root.tool), world_.sphere(root.world))) return;
    std::size_t count = 0;
    if (!atLeaf(root)) paper_.pairs[count++] = root;
    while (count > 0) {
      nextCount_ = 0;
      for (std::size_t i = 0; i < count; ++i) descend(paper_.pairs[i]);
      std::swap(paper_.pairs, paper_.nextPairs);
      count = nextCount_;
    }
  }

 private:
  [[nodiscard]] bool meet(const Sphere& tool, const Sphere& world) noexcept {
    ++work_.tests;
    return overlap(tool, world);
  }

  // A point in an item (or in a node where descent stops): to the leaf test, if it is its own.
  [[nodiscard]] bool atLeaf(const NodePair& p) noexcept {
    if (!tool_.ends(p.tool) || !world_.ends(p.world)) return false;
    const std::uint32_t rank = tool_.rankOf(p.tool);
    Item item;
    if (!sink_.itemOf(rank, item)) return true;
    for (std::size_t a = 0; a < 3; ++a) {
      if ((item[a] >> (Bits * p.world.level)) != p.world.address[a]) return true;
    }
    sink_.offer(rank);
    return true;
  }

  void push(const TreeNode& tool, const TreeNode& world) noexcept {
    const NodePair p{tool, world};
    if (atLeaf(p)) return;
    if (nextCount_ < paper_.nextPairs.size()) {
      paper_.nextPairs[nextCount_++] = p;
    } else {
      descendLarger(p);  // not both: their scratch may be in use further up
    }
  }

  void descend(const NodePair& p) noexcept {
    if constexpr (ToolSide::kDescendBoth) {
      if (!tool_.ends(p.tool) && !world_.ends(p.world)) return descendBoth(p);
    }
    descendLarger(p);
  }

  // Children of either against the other, then those left against each other. An only child has
  // had its parent's tests, so its pairs need none.
  void descendBoth(const NodePair& p) noexcept {
    const Sphere tool = tool_.sphere(p.tool);
    const bool skipWorld = world_.skips(p.world);
    std::size_t left = 0;
    world_.forEachChild(p.world, [&](const TreeNode& child) {
      const Sphere sphere = world_.sphere(child);
      if (skipWorld || meet(tool, sphere)) paper_.children[left++] = {child, sphere};
    });
    if (left == 0) return;
    const Sphere world = world_.sphere(p.world);
    const bool skipTool = tool_.skips(p.tool);
    tool_.forEachChild(p.tool, [&](const TreeNode& child) {
      const Sphere sphere = tool_.sphere(child);
      if (!skipTool && !meet(sphere, world)) return;
      for (std::size_t i = 0; i < left; ++i) {
        const auto& other = paper_.children[i];
        if (skipTool || skipWorld || meet(sphere, other.sphere)) push(child, other.node);
      }
    });
  }

  void descendLarger(const NodePair& p) noexcept {
    const Sphere tool = tool_.sphere(p.tool);
    if (!world_.ends(p.world) && (tool_.ends(p.tool) || world_.fullRadius(p.world) >= tool.r)) {
      const bool skip = world_.skips(p.world);
      world_.forEachChild(p.world, [&](const TreeNode& child) {
        if (skip || meet(tool, world_.sphere(child))) push(p.tool, child);
      });
    } else {
      const Sphere world = world_.sphere(p.world);
      const bool skip = tool_.skips(p.tool);
      tool_.forEachChild(p.tool, [&](const TreeNode& child) {
        if (skip || meet(tool_.sphere(child), world)) push(child, p.world);
      });
    }
  }

  QueryWork& work_;
  PaperWork& paper_;
  ToolSide tool_;
  VoxelSide<Bits> world_;
  PointSink<Bits> sink_;
  std::size_t nextCount_ = 0;
};

}  // namespace

void preparePaper(QueryWork& work, const VoxelBody* voxels) {
  PaperWork& paper = work.paper;
  const VoxelTree::Data& tree = *work.tree;
  const SphereKind kind = kindOf(work.options);
  paper.worldSpheres = PatternSpheres(tree.bits, tree.geometry.spacing, kind, tree.level);
  paper.body = voxels;
  if (voxels != nullptr) {
    const BodyTree& body = paper.body->tree[static_cast<std::size_t>(tree.bits - 1)];
    paper.bodySpheres = PatternSpheres(tree.bits, paper.body->spacing, kind, body.level);
  }
  // Enough for a true breadth-first descent of common scenes; beyond it goes depth-first.
  const std::size_t groups = work.shell->level[0].size();
  const std::size_t pairs = std::clamp<std::size_t>(groups * 64, 1024, std::size_t{1} << 20);
  paper.pairs.resize(pairs);
  paper.nextPairs.resize(pairs);
  paper.children.resize(std::size_t{1} << (3 * tree.bits));
}

template <int Bits>
void runPaper(QueryWork& work) noexcept {
  if (work.paper.body != nullptr) {
    PairDescent<Bits, BodySide<Bits>>(work).run();
  } else {
    PairDescent<Bits, PointSide>(work).run();
  }
}

template void runPaper<1>(QueryWork&) noexcept;
template void runPaper<2>(QueryWork&) noexcept;
template void runPaper<3>(QueryWork&) noexcept;

}  // namespace palpate
