#include "core/dynamics/active_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr std::uint32_t kNone = 0xFFFFFFFF;
constexpr double kCheckFactor = 10.0;
// A set of an island of several bodies that is so small takes part whole.
constexpr std::size_t kSmallSet = 64;

Eigen::Vector3d vector(const double (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
}

bool isFinite(const Contact& c) noexcept {
  // One sum is not finite if any term is not (terms of opposite infinities give NaN).
  return std::isfinite(c.p[0] + c.p[1] + c.p[2] + c.n[0] + c.n[1] + c.n[2] + c.depth);
}

/// Largest eigenvalue of the symmetric 2x2 matrix [a b; b c].
double largestEigenvalue(double a, double b, double c) noexcept {
  return 0.5 * (a + c) + std::sqrt(0.25 * (a - c) * (a - c) + b * b);
}

/// Transpose of P = [1, -[r]x].
Matrix63d wrenchAt(const Eigen::Vector3d& r) noexcept {
  Matrix63d Pt;
  Pt.topRows<3>().setIdentity();
  Pt.bottomRows<3>() << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return Pt;
}

/// A contact shallower than the allowed depth may sink to it: a resting or sliding tool then stays
/// in contact, instead of hopping off and back.
double inwardOf(const Island& island, double depth) noexcept {
  return std::max(0.0, island.settings->allowedDepth - depth) / island.h;
}

/// False: no room.
bool add(Island& island, std::uint32_t set, std::uint32_t index) noexcept {
  if (island.count == island.active.size()) {
    island.effort.capReached = true;
    return false;
  }
  const ContactSet& of = island.sets[set];
  const Contact& c = of.contacts_W[index];
  ActiveContact& a = island.active[island.count++];
  a.body = of.body;
  a.other = of.other;
  a.r = vector(c.p) - (*island.bodies)[a.body].p_WC;
  if (a.other != kAnatomy) a.rOther = vector(c.p) - (*island.bodies)[a.other].p_WC;
  a.n = vector(c.n);
  a.depth = c.depth;
  a.inward = inwardOf(island, c.depth);
  const SurfaceMaterial& m = (*of.materials)[c.label];
  a.friction = island.settings->friction ? std::max(0.0, m.friction) : 0.0;
  a.restitution = std::clamp(m.restitution, 0.0, 1.0);
  a.normalImpulse = a.tangentImpulse2 = 0.0;
  a.set = set;
  a.index = index;
  a.prepared = a.bounced = a.settled = false;
  return true;
}

/// Deepest first; equal depths by place in the input, so that the order is the same on every run.
void sortActive(Island& island) noexcept {
  const auto end = island.order.begin() + static_cast<std::ptrdiff_t>(island.count);
  for (std::size_t i = 0; i < island.count; ++i) island.order[i] = static_cast<std::uint32_t>(i);
  std::sort(island.order.begin(), end, [&island](std::uint32_t x, std::uint32_t y) {
    const ActiveContact &a = island.active[x], &b = island.active[y];
    if (a.depth != b.depth) return a.depth > b.depth;
    return a.set != b.set ? a.set < b.set : a.index < b.index;
  });
}

void addAll(Island& island, std::uint32_t set) noexcept {
  const auto& contacts = island.sets[set].contacts_W;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    if (isFinite(contacts[i])) (void)add(island, set, i);
  }
}

}  // namespace

void Island::prepare(ActiveContact& a) const noexcept {
  const Matrix63d Pt = wrenchAt(a.r);
  a.toTwist.noalias() = (*bodies)[a.body].mobility * Pt;
  a.K.noalias() = Pt.transpose() * a.toTwist;
  if (a.other != kAnatomy) {
    const Matrix63d Qt = wrenchAt(a.rOther);
    a.toTwistOther.noalias() = (*bodies)[a.other].mobility * Qt;
    a.K.noalias() += Qt.transpose() * a.toTwistOther;
  }
  a.Kinverse = a.K.inverse();
  a.Kn = a.n.dot(a.K * a.n);
  const Eigen::Vector3d t1 = a.n.unitOrthogonal();
  const Eigen::Vector3d t2 = a.n.cross(t1);
  const Eigen::Vector3d Kt1 = a.K * t1;
  a.Ktangent = largestEigenvalue(t1.dot(Kt1), t2.dot(Kt1), t2.dot(a.K * t2));
  a.impulse.setZero();
  a.prepared = true;
}

ContactSelection::ContactSelection() = default;

