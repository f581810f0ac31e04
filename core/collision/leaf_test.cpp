#include "core/collision/leaf_test.h"

#include <algorithm>
#include <cstring>

#include "core/collision/fast_query.h"
#include "core/voxels/leaf_codes.h"
#include "core/voxels/outward_normal.h"

namespace palpate {
namespace {

float mix(float a, float b, float t) noexcept {
  return a + (b - a) * t;
}

}  // namespace

template <int Bits>
LeafTest<Bits>::LeafTest(const VoxelTree::Data& tree, VoxelMemo& memo) noexcept
    : tree_(tree),
      memo_(memo),
      unit_(tree.geometry.spacing.minCoeff()),
      metresPerStep_(metresPerStepOf(tree.depth.palette, unit_)) {
  memo.follow(tree.edits);
  for (std::size_t a = 0; a < 3; ++a) edge_[a] = std::sqrt(tree.depth.palette.weight()[a]);
}

template <int Bits>
bool LeafTest<Bits>::locate(const PlacedPoint& point, Item& item) const noexcept {
  const bool cells = tree_.options.leaf == LeafModel::Distance;
  for (std::size_t a = 0; a < 3; ++a) {
    if (cells) {
      // The box of centres is closed: its far faces belong to the last cells.
      const auto extent = static_cast<float>(tree_.extent[a]);
      if (!(point.u[a] >= 0.0f && point.u[a] <= extent)) return false;
      item[a] = std::min(static_cast<std::int32_t>(point.u[a]), tree_.extent[a] - 1);
    } else {
      const double voxel = point.p[a] / tree_.geometry.spacing[static_cast<Eigen::Index>(a)] + 0.5;
      if (!(voxel >= 0.0 && voxel < tree_.extent[a])) return false;
      item[a] = static_cast<std::int32_t>(voxel);
    }
  }
  return true;
}

template <int Bits>
const typename LeafTest<Bits>::Known& LeafTest<Bits>::nodeOf(const Item& item) noexcept {
  const Item address{item[0] >> Bits, item[1] >> Bits, item[2] >> Bits};
  const auto parity =
      static_cast<std::size_t>((address[0] & 1) | (address[1] & 1) << 1 | (address[2] & 1) << 2);
  Known& known = known_[parity];
  if (address != known.address) {
    known.address = address;
    known.node = findNode<Bits>(tree_, item, 1);
    const TreeLevel& level = tree_.level[1];
    const bool found = known.node != kNoNode;
    known.mask = found ? NodeMask<Bits>::load(level.masks.data(), known.node) : NodeMask<Bits>{};
    known.link = found && !level.firstChild.empty() ? level.firstChild[known.node] : 0;
  }
  return known;
}

template <int Bits>
bool LeafTest<Bits>::evaluate(const PlacedPoint& point, Contact& contact) noexcept {
  Item item;
  if (!locate(point, item)) return false;
  return tree_.options.leaf == LeafModel::Distance ? evaluateDistance(point, item, contact)
                                                   : evaluateVoxel(point, item, contact);
}

// ---- voxel leaves ----

// Code and label of a voxel of the tree; false where it is empty.
template <int Bits>
bool LeafTest<Bits>::codeOf(const Item& voxel, std::uint16_t& code, std::uint8_t& label) noexcept {
  using Mask = NodeMask<Bits>;
  const Known& node = nodeOf(voxel);
  const int child =
      Mask::child(voxel[0] & Mask::kLow, voxel[1] & Mask::kLow, voxel[2] & Mask::kLow);
  if (!node.mask.test(child)) return false;
  const int rank = node.mask.rank(child);
  code = leafCode(tree_.leafBytes, node.link, rank);
  label = tree_.depth.uniformLabel;
  if (label == 0) label = leafLabel(tree_.leafBytes, node.link, node.mask.count(), rank);
  return true;
}

template <int Bits>
bool LeafTest<Bits>::evaluateVoxel(const PlacedPoint& point, const Item& item,
                                   Contact& c) noexcept {
  std::uint16_t code = 0;
  std::uint8_t label = 0;
  if (!codeOf(item, code, label)) return false;
  planeOfVoxel(point, item, code, label, c);
  return true;
}

// Signed depths, smallest spacings, of `count` voxels of a row; those of one node are neighbours in
// rank, so one look at its mask and its codes serves them all.
template <int Bits>
void LeafTest<Bits>::depthsAlong(const Item& first, int count, double* depth) noexcept {
  using Mask = NodeMask<Bits>;
  Item at = first;
  while (count > 0) {
    const Known& node = nodeOf(at);
    const int run = std::min(count, Mask::kEdge - (at[0] & Mask::kLow));
    const int child = Mask::child(at[0] & Mask::kLow, at[1] & Mask::kLow, at[2] & Mask::kLow);
    const std::uint64_t present =
        node.mask.word[static_cast<std::size_t>(child) >> 6] >> (child & 63);
    const bool wide = (node.link & kWideLeaves) != 0;
    const unsigned width = wide ? 12 : 6;
    const std::size_t bit = static_cast<std::size_t>(node.mask.rank(child)) * width;
    std::uint64_t codes = 0;  // three of twelve bits, and seven before them, fit
    if (node.node != kNoNode) {
      std::memcpy(&codes, tree_.leafBytes.data() + (node.link & ~kWideLeaves) + bit / 8,
                  sizeof codes);
    }
    codes >>= bit % 8;
    for (int i = 0; i < run; ++i) {
      if ((present >> i & 1U) == 0) {
        *depth++ = kEmptyValue;
        continue;
      }
      const auto code = static_cast<std::uint16_t>(codes & (wide ? 4095U : 63U));
      codes >>= width;
      *depth++ = static_cast<double>(tree_.depth.palette.value(code));
    }
    at[0] += run;
    count -= run;
  }
}

// As neighbourhoodOf, row by row.
template <int Bits>
Neighbourhood LeafTest<Bits>::depthsAround(const Item& voxel) noexcept {
  Neighbourhood around;
  for (std::size_t a = 0; a < 3; ++a) {
    around.below[a] = voxel[a] > 0;
    around.above[a] = voxel[a] + 1 < tree_.extent[a];
  }
  const int before = around.below[0] ? 1 : 0;
  const int behind = around.above[0] ? 1 : 0;
  double* row = around.value.data();
  for (std::int32_t z = -1; z <= 1; ++z) {
    for (std::int32_t y = -1; y <= 1; ++y, row += 3) {
      const Item first{voxel[0] - before, std::clamp(voxel[1] + y, 0, tree_.extent[1] - 1),
                       std::clamp(voxel[2] + z, 0, tree_.extent[2] - 1)};
      depthsAlong(first, before + 1 + behind, row + 1 - before);
      if (before == 0) row[0] = row[1];
      if (behind == 0) row[2] = row[1];
    }
  }
  return around;
}

// The normal from the depths around, or as a surface-only tree stores it.
template <int Bits>
void LeafTest<Bits>::remember(const Item& item, std::uint16_t code,
                              VoxelMemo::Entry& entry) noexcept {
  const DepthPalette& palette = tree_.depth.palette;
  Eigen::Vector3d normal;
  if (tree_.options.surfaceOnly) {
    using Mask = NodeMask<Bits>;
    const Known& node = nodeOf(item);
    const int child = Mask::child(item[0] & Mask::kLow, item[1] & Mask::kLow, item[2] & Mask::kLow);
    normal = decodeNormal(leafNormal(tree_.leafBytes, node.link, node.mask.count(),
                                     node.mask.rank(child), tree_.depth.uniformLabel == 0));
  } else {
    normal = outwardNormal(depthsAround(item), tree_.geometry.spacing);
  }
  for (int a = 0; a < 3; ++a) entry.n[a] = normal[a];
  entry.depth = -static_cast<double>(palette.value(code)) * unit_;
}

template <int Bits>
void LeafTest<Bits>::planeOfVoxel(const PlacedPoint& point, const Item& item, std::uint16_t code,
                                  std::uint8_t label, Contact& c) noexcept {
  const auto nx = static_cast<std::uint64_t>(tree_.extent[0]);
  const auto ny = static_cast<std::uint64_t>(tree_.extent[1]);
  const std::uint64_t voxel =
      (static_cast<std::uint64_t>(item[2]) * ny + static_cast<std::uint64_t>(item[1])) * nx +
      static_cast<std::uint64_t>(item[0]);
  VoxelMemo::Entry& entry = memo_.at(voxel);
  if (entry.voxel != voxel) {
    remember(item, code, entry);
    entry.voxel = voxel;
  }
  double depth = entry.depth;
  for (int a = 0; a < 3; ++a) {
    const double centre = item[static_cast<std::size_t>(a)] * tree_.geometry.spacing[a];
    depth += entry.n[a] * (centre - point.p[a]);
    c.n[a] = entry.n[a];
    c.p[a] = point.p[a];
  }
  c.label = label;
  c.flags = 0;
  if (code >= tree_.depth.palette.deepestCode()) c.flags |= kContactSaturated;
  c.depth = std::max(0.0, depth);
}

// ---- distance leaves: the operations of point_pass-inl.h ----

template <int Bits>
bool LeafTest<Bits>::evaluateDistance(const PlacedPoint& point, const Item& item,
                                      Contact& c) noexcept {
  // A brick holds values for all its cells; only in a surface-only tree can one that is absent be
  // inside.
  if (tree_.options.surfaceOnly) {
    using Mask = NodeMask<Bits>;
    const int child = Mask::child(item[0] & Mask::kLow, item[1] & Mask::kLow, item[2] & Mask::kLow);
    if (!nodeOf(item).mask.test(child)) return false;
  }
  float f[3];
  for (std::size_t a = 0; a < 3; ++a) f[a] = point.u[a] - static_cast<float>(item[a]);
  const DistanceSample s = interpolate(item, f);
  if (!(s.value < 0.0f)) return false;
  const float x = s.gradient[0] * (1.0f / edge_[0]);
  const float y = s.gradient[1] * (1.0f / edge_[1]);
  const float z = s.gradient[2] * (1.0f / edge_[2]);
  const float length2 = x * x + y * y + z * z;
  const bool some = length2 > 1.0f;
  const float scale = 1.0f / std::sqrt(some ? length2 : 1.0f);
  const float normal[3] = {some ? x * scale : 0.0f, some ? y * scale : 0.0f,
                           some ? z * scale : 1.0f};
  fillDistance(point, s.value * -metresPerStep_, normal, c);
  return true;
}

template <int Bits>
DistanceSample LeafTest<Bits>::interpolate(const Item& cell, const float f[3]) const noexcept {
  const std::uint32_t link = tree_.depth.linkAt(cell);
  const int at[3] = {cell[0] & 3, cell[1] & 3, cell[2] & 3};
  const auto q = static_cast<std::int32_t>(f[0] * static_cast<float>(kFractionOne) + 0.5f);
  float row[4];
  float dx[4];
  for (int k = 0; k < 4; ++k) {
    const int y = at[1] + (k & 1);
    const int z = at[2] + (k >> 1);
    const std::int32_t s0 = tree_.depth.palette.steps(tree_.depth.codeAt(link, at[0], y, z));
    const std::int32_t s1 = tree_.depth.palette.steps(tree_.depth.codeAt(link, at[0] + 1, y, z));
    row[k] = static_cast<float>(s0 * (kFractionOne - q) + s1 * q);
    dx[k] = static_cast<float>(s1 - s0);
  }
  const float lower = mix(row[0], row[1], f[1]);
  const float upper = mix(row[2], row[3], f[1]);
  DistanceSample s;
  s.value = mix(lower, upper, f[2]);
  s.gradient[0] = mix(mix(dx[0], dx[1], f[1]), mix(dx[2], dx[3], f[1]), f[2]) *
                  static_cast<float>(kFractionOne);
  s.gradient[1] = mix(row[1] - row[0], row[3] - row[2], f[2]);
  s.gradient[2] = upper - lower;
  return s;
}

// Of the inside corner nearest in weight; ties to the lower address.
template <int Bits>
std::uint8_t LeafTest<Bits>::labelAt(const PlacedPoint& point) const noexcept {
  if (tree_.depth.uniformLabel != 0) return tree_.depth.uniformLabel;
  Item cell;
  if (!locate(point, cell)) return 0;
  const std::size_t word = tree_.depth.wordAt(cell);
  if ((tree_.depth.words[word] & ClearanceWord::kLink) == 0) return 0;
  float f[3];
  for (std::size_t a = 0; a < 3; ++a) f[a] = point.u[a] - static_cast<float>(cell[a]);
  std::uint8_t label = 0;
  float best = -1.0f;
  for (int i = 0; i < 8; ++i) {
    float weight = 1.0f;
    for (int a = 0; a < 3; ++a) weight *= (i >> a & 1) != 0 ? f[a] : 1.0f - f[a];
    const std::uint8_t here = tree_.depth.labelOf(
        word, (cell[0] & 3) + (i & 1), (cell[1] & 3) + (i >> 1 & 1), (cell[2] & 3) + (i >> 2));
    if (here != 0 && weight > best) {
      best = weight;
      label = here;
    }
  }
  return label;
}

template <int Bits>
void LeafTest<Bits>::fillDistance(const PlacedPoint& point, float depth, const float normal[3],
                                  Contact& c) const noexcept {
  const Eigen::Vector3d n = Eigen::Vector3d(normal[0], normal[1], normal[2]).normalized();
  for (int a = 0; a < 3; ++a) {
    c.p[a] = point.p[a];
    c.n[a] = n[a];
  }
  const double limit = kSaturationVoxels * unit_;
  const bool saturated = depth >= static_cast<float>(limit);
  c.flags = 0;
  if (saturated) c.flags |= kContactSaturated;
  c.depth = saturated ? limit : std::max(0.0, static_cast<double>(depth));
  c.label = labelAt(point);
}

// ---- where descent was cut ----

template <int Bits>
void LeafTest<Bits>::evaluateCut(const PlacedPoint& point, const Item& item, std::uint32_t node,
                                 int level, Contact& contact) noexcept {
  using Mask = NodeMask<Bits>;
  Item lower;  // lowest item of the node
  for (std::size_t a = 0; a < 3; ++a) lower[a] = (item[a] >> (Bits * level)) << (Bits * level);
  for (int l = level; l >= 1; --l) {
    const TreeLevel& at = tree_.level[static_cast<std::size_t>(l)];
    const Mask mask = Mask::load(at.masks.data(), node);
    const int shift = Bits * (l - 1);
    const double half = 0.5 * std::ldexp(1.0, shift);
    int nearest = 0;
    double best = HUGE_VAL;
    Item bestLower = lower;
    forEachChild(mask, [&](int child) {
      const Item at0{lower[0] + ((child & Mask::kLow) << shift),
                     lower[1] + (((child >> Bits) & Mask::kLow) << shift),
                     lower[2] + ((child >> (2 * Bits)) << shift)};
      double d2 = 0.0;
      for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = static_cast<Eigen::Index>(a);
        const double d =
            tree_.origin[axis] + (at0[a] + half) * tree_.geometry.spacing[axis] - point.p[a];
        d2 += d * d;
      }
      if (d2 < best) {
        best = d2;
        nearest = child;
        bestLower = at0;
      }
    });
    lower = bestLower;
    if (l > 1) node = at.firstChild[node] + static_cast<std::uint32_t>(mask.rank(nearest));
  }
  if (tree_.options.leaf == LeafModel::Voxel) {
    std::uint16_t code = 0;
    std::uint8_t label = 0;
    (void)codeOf(lower, code, label);  // the nearest leaf is one of the tree's
    planeOfVoxel(point, lower, code, label, contact);
  } else {
    // From the cell's nearest point on to p along the gradient there.
    float f[3];
    float beyond[3];
    PlacedPoint near = point;
    for (std::size_t a = 0; a < 3; ++a) {
      const float from = point.u[a] - static_cast<float>(lower[a]);
      f[a] = std::clamp(from, 0.0f, 1.0f);
      beyond[a] = from - f[a];
      near.u[a] = static_cast<float>(lower[a]) + f[a];
    }
    const DistanceSample s = interpolate(lower, f);
    float value = s.value;
    Eigen::Vector3f slope;
    for (int a = 0; a < 3; ++a) {
      value += s.gradient[a] * beyond[a];
      slope[a] = s.gradient[a] / edge_[a];
    }
    const Eigen::Vector3f n =
        slope.squaredNorm() > 1.0f ? Eigen::Vector3f(slope.normalized()) : Eigen::Vector3f(0, 0, 1);
    fillDistance(near, std::max(0.0f, value * -metresPerStep_), n.data(), contact);
    for (int a = 0; a < 3; ++a) contact.p[a] = point.p[a];
  }
  contact.flags |= kContactApproximate;
}

template class LeafTest<1>;
template class LeafTest<2>;
template class LeafTest<3>;

}  // namespace palpate
