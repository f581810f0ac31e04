#include <algorithm>
#include <cmath>

#include "core/dynamics/active_contact.h"

namespace palpate {
namespace {

// Finer than 1e-5 m/s, of the default tolerance ten times, is not worth an impulse.
constexpr double kPolishFactor = 10.0;

constexpr double kOpposed = -0.5;    // cosine of normals: 120 degrees apart and more
constexpr double kSingular = 1e-10;  // below: walls so parallel that no pair of impulses helps

/// @tparam kFriction  some contact may have friction; else nothing asks for it.
/// @tparam kAlone     one body among what does not move.
template <bool kFriction, bool kAlone>
class Impulses {
 public:
  explicit Impulses(Island& island) noexcept
      : island_(island),
        settings_(*island.settings),
        most_(settings_.iterations * static_cast<std::uint32_t>(island.bodyCount)),
        twist_(island.twist(island.active[0].body)) {}

  void run() noexcept {
    const double tolerance = settings_.tolerance;
    while (true) {
      ActiveContact* polish = nullptr;
      double polishGain = 0.0;
      bool polishSlides = false;
      bool acted = false;
      for (std::size_t k = 0; k < island_.count; ++k) {
        ActiveContact& a = island_.active[island_.order[k]];
        const Eigen::Vector3d u = velocityAt(a);
        const double un = a.n.dot(u);
        if (un < -a.inward - tolerance) {
          if (island_.effort.iterations >= most_) {
            island_.effort.capReached = true;
            return;
          }
          if (!a.prepared) island_.prepare(a);
          approach(a, u, un);
          ++island_.effort.iterations;
          acted = true;
          break;
        }
        if (a.normalImpulse <= 0.0 || a.bounced || a.settled) continue;
        considerPolish(a, u, un, polish, polishGain, polishSlides);
      }
      if (acted) continue;
      if (polish == nullptr || island_.effort.iterations >= most_) return;
      if (polishSlides) {
        slide(*polish);
      } else if (!takeBack(*polish)) {
        polish->settled = true;
      }
      ++island_.effort.iterations;
    }
  }

 private:
  void apply(ActiveContact& a, const Eigen::Vector3d& dj) noexcept {
    island_.twist(a.body).noalias() += a.toTwist * dj;
    if (a.other != kAnatomy) island_.twist(a.other).noalias() -= a.toTwistOther * dj;
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
    if ((j - jn * a.n).norm() > friction(a) * jn) return false;
    if (u.dot(dj) + 0.5 * dj.dot(a.K * dj) > 0.0) return false;
    apply(a, dj);
    return true;
  }

  /// Friction against the sliding, the total within the cone. A projected gradient step of 1/L:
  /// the energy cannot rise.
  void slide(ActiveContact& a) noexcept {
    if (friction(a) <= 0.0) return;
    const Eigen::Vector3d u = velocityAt(a);
    const Eigen::Vector3d tangent = u - a.n.dot(u) * a.n;
    const Eigen::Vector3d before = a.impulse - a.normalImpulse * a.n;
    Eigen::Vector3d after = before - tangent / a.Ktangent;
    const double limit = friction(a) * a.normalImpulse;
    const double length = after.norm();
    if (length > limit) after *= limit / length;
    apply(a, after - before);
  }

