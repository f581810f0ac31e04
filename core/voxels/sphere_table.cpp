#include "core/voxels/sphere_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "core/voxels/enclosing_ball.h"

namespace palpate {
namespace {

// Corners of the occupied octants of a node of two cells a side, relative to its centre.
std::vector<Eigen::Vector3d> octantCorners(unsigned pattern, const Eigen::Vector3d& cell) {
  std::array<bool, 27> used{};
  for (unsigned octant = 0; octant < 8; ++octant) {
    if (((pattern >> octant) & 1U) == 0) continue;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const unsigned x = (octant & 1U) + (corner & 1U);
      const unsigned y = ((octant >> 1U) & 1U) + ((corner >> 1U) & 1U);
      const unsigned z = ((octant >> 2U) & 1U) + ((corner >> 2U) & 1U);
      used[x + 3 * y + 9 * z] = true;
    }
  }
  std::vector<Eigen::Vector3d> corners;
  for (int i = 0; i < 27; ++i) {
    if (!used[static_cast<std::size_t>(i)]) continue;
    corners.emplace_back((i % 3 - 1) * cell.x(), (i / 3 % 3 - 1) * cell.y(),
                         (i / 9 - 1) * cell.z());
  }
  return corners;
}

// The extreme corners of the occupied children, from the node's centre, with children of one cell:
// what the smallest enclosing sphere depends on. Of every row of corners along x only the two ends
// can be extreme, and of those none that lies between corners of both neighbours along y, or along
// z.
template <int Bits>
class ExtremeCorners {
 public:
  static constexpr int kSide = NodeMask<Bits>::kEdge + 1;

  explicit ExtremeCorners(const NodeMask<Bits>& mask, const Eigen::Vector3d& cell) noexcept {
    fillRows(mask);
    for (int z = 0; z < kSide; ++z) {
      for (int y = 0; y < kSide; ++y) {
        const unsigned row = rowAt(y, z);
        if (row == 0) continue;
        const int lo = std::countr_zero(row);
        const int hi = std::bit_width(row) - 1;
        keep(lo, y, z, cell);
        if (hi != lo) keep(hi, y, z, cell);
      }
    }
  }
  [[nodiscard]] std::span<const Eigen::Vector3d> points() const noexcept {
    return {point_.data(), count_};
  }

 private:
  // Rows of corners: a child's row sets its corners in the four rows of corners around it.
  void fillRows(const NodeMask<Bits>& mask) noexcept {
    constexpr int kEdge = NodeMask<Bits>::kEdge;
    for (int z = 0; z < kEdge; ++z) {
      for (int y = 0; y < kEdge; ++y) {
        const int at = NodeMask<Bits>::child(0, y, z);
        const auto children = static_cast<unsigned>(
            (mask.word[static_cast<std::size_t>(at) >> 6] >> (at & 63)) & ((1U << kEdge) - 1U));
        const unsigned corners = children | (children << 1U);
        for (const int dz : {0, 1}) {
          for (const int dy : {0, 1}) {
            row_[static_cast<std::size_t>((z + dz) * kSide + y + dy)] |= corners;
          }
        }
      }
    }
  }
  [[nodiscard]] unsigned rowAt(int y, int z) const noexcept {
    if (y < 0 || z < 0 || y >= kSide || z >= kSide) return 0;
    return row_[static_cast<std::size_t>(z * kSide + y)];
  }
  // Does the row reach from x or before to x or beyond?
  [[nodiscard]] static bool spans(unsigned row, int x) noexcept {
    return (row >> static_cast<unsigned>(x)) != 0 &&
           (row & ((2U << static_cast<unsigned>(x)) - 1U)) != 0;
  }
  void keep(int x, int y, int z, const Eigen::Vector3d& cell) noexcept {
    if (spans(rowAt(y - 1, z), x) && spans(rowAt(y + 1, z), x)) return;
    if (spans(rowAt(y, z - 1), x) && spans(rowAt(y, z + 1), x)) return;
    constexpr double kHalf = 0.5 * NodeMask<Bits>::kEdge;
    point_[count_++] = {(x - kHalf) * cell.x(), (y - kHalf) * cell.y(), (z - kHalf) * cell.z()};
  }

