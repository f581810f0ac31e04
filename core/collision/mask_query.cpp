/// QueryMethod::Hierarchy where fast_query.h does not apply (voxel leaves, surface-only trees, a
/// level where descent stops): spheres over the shell's points, level by level, against the masks
/// of the tree.
///
/// A sphere survives when an item, or a whole node that is small against it, lies within its
/// radius. The tree answers from its masks: the children of a node that the sphere's box meets
/// are one AND of the mask with a box of bits, so empty space costs a few words.

#include <algorithm>
#include <utility>

#include "core/collision/pose_stretch.h"
#include "core/collision/query_work.h"

namespace palpate {
namespace {

// A node whose longest edge is below this share of the sphere's radius answers for its items: going
// on would refine the sphere's rim by less than the sphere's own looseness. Smaller costs more
// tests of boxes, larger more of spheres and points; the contacts are the same.
constexpr double kNodeShare = 1.0;

// The children x0..x1, y0..y1, z0..z1 of a node as a mask.
template <int Bits>
NodeMask<Bits> boxMask(const Item& lo, const Item& hi) noexcept {
  constexpr int kEdge = NodeMask<Bits>::kEdge;
  const auto run = [](std::int32_t a, std::int32_t b, int stride) {
    // One bit every `stride` for a..b.
    std::uint64_t bits = 0;
    for (std::int32_t i = a; i <= b; ++i) bits |= std::uint64_t{1} << (i * stride);
    return bits;
  };
  const std::uint64_t row = ((std::uint64_t{1} << (hi[0] - lo[0] + 1)) - 1) << lo[0];
  const std::uint64_t slab = row * run(lo[1], hi[1], kEdge);  // no carries: bits do not meet
  NodeMask<Bits> mask;
  if constexpr (Bits == 3) {
    for (std::int32_t z = lo[2]; z <= hi[2]; ++z) mask.word[static_cast<std::size_t>(z)] = slab;
  } else {
    mask.word[0] = slab * run(lo[2], hi[2], kEdge * kEdge);
  }
  return mask;
}

// One sphere in the tree's lattice.
template <int Bits>
class SphereProbe {
 public:
  /// @param stopLevel  nodes of this level answer for what is in them.
  SphereProbe(const VoxelTree::Data& tree, int stopLevel, const double centre[3],
              double radius) noexcept
      : tree_(tree),
        lastLevel_(stopLevel + 1),
        radius2_(radius * radius),
        small_(kNodeShare * radius / tree.geometry.spacing.maxCoeff()) {
    for (std::size_t a = 0; a < 3; ++a) {
      const auto axis = static_cast<Eigen::Index>(a);
      spacing_[a] = tree.geometry.spacing[axis];
      centre_[a] = centre[a] - tree.origin[axis];
      const double last = tree.extent[a] - 1;
      const double lo = (centre_[a] - radius) / spacing_[a];
      const double hi = (centre_[a] + radius) / spacing_[a];
      // A closed far face belongs to the last item: hence "<= extent". What is not a number is far.
      if (!(hi >= 0.0 && lo <= last + 1.0)) {
        reaches_ = false;
        return;
      }
      lo_[a] = static_cast<std::int32_t>(std::clamp(lo, 0.0, last));
      hi_[a] = static_cast<std::int32_t>(std::clamp(hi, 0.0, last));
    }
  }

  [[nodiscard]] bool touches(std::uint32_t& tests) noexcept {
    tests_ = 1;
    const bool found =
        reaches_ && (lastLevel_ > tree_.levels || descend(tree_.levels, 0, {0, 0, 0}));
    tests += tests_;
    return found;
  }

