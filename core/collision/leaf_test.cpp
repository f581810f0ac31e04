#include "core/collision/leaf_test.h"

#include <algorithm>

namespace palpate {
namespace {

void setPoint(const double p[3], Contact& c) noexcept {
  for (int a = 0; a < 3; ++a) c.p[a] = p[a];
}

}  // namespace

template <int Bits>
bool LeafTest<Bits>::locate(const double p[3], Item& item) const noexcept {
  const bool cells = tree_.options.leaf == LeafModel::Distance;
  for (std::size_t a = 0; a < 3; ++a) {
    const double u = p[a] / tree_.geometry.spacing[static_cast<Eigen::Index>(a)];
    const double extent = tree_.extent[a];
    if (cells) {
      // The box of centres is closed: its far faces belong to the last cells.
      if (!(u >= 0.0 && u <= extent)) return false;
      item[a] = std::min(static_cast<std::int32_t>(u), tree_.extent[a] - 1);
    } else {
      const double voxel = u + 0.5;
      if (!(voxel >= 0.0 && voxel < extent)) return false;
      item[a] = static_cast<std::int32_t>(voxel);
    }
  }
  return true;
}

template <int Bits>
std::uint32_t LeafTest<Bits>::nodeOf(const Item& item) noexcept {
  const int shift = Bits * nodeLevel_;
  const Item key{item[0] >> shift, item[1] >> shift, item[2] >> shift};
  if (key != key_) {
    key_ = key;
    node_ = findNode<Bits>(tree_, item, nodeLevel_);
  }
  return node_;
}

template <int Bits>
bool LeafTest<Bits>::evaluate(const double p[3], Contact& contact) noexcept {
  Item item;
  if (!locate(p, item)) return false;
  return tree_.options.leaf == LeafModel::Distance ? evaluateDistance(p, item, contact)
                                                   : evaluateVoxel(p, item, contact);
}

template <int Bits>
bool LeafTest<Bits>::evaluateVoxel(const double p[3], const Item& item, Contact& c) noexcept {
  using Mask = NodeMask<Bits>;
  const std::uint32_t node = nodeOf(item);
  if (node == kNoNode) return false;
  const Mask mask = Mask::load(tree_.level[1].masks.data(), node);
  const int child = Mask::child(item[0] & Mask::kLow, item[1] & Mask::kLow, item[2] & Mask::kLow);
  if (!mask.test(child)) return false;
  planeOfVoxel(p, item,
               tree_.level[1].firstChild[node] + static_cast<std::uint32_t>(mask.rank(child)), c);
  return true;
}

template <int Bits>
void LeafTest<Bits>::planeOfVoxel(const double p[3], const Item& item, std::uint32_t leaf,
                                  Contact& c) const noexcept {
  const Eigen::Vector3d n = decodeNormal(tree_.leafNormal[leaf]);
  double depth = static_cast<double>(tree_.leafDepth[leaf]);
  for (int a = 0; a < 3; ++a) {
    const double centre = item[static_cast<std::size_t>(a)] * tree_.geometry.spacing[a];
    depth += n[a] * (centre - p[a]);
    c.n[a] = n[a];
  }
  setPoint(p, c);
  c.depth = std::max(0.0, depth);
  c.label = tree_.leafLabel[leaf];
  c.flags = 0;
}

template <int Bits>
bool LeafTest<Bits>::evaluateDistance(const double p[3], const Item& item, Contact& c) noexcept {
  const std::uint32_t brick = nodeOf(item);
  if (brick == kNoNode) return false;
  // A brick holds values for all its cells; only in a surface-only tree can one that is absent be
  // inside.
  if (tree_.options.surfaceOnly) {
    using Mask = NodeMask<Bits>;
    const std::uint32_t node = findNode<Bits>(tree_, item, 1);
    if (node == kNoNode) return false;
    const int child = Mask::child(item[0] & Mask::kLow, item[1] & Mask::kLow, item[2] & Mask::kLow);
    if (!Mask::load(tree_.level[1].masks.data(), node).test(child)) return false;
  }
  double gradient[3];
  std::uint8_t label = 0;
  const double value = interpolate(p, item, brick, gradient, label);
  if (!(value < 0.0)) return false;
  fillDistance(p, value, gradient, label, c);
  return true;
}

template <int Bits>
double LeafTest<Bits>::interpolate(const double p[3], const Item& cell, std::uint32_t brick,
                                   double gradient[3], std::uint8_t& label) const noexcept {
  const int low = tree_.brickEdge - 1;
  const auto side = static_cast<std::size_t>(tree_.brickEdge) + 1;
  double f[3];
  double g[3];
  for (std::size_t a = 0; a < 3; ++a) {
    const double u = p[a] / tree_.geometry.spacing[static_cast<Eigen::Index>(a)];
    f[a] = std::clamp(u - cell[a], 0.0, 1.0);
    g[a] = 1.0 - f[a];
  }
  const std::size_t corner =
      brick * tree_.brickSize() +
      (static_cast<std::size_t>(cell[2] & low) * side + static_cast<std::size_t>(cell[1] & low)) *
          side +
      static_cast<std::size_t>(cell[0] & low);
  const std::size_t at[8] = {corner,
                             corner + 1,
                             corner + side,
                             corner + side + 1,
                             corner + side * side,
                             corner + side * side + 1,
                             corner + side * side + side,
                             corner + side * side + side + 1};
  double v[8];
  for (int i = 0; i < 8; ++i) v[i] = static_cast<double>(tree_.brick[at[i]]);
  // Along x, then y, then z; the differences on the way are the gradient.
  const double x00 = v[0] * g[0] + v[1] * f[0];
  const double x10 = v[2] * g[0] + v[3] * f[0];
  const double x01 = v[4] * g[0] + v[5] * f[0];
  const double x11 = v[6] * g[0] + v[7] * f[0];
  const double y0 = x00 * g[1] + x10 * f[1];
  const double y1 = x01 * g[1] + x11 * f[1];
  const double value = y0 * g[2] + y1 * f[2];
  const double dx = ((v[1] - v[0]) * g[1] + (v[3] - v[2]) * f[1]) * g[2] +
                    ((v[5] - v[4]) * g[1] + (v[7] - v[6]) * f[1]) * f[2];
  const double dy = (x10 - x00) * g[2] + (x11 - x01) * f[2];
  gradient[0] = dx / tree_.geometry.spacing.x();
  gradient[1] = dy / tree_.geometry.spacing.y();
  gradient[2] = (y1 - y0) / tree_.geometry.spacing.z();

  label = tree_.uniformLabel;
  if (label == 0) {  // of the inside corner nearest in weight; ties to the lower address
    double best = -1.0;
    for (int i = 0; i < 8; ++i) {
      const double weight = ((i & 1) != 0 ? f[0] : g[0]) * ((i & 2) != 0 ? f[1] : g[1]) *
                            ((i & 4) != 0 ? f[2] : g[2]);
      if (tree_.brickLabel[at[i]] != 0 && weight > best) {
        best = weight;
        label = tree_.brickLabel[at[i]];
      }
    }
  }
  return value;
}

template <int Bits>
void LeafTest<Bits>::fillDistance(const double p[3], double value, const double gradient[3],
                                  std::uint8_t label, Contact& c) const noexcept {
  setPoint(p, c);
  const double length =
      std::sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
  // A distance changes by its own length per length; a gradient this small is a balance of sides
  // (the very middle of a sheet) and has no direction to normalise.
  constexpr double kNoDirection = 1e-9;
  for (int a = 0; a < 3; ++a) {
    c.n[a] = length > kNoDirection ? gradient[a] / length : (a == 2 ? 1.0 : 0.0);
  }
  const double limit = kSaturationVoxels * tree_.geometry.spacing.minCoeff();
  c.flags = 0;
  if (-value > limit) c.flags |= kContactSaturated;
  c.depth = std::clamp(-value, 0.0, limit);
  c.label = label;
}

template <int Bits>
void LeafTest<Bits>::evaluateCut(const double p[3], const Item& item, std::uint32_t node, int level,
                                 Contact& contact) const noexcept {
  using Mask = NodeMask<Bits>;
  Item lower;  // lowest item of the node
  for (std::size_t a = 0; a < 3; ++a) lower[a] = (item[a] >> (Bits * level)) << (Bits * level);
  std::uint32_t brick = level == nodeLevel_ ? node : kNoNode;
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
        const double d = tree_.origin[axis] + (at0[a] + half) * tree_.geometry.spacing[axis] - p[a];
        d2 += d * d;
      }
      if (d2 < best) {
        best = d2;
        nearest = child;
        bestLower = at0;
      }
    });
    lower = bestLower;
    if (l > 1 || !at.firstChild.empty()) {
      node = at.firstChild[node] + static_cast<std::uint32_t>(mask.rank(nearest));
    }
    if (l - 1 == nodeLevel_) brick = node;
  }
  if (tree_.options.leaf == LeafModel::Voxel) {
    planeOfVoxel(p, lower, node, contact);
  } else {
    if (brick == kNoNode) brick = findNode<Bits>(tree_, lower, nodeLevel_);
    double gradient[3];
    std::uint8_t label = 0;
    double value = interpolate(p, lower, brick, gradient, label);
    for (std::size_t a = 0; a < 3; ++a) {  // from the cell's nearest point on to p
      const double s = tree_.geometry.spacing[static_cast<Eigen::Index>(a)];
      value += gradient[a] * (p[a] - std::clamp(p[a], lower[a] * s, (lower[a] + 1) * s));
    }
    fillDistance(p, value, gradient, label, contact);
  }
  contact.flags |= kContactApproximate;
}

template class LeafTest<1>;
template class LeafTest<2>;
template class LeafTest<3>;

}  // namespace palpate