std::size_t ContactSelection::bucketOf(const Contact& c) const noexcept {
  const double ax = std::abs(c.n[0]), ay = std::abs(c.n[1]), az = std::abs(c.n[2]);
  const std::size_t axis = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
  const std::size_t face = 2 * axis + (c.n[axis] < 0.0 ? 1 : 0);
  const std::size_t quarter =
      (c.n[(axis + 1) % 3] < 0.0 ? 1u : 0u) + (c.n[(axis + 2) % 3] < 0.0 ? 2u : 0u);
  const std::size_t place = (c.p[0] < middle_.x() ? 1u : 0u) + (c.p[1] < middle_.y() ? 2u : 0u) +
                            (c.p[2] < middle_.z() ? 4u : 0u);
  return (4 * face + quarter) * kPlaces + place;
}

void ContactSelection::findMiddle(std::span<const Contact> contacts) noexcept {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const Contact& c : contacts) {
    if (!isFinite(c)) continue;
    low = low.cwiseMin(vector(c.p));
    high = high.cwiseMax(vector(c.p));
  }
  middle_ = 0.5 * (low + high);
}

void ContactSelection::clearBuckets() noexcept {
  bucket_.fill(kNone);
}

void ContactSelection::addBuckets(Island& island, std::uint32_t set) noexcept {
  for (const std::uint32_t index : bucket_) {
    if (index != kNone) (void)add(island, set, index);
  }
}

void ContactSelection::gatherDeepestOf(Island& island, std::uint32_t set) noexcept {
  const auto& contacts = island.sets[set].contacts_W;
  findMiddle(contacts);
  clearBuckets();
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (!isFinite(c)) continue;
    const std::size_t b = bucketOf(c);
    if (bucket_[b] == kNone || c.depth > value_[b]) {
      bucket_[b] = i;
      value_[b] = c.depth;
    }
  }
  addBuckets(island, set);
}

void ContactSelection::gatherDeepest(Island& island) noexcept {
  std::size_t total = 0;
  for (std::size_t s = 0; s < island.setCount; ++s) {
    total += island.sets[island.own[s]].contacts_W.size();
  }
  const bool few = total <= kActiveContacts;
  for (std::size_t s = 0; s < island.setCount; ++s) {
    const std::uint32_t set = island.own[s];
    const std::size_t size = island.sets[set].contacts_W.size();
    island.reduced[set] = few || (island.setCount > 1 && size <= kSmallSet) ? 0 : 1;
    if (island.reduced[set] == 0) {
      addAll(island, set);
    } else {
      gatherDeepestOf(island, set);
    }
  }
  sortActive(island);
}

bool ContactSelection::gatherApproachingOf(Island& island, std::uint32_t set) noexcept {
  const ContactSet& of = island.sets[set];
  const double enough = kCheckFactor * island.settings->tolerance;
  if (island.setCount > 1) findMiddle(of.contacts_W);
  clearBuckets();
  bool any = false;
  // n·(v + w × (p - c)) = n·(v - w × c) + n·(w × p), for the difference of the two bodies.
  Eigen::Vector3d v = island.twist(of.body).head<3>(), w = island.twist(of.body).tail<3>();
  Eigen::Vector3d base = v - w.cross((*island.bodies)[of.body].p_WC);
  if (of.other != kAnatomy) {
    const Eigen::Vector3d vo = island.twist(of.other).head<3>();
    const Eigen::Vector3d wo = island.twist(of.other).tail<3>();
    base -= vo - wo.cross((*island.bodies)[of.other].p_WC);
    w -= wo;
  }
  for (std::uint32_t i = 0; i < of.contacts_W.size(); ++i) {
    const Contact& c = of.contacts_W[i];
    const double un = vector(c.n).dot(base + w.cross(vector(c.p)));
    const double excess = un + inwardOf(island, c.depth);
    if (!(excess < -enough) || !isFinite(c)) continue;
    const std::size_t b = bucketOf(c);
    if (bucket_[b] == kNone || excess < value_[b]) {
      bucket_[b] = i;
      value_[b] = excess;
      any = true;
    }
  }
  if (any) addBuckets(island, set);
  return any;
}

bool ContactSelection::gatherApproaching(Island& island) noexcept {
  bool any = false;
  for (std::size_t s = 0; s < island.setCount; ++s) {
    const std::uint32_t set = island.own[s];
    if (island.reduced[set] != 0 && gatherApproachingOf(island, set)) any = true;
  }
  if (any) sortActive(island);
  return any;
}

}  // namespace palpate
