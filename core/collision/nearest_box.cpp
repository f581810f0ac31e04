#include "core/collision/nearest_box.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/voxels/node_mask.h"

namespace palpate {
namespace {

template <int Bits>
class NearestDescent {
 public:
  NearestDescent(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& p,
                 double below, const NearEnough& enough) noexcept
      : tree_(tree),
        boxes_(boxes),
        p_(p),
        enough2_(enough.within * enough.within),
        tolerance_(enough.tolerance),
        below_(below) {}

  NearestBox run(const VoxelIndex* seed) noexcept {
    if (seed != nullptr) {
      const double d2 = squaredTo(boxes_, boxOfVoxel(*seed), p_);
      if (d2 < below_) accept(d2, *seed);
    }
    descend(tree_.levels, 0, {0, 0, 0});
    return best_;
  }

 private:
  using Mask = NodeMask<Bits>;
  struct Child {
    double d2;
    std::int32_t child;
    std::uint32_t node;
  };

  void accept(double d2, const VoxelIndex& voxel) noexcept {
    best_.found = true;
    best_.voxel = voxel;
    best_.squared = d2;
    below_ = d2;
    if (d2 <= enough2_) {
      below_ = 0.0;
    } else if (tolerance_ > 0.0) {
      const double rest = std::max(0.0, std::sqrt(d2) - tolerance_);
      below_ = rest * rest;
    }
  }

  void descend(int level, std::uint32_t node, const VoxelIndex& corner) noexcept {
    ++best_.nodesVisited;
    const TreeLevel& at = tree_.level[static_cast<std::size_t>(level)];
    const int shift = Bits * (level - 1);
    const Mask mask = Mask::load(at.masks.data(), node);
    const SlabDistances<Bits> slab = slabDistances<Bits>(boxes_, p_, corner, shift);
    if (level == 1) {
      forEachCloser(mask, slab, below_,
                    [&](int child, double d2) { accept(d2, childCorner<Bits>(corner, child, 0)); });
      return;
    }
    // A selection as far as it is needed: mostly the first child leaves no other.
    Child open[Mask::kChildren];
    std::size_t count = 0;
    const auto& occupied = boxes_.occupied[static_cast<std::size_t>(level - 1)];
    forEachCloser(mask, slab, below_, [&](int child, double) {
      const std::uint32_t below = childNode(at, node, mask, child);
      const double d2 = squaredTo(boxes_, occupied[below], p_);
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

  const VoxelTree::Data& tree_;
  const OccupiedBoxes& boxes_;
  Vec3 p_;
  double enough2_;
  double tolerance_;
  double below_;  // squared: what is not nearer does not count, or no longer
  NearestBox best_;
};

template <int Bits>
class LowestDescent {
 public:
  LowestDescent(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& p,
                double squared) noexcept
      : tree_(tree), boxes_(boxes), p_(p), below_(justAbove(squared)) {
    lowest_.squared = squared;
  }

  NearestBox run() noexcept {
    descend(tree_.levels, 0, {0, 0, 0});
    return lowest_;
  }

 private:
  void descend(int level, std::uint32_t node, const VoxelIndex& corner) noexcept {
    ++lowest_.nodesVisited;
    const TreeLevel& at = tree_.level[static_cast<std::size_t>(level)];
    const int shift = Bits * (level - 1);
    const auto mask = NodeMask<Bits>::load(at.masks.data(), node);
    const SlabDistances<Bits> slab = slabDistances<Bits>(boxes_, p_, corner, shift);
    forEachCloser(mask, slab, below_, [&](int child, double) {
      const VoxelIndex lower = childCorner<Bits>(corner, child, shift);
      if (level == 1) return accept(lower);
      const std::uint32_t below = childNode(at, node, mask, child);
      const OccupiedBox& box = boxes_.occupied[static_cast<std::size_t>(level - 1)][below];
      if (squaredTo(boxes_, box, p_) < below_) descend(level - 1, below, lower);
    });
  }

  void accept(const VoxelIndex& v) noexcept {
    const VoxelIndex& old = lowest_.voxel;
    const bool lower = !lowest_.found || std::pair(v[2], std::pair(v[1], v[0])) <
                                             std::pair(old[2], std::pair(old[1], old[0]));
    if (lower) lowest_.voxel = v;
    lowest_.found = true;
  }

  const VoxelTree::Data& tree_;
  const OccupiedBoxes& boxes_;
  Vec3 p_;
  double below_;  // squared
  NearestBox lowest_;
};

}  // namespace

template <int Bits>
NearestBox findNearestBox(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& p,
                          double below, const VoxelIndex* seed, const NearEnough& enough) noexcept {
  return NearestDescent<Bits>(tree, boxes, p, below, enough).run(seed);
}

template <int Bits>
NearestBox findLowestBoxAt(const VoxelTree::Data& tree, const OccupiedBoxes& boxes, const Vec3& p,
                           double squared) noexcept {
  return LowestDescent<Bits>(tree, boxes, p, squared).run();
}

template NearestBox findNearestBox<1>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                      double, const VoxelIndex*, const NearEnough&) noexcept;
template NearestBox findNearestBox<2>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                      double, const VoxelIndex*, const NearEnough&) noexcept;
template NearestBox findNearestBox<3>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                      double, const VoxelIndex*, const NearEnough&) noexcept;
template NearestBox findLowestBoxAt<1>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                       double) noexcept;
template NearestBox findLowestBoxAt<2>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                       double) noexcept;
template NearestBox findLowestBoxAt<3>(const VoxelTree::Data&, const OccupiedBoxes&, const Vec3&,
                                       double) noexcept;

}  // namespace palpate