  /// Two contacts that press a body from opposite sides, a wedge: each impulse alone throws it at
  /// the other wall, and in a degree of wedge hundreds would pass between them. Both at once bring
  /// both to their velocities. Only where both total impulses push and the energy does not rise.
  bool wedgeOut(ActiveContact& a, const Eigen::Vector3d& u, double after) noexcept {
    ActiveContact* b = before_;
    if (b == nullptr || b == &a || b->normalImpulse <= 0.0 || b->bounced) return false;
    if (b->body != a.body || b->other != a.other || a.n.dot(b->n) > kOpposed) return false;
    Eigen::Vector3d atA = relativeChange(a, *b);  // of the velocity at a by a unit impulse at b
    const double cross = a.n.dot(atA);
    const double det = a.Kn * b->Kn - cross * cross;
    if (!(det > kSingular * a.Kn * b->Kn)) return false;
    const Eigen::Vector3d ub = velocityAt(*b);
    const double wantA = after - a.n.dot(u), wantB = -b->inward - b->n.dot(ub);
    const double ja = (b->Kn * wantA - cross * wantB) / det;
    const double jb = (a.Kn * wantB - cross * wantA) / det;
    if (a.normalImpulse + ja < 0.0 || b->normalImpulse + jb < 0.0) return false;
    const double work = ja * a.n.dot(u) + jb * b->n.dot(ub) +
                        0.5 * (ja * ja * a.Kn + jb * jb * b->Kn) + ja * jb * cross;
    if (work > 0.0) return false;
    apply(a, ja * a.n);
    apply(*b, jb * b->n);
    slide(a);
    slide(*b);
    return true;
  }

  /// Change of the relative velocity at a by a unit impulse along b's normal at b.
  [[nodiscard]] static Eigen::Vector3d relativeChange(const ActiveContact& a,
                                                      const ActiveContact& b) noexcept {
    const Vector6d body = b.toTwist * b.n;
    if (a.other == kAnatomy) return relative(a, body, nullptr);
    const Vector6d other = -(b.toTwistOther * b.n);
    return relative(a, body, &other);
  }

  void approach(ActiveContact& a, const Eigen::Vector3d& u, double un) noexcept {
    const double e = un < -settings_.restitutionSpeed ? a.restitution : 0.0;
    if (e > 0.0) a.bounced = true;
    const double after = e > 0.0 ? -e * un : -a.inward;
    const bool both = e <= 0.0 && wedgeOut(a, u, after);
    before_ = &a;
    if (both) return;
    if (friction(a) > 0.0 && stick(a, u, after)) return;
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
    if (friction(a) > 0.0 && stick(a, u, -a.inward)) return true;
    const Eigen::Vector3d tangent = a.impulse - a.normalImpulse * a.n;
    const double jn = a.normalImpulse - needless(a, un) / a.Kn;
    const double length = tangent.norm(), limit = friction(a) * jn;
    const Eigen::Vector3d cut =
        length > limit ? Eigen::Vector3d(tangent * (limit / length)) : tangent;
    const Eigen::Vector3d dj = jn * a.n + cut - a.impulse;
    if (u.dot(dj) + 0.5 * dj.dot(a.K * dj) <= 0.0) {
      apply(a, dj);
      return true;
    }
    const double held = std::max(jn, friction(a) > 0.0 ? length / friction(a) : 0.0);
    if (a.normalImpulse - held <= 1e-9 * a.normalImpulse) return false;
    apply(a, (held - a.normalImpulse) * a.n);
    return true;
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
    if (friction(a) > 0.0) {
      const double limit = friction(a) * a.normalImpulse;
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

  [[nodiscard]] Eigen::Vector3d velocityAt(const ActiveContact& a) const noexcept {
    if constexpr (kAlone) return relative(a, twist_, nullptr);
    return island_.velocityAt(a);
  }
  [[nodiscard]] static double friction([[maybe_unused]] const ActiveContact& a) noexcept {
    if constexpr (kFriction) return a.friction;
    return 0.0;
  }

  Island& island_;
  const ResponseSettings& settings_;
  std::uint32_t most_;               ///< Impulses of the island.
  const Vector6d& twist_;            ///< Of the body that is alone.
  ActiveContact* before_ = nullptr;  ///< That got the last impulse against an approach.
};

}  // namespace

void resolveVelocity(Island& island) noexcept {
  if (island.count == 0) return;
  const bool alone = island.bodyCount == 1;  // whom it touches would be on its island
  if (island.settings->friction) {
    alone ? Impulses<true, true>(island).run() : Impulses<true, false>(island).run();
  } else {
    alone ? Impulses<false, true>(island).run() : Impulses<false, false>(island).run();
  }
}

}  // namespace palpate
