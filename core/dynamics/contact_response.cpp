#include "core/dynamics/contact_response.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

constexpr std::uint32_t kNone = 0xFFFFFFFF;
constexpr std::size_t kDirections = 24;  // six faces of a cube, each in four
constexpr std::size_t kPlaces = 8;       // octants of the contacts' box
constexpr std::size_t kBuckets = kDirections * kPlaces;
constexpr int kCheckRounds = 3;
constexpr std::uint32_t kShiftIterations = 64;
constexpr double kShiftTolerance = 1e-9;  // m: a nanometre of push left over is none

static_assert(kBuckets <= kActiveContacts);

Eigen::Vector3d normalOf(const Contact& c) noexcept {
  return {c.n[0], c.n[1], c.n[2]};
}

bool isFinite(const Contact& c) noexcept {
  // One sum is not finite if any term is not (terms of opposite infinities give NaN).
  return std::isfinite(c.p[0] + c.p[1] + c.p[2] + c.n[0] + c.n[1] + c.n[2] + c.depth);
}

/// Largest eigenvalue of the symmetric 2x2 matrix [a b; b c].
double largestEigenvalue(double a, double b, double c) noexcept {
  return 0.5 * (a + c) + std::sqrt(0.25 * (a - c) * (a - c) + b * b);
}

}  // namespace

/// A contact that takes part. What a scan reads comes first; the rest is filled when first chosen.
struct ActiveContact {
  Eigen::Vector3d r;  // from the centre of mass
  Eigen::Vector3d n;
  double depth = 0.0;
  double push = 0.0;    // m of position correction wanted
  double inward = 0.0;  // m/s it may approach: to the allowed depth within the step
  double normalImpulse = 0.0;
  double tangentImpulse2 = 0.0;  // squared length
  double friction = 0.0;
  double restitution = 0.0;
  std::uint32_t index = 0;  // in the step's contacts
  bool prepared = false;
  bool bounced = false;
  bool settled = false;     // nothing of its impulse can be taken back
  Eigen::Vector3d impulse;  // cumulative
  Matrix63d toTwist;        // impulse here -> change of twist
  Eigen::Matrix3d K;        // impulse here -> change of velocity here (Mirtich)
  Eigen::Matrix3d Kinverse;
  double Kn = 0.0;        // n·K·n
  double Ktangent = 0.0;  // largest eigenvalue of K in the tangent plane
};

struct ContactResolver::Scratch {
  std::array<ActiveContact, kActiveContacts> active;
  std::array<std::uint32_t, kActiveContacts> order;  // of active, deepest first
  std::size_t count = 0;
  std::array<std::uint32_t, kBuckets> bucket;
  std::array<double, kBuckets> bucketValue;
};

namespace {

/// One response, in stages: gather, then velocity and check in rounds, then position.
class Response {
 public:
  template <class Scratch>
  Response(Scratch& s, const ContactBody& body, std::span<const Contact> contacts,
           const SurfaceTable& materials, const ResponseSettings& settings, double h) noexcept
      : active_(s.active.data()),
        order_(s.order.data()),
        bucket_(s.bucket.data()),
        bucketValue_(s.bucketValue.data()),
        body_(body),
        contacts_(contacts),
        materials_(materials),
        settings_(settings),
        h_(h),
        twist_(body.twist) {}

  ContactResponse run() noexcept {
    gatherDeepest();
    for (int round = 0; round < kCheckRounds && count_ > 0; ++round) {
      resolveVelocity();
      if (count_ == contacts_.size() || !gatherApproaching()) break;
      if (round + 1 == kCheckRounds || out_.iterations >= settings_.iterations) {
        out_.capReached = true;
        break;
      }
    }
    if (count_ > 0) resolvePosition();
    out_.twist = twist_;
    out_.activeContacts = static_cast<std::uint32_t>(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      const ActiveContact& a = active_[i];
      if (!a.prepared) continue;
      out_.impulse.head<3>() += a.impulse;
      out_.impulse.tail<3>() += a.r.cross(a.impulse);
    }
    return out_;
  }

 private:
  // ---- gather ----

  std::size_t bucketOf(const Contact& c) const noexcept {
    const double ax = std::abs(c.n[0]), ay = std::abs(c.n[1]), az = std::abs(c.n[2]);
    const std::size_t axis = ax >= ay ? (ax >= az ? 0 : 2) : (ay >= az ? 1 : 2);
    const std::size_t face = 2 * axis + (c.n[axis] < 0.0 ? 1 : 0);
    const std::size_t quarter =
        (c.n[(axis + 1) % 3] < 0.0 ? 1u : 0u) + (c.n[(axis + 2) % 3] < 0.0 ? 2u : 0u);
    const std::size_t place = (c.p[0] < middle_.x() ? 1u : 0u) + (c.p[1] < middle_.y() ? 2u : 0u) +
                              (c.p[2] < middle_.z() ? 4u : 0u);
    return (4 * face + quarter) * kPlaces + place;
  }