  std::array<unsigned, static_cast<std::size_t>(kSide) * kSide> row_{};
  std::array<Eigen::Vector3d, static_cast<std::size_t>(kSide) * kSide * 2> point_;
  std::size_t count_ = 0;
};

NodeSphere sideSphere(const std::vector<Eigen::Vector3d>& corners) {
  Eigen::Vector3d lo = corners.front();
  Eigen::Vector3d hi = corners.front();
  for (const auto& p : corners) {
    lo = lo.cwiseMin(p);
    hi = hi.cwiseMax(p);
  }
  NodeSphere sphere;
  sphere.offset = 0.5 * (lo + hi);
  for (const auto& p : corners) {
    sphere.radius = std::max(sphere.radius, (p - sphere.offset).norm());
  }
  return sphere;
}

}  // namespace

SphereTable::SphereTable(int bits, const Eigen::Vector3d& cell) : cell_(cell) {
  for (unsigned pattern = 1; pattern < 256; ++pattern) {
    const auto corners = octantCorners(pattern, cell);
    const Ball ball = smallestEnclosingBall(corners);
    tight_[pattern] = {ball.centre, ball.radius};
    side_[pattern] = sideSphere(corners);
  }
  for (std::size_t level = 0; level < fullRadius_.size(); ++level) {
    fullRadius_[level] = 0.5 * std::ldexp(cell.norm(), static_cast<int>(level) * bits);
  }
}

template <int Bits>
SphereTable::Box SphereTable::occupied(const NodeMask<Bits>& mask) noexcept {
  constexpr int kEdge = NodeMask<Bits>::kEdge;
  // Occupied columns of one slab, slab by slab: bit x + kEdge·y.
  constexpr int kSlab = kEdge * kEdge;
  constexpr std::uint64_t kSlabMask =
      kSlab == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << kSlab) - 1;
  unsigned xs = 0;
  unsigned ys = 0;
  unsigned zs = 0;
  for (int z = 0; z < kEdge; ++z) {
    const std::uint64_t slab =
        (mask.word[static_cast<std::size_t>(z * kSlab) >> 6] >> ((z * kSlab) & 63)) & kSlabMask;
    if (slab == 0) continue;
    zs |= 1U << z;
    for (int y = 0; y < kEdge; ++y) {
      const auto row = static_cast<unsigned>((slab >> (y * kEdge)) & ((1U << kEdge) - 1U));
      if (row == 0) continue;
      ys |= 1U << y;
      xs |= row;
    }
  }
  const auto span = [](unsigned bits, int& lo, int& hi) {
    lo = std::countr_zero(bits);
    hi = std::bit_width(bits) - 1;
  };
  Box box;
  span(xs, box.lo[0], box.hi[0]);
  span(ys, box.lo[1], box.hi[1]);
  span(zs, box.lo[2], box.hi[2]);
  return box;
}

template <int Bits>
NodeSphere SphereTable::sphere(const NodeMask<Bits>& mask, int level,
                               SphereKind kind) const noexcept {
  if (kind == SphereKind::Full) return {Eigen::Vector3d::Zero(), fullRadius(level)};
  constexpr int kEdge = NodeMask<Bits>::kEdge;
  const double child = std::ldexp(1.0, (level - 1) * Bits);  // edge of a child in leaf cells
  if constexpr (Bits == 1) {
    const auto pattern = static_cast<std::uint8_t>(mask.word[0]);
    const NodeSphere& entry = kind == SphereKind::Tight ? tight_[pattern] : side_[pattern];
    return {entry.offset * child, entry.radius * child};
  } else {
    if (kind == SphereKind::Tight) {
      const Ball ball = smallestEnclosingBall(ExtremeCorners<Bits>(mask, cell_).points());
      return {ball.centre * child, ball.radius * child};
    }
    const Box box = occupied(mask);
    NodeSphere ofBox;
    double squared = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double half = 0.5 * child * cell_[axis];
      ofBox.offset[axis] = half * (box.lo[a] + box.hi[a] + 1 - kEdge);
      const double extent = half * (box.hi[a] - box.lo[a] + 1);
      squared += extent * extent;
    }
    ofBox.radius = std::sqrt(squared);
    return ofBox;
  }
}

template NodeSphere SphereTable::sphere<1>(const NodeMask<1>&, int, SphereKind) const noexcept;
template NodeSphere SphereTable::sphere<2>(const NodeMask<2>&, int, SphereKind) const noexcept;
template NodeSphere SphereTable::sphere<3>(const NodeMask<3>&, int, SphereKind) const noexcept;

}  // namespace palpate