 private:
  [[nodiscard]] bool descend(int level, std::uint32_t node, const Item& lower) noexcept {
    using Mask = NodeMask<Bits>;
    const TreeLevel& at = tree_.level[static_cast<std::size_t>(level)];
    const int shift = Bits * (level - 1);
    Item lo;
    Item hi;
    for (std::size_t a = 0; a < 3; ++a) {
      lo[a] = std::max((lo_[a] - lower[a]) >> shift, 0);
      hi[a] = std::min((hi_[a] - lower[a]) >> shift, Mask::kEdge - 1);
    }
    const Mask mask = Mask::load(at.masks.data(), node);
    const Mask box = boxMask<Bits>(lo, hi);
    const bool last = level <= lastLevel_ || static_cast<double>(1 << shift) <= small_;
    for (std::size_t w = 0; w < Mask::kWords; ++w) {
      for (std::uint64_t bits = mask.word[w] & box.word[w]; bits != 0; bits &= bits - 1) {
        const int child = static_cast<int>(w * 64) + std::countr_zero(bits);
        const Item corner{lower[0] + ((child & Mask::kLow) << shift),
                          lower[1] + (((child >> Bits) & Mask::kLow) << shift),
                          lower[2] + ((child >> (2 * Bits)) << shift)};
        if (!reachesBox(corner, 1 << shift)) continue;
        if (last) return true;
        const auto next = at.firstChild[node] + static_cast<std::uint32_t>(mask.rank(child));
        if (descend(level - 1, next, corner)) return true;
      }
    }
    return false;
  }
  // Is the box of `edge` items a side at `corner` within the radius?
  [[nodiscard]] bool reachesBox(const Item& corner, std::int32_t edge) noexcept {
    ++tests_;
    double d2 = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const double near = corner[a] * spacing_[a] - centre_[a];
      const double far = centre_[a] - (corner[a] + edge) * spacing_[a];
      const double d = std::max(0.0, std::max(near, far));
      d2 += d * d;
    }
    return d2 <= radius2_;
  }

  const VoxelTree::Data& tree_;
  int lastLevel_;
  double centre_[3] = {0, 0, 0};  // from the tree's origin, metres
  double spacing_[3] = {1, 1, 1};
  double radius2_;
  double small_;  // edge of a small node, items
  Item lo_{}, hi_{};
  bool reaches_ = true;
  std::uint32_t tests_ = 0;
};

}  // namespace

template <int Bits>
void runMasks(QueryWork& work) noexcept {
  const ShellHierarchy& shell = *work.shell;
  const double stretch = stretchOf(work.pose.r);
  std::size_t count = 1;
  work.frontier[0] = 0;  // the root
  for (std::size_t l = shell.level.size(); l-- > 0;) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t node = work.frontier[i];
      const ShellSphere& sphere = shell.level[l][node];
      double centre[3];
      work.pose.apply(sphere.c[0], sphere.c[1], sphere.c[2], centre);
      SphereProbe<Bits> probe(*work.tree, work.stopLevel, centre, sphere.r * stretch + work.slack);
      if (!probe.touches(work.tests)) continue;
      if (l == 0) {
        work.nextFrontier[next++] = node;
        continue;
      }
      const std::size_t first = node * ShellHierarchy::kArity;
      const std::size_t last = std::min(first + ShellHierarchy::kArity, shell.level[l - 1].size());
      for (std::size_t c = first; c < last; ++c) {
        work.nextFrontier[next++] = static_cast<std::uint32_t>(c);
      }
    }
    std::swap(work.frontier, work.nextFrontier);
    count = next;
  }
  PointSink<Bits> sink(work);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t first = work.frontier[i] * ShellHierarchy::kGroup;
    const std::size_t last = std::min(first + ShellHierarchy::kGroup, shell.size());
    for (std::size_t rank = first; rank < last; ++rank) {
      sink.offer(static_cast<std::uint32_t>(rank));
    }
  }
}

template void runMasks<1>(QueryWork&) noexcept;
template void runMasks<2>(QueryWork&) noexcept;
template void runMasks<3>(QueryWork&) noexcept;

}  // namespace palpate