  void findMiddle() noexcept {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;
    for (const Contact& c : contacts_) {
      if (!isFinite(c)) continue;
      const Eigen::Vector3d p(c.p[0], c.p[1], c.p[2]);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    middle_ = 0.5 * (low + high);
  }

  /// A contact shallower than the allowed depth may sink to it: a resting or sliding tool then
  /// stays in contact, instead of hopping off and back.
  double inwardOf(double depth) const noexcept {
    return std::max(0.0, settings_.allowedDepth - depth) / h_;
  }

  void add(std::uint32_t index) noexcept {
    const Contact& c = contacts_[index];
    ActiveContact& a = active_[count_];
    a.r = Eigen::Vector3d(c.p[0], c.p[1], c.p[2]) - body_.p_WC;
    a.n = normalOf(c);
    a.depth = c.depth;
    a.inward = inwardOf(c.depth);
    const SurfaceMaterial& m = materials_[c.label];
    a.friction = settings_.friction ? std::max(0.0, m.friction) : 0.0;
    a.restitution = std::clamp(m.restitution, 0.0, 1.0);
    a.normalImpulse = a.tangentImpulse2 = 0.0;
    a.index = index;
    a.prepared = a.bounced = a.settled = false;
    ++count_;
  }

  /// Deepest first; equal depths by index, so that the order is the same on every run.
  void sortActive() noexcept {
    for (std::size_t i = 0; i < count_; ++i) order_[i] = static_cast<std::uint32_t>(i);
    std::sort(order_, order_ + count_, [this](std::uint32_t x, std::uint32_t y) {
      const ActiveContact &a = active_[x], &b = active_[y];
      return a.depth != b.depth ? a.depth > b.depth : a.index < b.index;
    });
  }

  void addBuckets() noexcept {
    for (std::size_t b = 0; b < kBuckets; ++b) {
      if (bucket_[b] != kNone && count_ < kActiveContacts) add(bucket_[b]);
    }
    sortActive();
  }

  void gatherDeepest() noexcept {
    if (contacts_.size() <= kActiveContacts) {
      for (std::uint32_t i = 0; i < contacts_.size(); ++i) {
        if (isFinite(contacts_[i])) add(i);
      }
      sortActive();
      reduced_ = false;
      return;
    }
    findMiddle();
    std::fill(bucket_, bucket_ + kBuckets, kNone);
    for (std::uint32_t i = 0; i < contacts_.size(); ++i) {
      const Contact& c = contacts_[i];
      if (!isFinite(c)) continue;
      const std::size_t b = bucketOf(c);
      if (bucket_[b] == kNone || c.depth > bucketValue_[b]) {
        bucket_[b] = i;
        bucketValue_[b] = c.depth;
      }
    }
    addBuckets();
  }

  /// Of each bucket the contact that still approaches fastest joins. False: none does.
  bool gatherApproaching() noexcept {
    if (!reduced_) return false;
    std::fill(bucket_, bucket_ + kBuckets, kNone);
    bool any = false;
    const Eigen::Vector3d v = twist_.head<3>(), w = twist_.tail<3>();
    // n·(v + w × (p - c)) = n·(v - w × c) + n·(w × p)
    const Eigen::Vector3d base = v - w.cross(body_.p_WC);
    for (std::uint32_t i = 0; i < contacts_.size(); ++i) {
      const Contact& c = contacts_[i];
      const Eigen::Vector3d p(c.p[0], c.p[1], c.p[2]);
      const double un = normalOf(c).dot(base + w.cross(p));
      const double excess = un + inwardOf(c.depth);
      if (!(excess < -kCheckFactor * settings_.tolerance) || !isFinite(c)) continue;
      const std::size_t b = bucketOf(c);
      if (bucket_[b] == kNone || excess < bucketValue_[b]) {
        bucket_[b] = i;
        bucketValue_[b] = excess;
        any = true;
      }
    }
    if (any) addBuckets();
    return any;
  }

  // ---- velocity ----

  Eigen::Vector3d velocityAt(const ActiveContact& a) const noexcept {
    return twist_.head<3>() + twist_.tail<3>().cross(a.r);
  }

  void prepare(ActiveContact& a) noexcept {
    Matrix63d Pt;  // transpose of P = [1, -[r]x]
    Pt.topRows<3>().setIdentity();
    Pt.bottomRows<3>() << 0.0, -a.r.z(), a.r.y(), a.r.z(), 0.0, -a.r.x(), -a.r.y(), a.r.x(), 0.0;
    a.toTwist.noalias() = body_.mobility * Pt;
    a.K.noalias() = Pt.transpose() * a.toTwist;
    a.Kinverse = a.K.inverse();
    a.Kn = a.n.dot(a.K * a.n);
    const Eigen::Vector3d t1 = a.n.unitOrthogonal();
    const Eigen::Vector3d t2 = a.n.cross(t1);
    const Eigen::Vector3d Kt1 = a.K * t1;
    a.Ktangent = largestEigenvalue(t1.dot(Kt1), t2.dot(Kt1), t2.dot(a.K * t2));
    a.impulse.setZero();
    a.prepared = true;
  }

  void apply(ActiveContact& a, const Eigen::Vector3d& dj) noexcept {
    twist_.noalias() += a.toTwist * dj;
    a.impulse += dj;
    a.normalImpulse = a.n.dot(a.impulse);
    a.tangentImpulse2 = std::max(0.0, a.impulse.squaredNorm() - a.normalImpulse * a.normalImpulse);
  }

  /// Brings the contact to rest (and bounce) in one impulse, if Coulomb's cone and the energy
  /// allow.
  bool stick(ActiveContact& a, const Eigen::Vector3d& u, double after) noexcept {
    const Eigen::Vector3d dj = a.Kinverse * (after * a.n - u);
    const Eigen::Vector3d j = a.impulse + dj;
    const double jn = a.n.dot(j);
    if (jn < 0.0) return false;
    if ((j - jn * a.n).norm() > a.friction * jn) return false;
    if (u.dot(dj) + 0.5 * dj.dot(a.K * dj) > 0.0) return false;
    apply(a, dj);
    return true;
  }

  /// Friction against the sliding, the total within the cone. A projected gradient step of 1/L:
  /// the energy cannot rise.
  void slide(ActiveContact& a) noexcept {
    if (a.friction <= 0.0) return;
    const Eigen::Vector3d u = velocityAt(a);
    const Eigen::Vector3d tangent = u - a.n.dot(u) * a.n;
    const Eigen::Vector3d before = a.impulse - a.normalImpulse * a.n;
    Eigen::Vector3d after = before - tangent / a.Ktangent;
    const double limit = a.friction * a.normalImpulse;
    const double length = after.norm();
    if (length > limit) after *= limit / length;
    apply(a, after - before);
  }

  void approach(ActiveContact& a, const Eigen::Vector3d& u, double un) noexcept {
    const double e = un < -settings_.restitutionSpeed ? a.restitution : 0.0;
    if (e > 0.0) a.bounced = true;
    const double after = e > 0.0 ? -e * un : -a.inward;
    if (a.friction > 0.0 && stick(a, u, after)) return;
    apply(a, ((after - un) / a.Kn) * a.n);
    slide(a);
  }

  /// How much of a contact's impulse later impulses made needless, as a velocity.
  [[nodiscard]] static double needless(const ActiveContact& a, double un) noexcept {
    return std::min(a.normalImpulse * a.Kn, un + a.inward);
  }

  /// Takes a needless impulse back, with the friction that it carried. Only what does not raise the
  /// energy: first to rest in one go, then along the normal with the friction cut to its new cone,
  /// then down to what that friction needs. False: nothing can go.
  bool takeBack(ActiveContact& a) noexcept {
    const Eigen::Vector3d u = velocityAt(a);
    const double un = a.n.dot(u);
    if (a.friction > 0.0 && stick(a, u, -a.inward)) return true;
    const Eigen::Vector3d tangent = a.impulse - a.normalImpulse * a.n;
    const double jn = a.normalImpulse - needless(a, un) / a.Kn;
    const double length = tangent.norm(), limit = a.friction * jn;
    const Eigen::Vector3d cut =
        length > limit ? Eigen::Vector3d(tangent * (limit / length)) : tangent;
    const Eigen::Vector3d dj = jn * a.n + cut - a.impulse;
    if (u.dot(dj) + 0.5 * dj.dot(a.K * dj) <= 0.0) {
      apply(a, dj);
      return true;
    }
    const double held = std::max(jn, a.friction > 0.0 ? length / a.friction : 0.0);
    if (a.normalImpulse - held <= 1e-9 * a.normalImpulse) return false;
    apply(a, (held - a.normalImpulse) * a.n);
    return true;
  }

  void resolveVelocity() noexcept {
    const double tolerance = settings_.tolerance;
    while (true) {
      ActiveContact* polish = nullptr;
      double polishGain = 0.0;
      bool polishSlides = false;
      bool acted = false;
      for (std::size_t k = 0; k < count_; ++k) {
        ActiveContact& a = active_[order_[k]];
        const Eigen::Vector3d u = velocityAt(a);
        const double un = a.n.dot(u);
        if (un < -a.inward - tolerance) {
          if (out_.iterations >= settings_.iterations) {
            out_.capReached = true;
            return;
          }
          if (!a.prepared) prepare(a);
          approach(a, u, un);
          ++out_.iterations;
          acted = true;
          break;
        }
        if (a.normalImpulse <= 0.0 || a.bounced || a.settled) continue;
        considerPolish(a, u, un, polish, polishGain, polishSlides);
      }
      if (acted) continue;
      if (polish == nullptr || out_.iterations >= settings_.iterations) return;
      if (polishSlides) {
        slide(*polish);
      } else if (!takeBack(*polish)) {
        polish->settled = true;
      }
      ++out_.iterations;
    }
  }

  /// Of the contacts that no longer approach, the one with the most to gain: a needless impulse, or
  /// friction not yet spent on a slide.
  void considerPolish(ActiveContact& a, const Eigen::Vector3d& u, double un, ActiveContact*& best,
                      double& gain, bool& slides) const noexcept {
    const double enough = kPolishFactor * settings_.tolerance;
    if (un + a.inward > enough) {
      const double g = needless(a, un);
      if (g > enough && g > gain) {
        best = &a;
        gain = g;
        slides = false;
      }
    }
    if (a.friction > 0.0) {
      const double limit = a.friction * a.normalImpulse;
      if (a.tangentImpulse2 < limit * limit * (1.0 - 1e-9)) {
        const double g = (u - un * a.n).norm();
        if (g > enough && g > gain) {
          best = &a;
          gain = g;
          slides = true;
        }
      }
    }
  }

  // ---- position ----

  /// Pushes apart without velocity: in the metric of the mobility, deepest first, each contact by
  /// what it lacks; the whole bounded by twice the largest single push.
  void resolvePosition() noexcept {
    const double most = settings_.pushSpeed * h_;
    for (std::size_t k = 0; k < count_; ++k) {
      ActiveContact& a = active_[k];
      const double leaving = std::max(0.0, a.n.dot(velocityAt(a)) * h_);
      a.push =
          std::min(settings_.pushFraction * (a.depth - settings_.allowedDepth), most) - leaving;
    }
    Vector6d shift = Vector6d::Zero();
    for (std::uint32_t i = 0; i < kShiftIterations; ++i) {
      ActiveContact* worst = nullptr;
      double lack = kShiftTolerance;
      for (std::size_t k = 0; k < count_; ++k) {
        ActiveContact& a = active_[order_[k]];
        const double l = a.push - a.n.dot(shift.head<3>() + shift.tail<3>().cross(a.r));
        if (l > lack) {
          lack = l;
          worst = &a;
        }
      }
      if (worst == nullptr) break;
      if (!worst->prepared) prepare(*worst);
      shift.noalias() += worst->toTwist * ((lack / worst->Kn) * worst->n);
    }
    double travel = 0.0;
    for (std::size_t k = 0; k < count_; ++k) {
      const ActiveContact& a = active_[k];
      travel = std::max(travel, (shift.head<3>() + shift.tail<3>().cross(a.r)).norm());
    }
    if (travel > 2.0 * most) shift *= 2.0 * most / travel;
    if (shift.allFinite()) out_.shift = shift;
  }

  static constexpr double kPolishFactor = 10.0;  // finer than 1e-5 m/s is not worth an impulse
  static constexpr double kCheckFactor = 10.0;

  ActiveContact* active_;
  std::uint32_t* order_;
  std::uint32_t* bucket_;
  double* bucketValue_;
  const ContactBody& body_;
  std::span<const Contact> contacts_;
  const SurfaceTable& materials_;
  const ResponseSettings& settings_;
  double h_;
  Vector6d twist_;
  std::size_t count_ = 0;
  bool reduced_ = true;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  ContactResponse out_;
};

}  // namespace

ContactResolver::ContactResolver() : scratch_(std::make_unique<Scratch>()) {}
ContactResolver::ContactResolver(ContactResolver&&) noexcept = default;
ContactResolver& ContactResolver::operator=(ContactResolver&&) noexcept = default;
ContactResolver::~ContactResolver() = default;

ContactResponse ContactResolver::resolveContacts(const ContactBody& body,
                                                 std::span<const Contact> contacts_W,
                                                 const SurfaceTable& materials,
                                                 const ResponseSettings& settings,
                                                 double h) noexcept {
  ContactResponse out;
  out.twist = body.twist;
  if (!body.twist.allFinite() || !body.mobility.allFinite() || !(h > 0.0)) return out;
  return Response(*scratch_, body, contacts_W, materials, settings, h).run();
}

}  // namespace palpate
