#pragma once
/// How far a point is from the boxes of a voxel tree, and which children of a node are closer than
/// a bound. For the clearance; internal.
///
/// All of its squared distances to boxes are computed here, with the same operations in the same
/// order: a max, a square, and (x + y) + z. All of them round monotonically, so that no voxel is
/// found nearer than the node that holds it: pruning needs no allowance. Whoever adds another way
/// to compute one (a fused multiply-add, another order) breaks that.
///
/// Frame V (voxel axes of the tree's grid); metres, square metres. Pure functions for any thread,
/// in the header because a search consists of them; templates say `inline` too, without which the
/// compiler calls some of them and a query takes a twentieth longer.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/collision/occupied_boxes.h"

namespace palpate {

/// A point or a direction, V.
struct Vec3 {
  double v[3];
};

/// The next number above; of a finite one that is not negative. Never a subnormal one, which a
/// thread may have set to count as 0; no squared distance but 0 is as small.
[[nodiscard]] inline double justAbove(double value) noexcept {
  const double next = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) + 1);
  return std::max(next, std::numeric_limits<double>::min());
}

[[nodiscard]] inline double axisSquared(double p, double lower, double upper) noexcept {
  const double d = std::max(0.0, std::max(lower - p, p - upper));
  return d * d;
}

[[nodiscard]] inline double squaredTo(const OccupiedBoxes& boxes, const OccupiedBox& box,
                                      const Vec3& p) noexcept {
  double d2[3];
  for (std::size_t a = 0; a < 3; ++a) {
    d2[a] = axisSquared(p.v[a], boxes.face[a][box.lo[a]], boxes.face[a][box.hi[a]]);
  }
  return (d2[0] + d2[1]) + d2[2];
}

/// The point of a voxel's box that is nearest to p; p itself if inside.
[[nodiscard]] inline Vec3 nearestPointOf(const OccupiedBoxes& boxes, const VoxelIndex& voxel,
                                         const Vec3& p) noexcept {
  Vec3 nearest{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(voxel[a]);
    nearest.v[a] = std::clamp(p.v[a], boxes.face[a][i], boxes.face[a][i + 1]);
  }
  return nearest;
}

/// Along each axis, to the slabs in which a node's children lie.
template <int Bits>
struct SlabDistances {
  double d2[3][NodeMask<Bits>::kEdge];
};

/// @param corner  of the node
/// @param shift   its children are 2^shift voxels along an edge
template <int Bits>
[[nodiscard]] inline SlabDistances<Bits> slabDistances(const OccupiedBoxes& boxes, const Vec3& p,
                                                       const VoxelIndex& corner,
                                                       int shift) noexcept {
  SlabDistances<Bits> out;
  for (std::size_t a = 0; a < 3; ++a) {
    const double* face = boxes.face[a].data() + corner[a];
    for (int i = 0; i < NodeMask<Bits>::kEdge; ++i) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(i) << shift;
      const std::ptrdiff_t next = static_cast<std::ptrdiff_t>(i + 1) << shift;
      out.d2[a][i] = axisSquared(p.v[a], face[at], face[next]);
    }
  }
  return out;
}

/// Calls f(child, squared distance) for every present child whose whole box, occupied or not, is
/// closer than `below` (squared). Read again for every child: f may lower it.
template <int Bits, class F>
inline void forEachCloser(const NodeMask<Bits>& mask, const SlabDistances<Bits>& slab,
                          const double& below, F&& f) noexcept {
  using Mask = NodeMask<Bits>;
  constexpr std::uint64_t kRow = (std::uint64_t{1} << Mask::kEdge) - 1;
  for (int z = 0; z < Mask::kEdge; ++z) {
    if (!(slab.d2[2][z] < below)) continue;
    for (int y = 0; y < Mask::kEdge; ++y) {
      const int first = Mask::child(0, y, z);
      std::uint64_t row = (mask.word[static_cast<std::size_t>(first) >> 6] >> (first & 63)) & kRow;
      if (row == 0 || !(slab.d2[1][y] + slab.d2[2][z] < below)) continue;
      for (; row != 0; row &= row - 1) {
        const int x = std::countr_zero(row);
        const double d2 = (slab.d2[0][x] + slab.d2[1][y]) + slab.d2[2][z];
        if (d2 < below) f(first + x, d2);
      }
    }
  }
}

}  // namespace palpate
