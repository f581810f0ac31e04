#include <algorithm>

#include "core/dynamics/active_contact.h"

namespace palpate {
namespace {

constexpr std::uint32_t kShiftIterations = 64;  // a body
constexpr double kShiftTolerance = 1e-9;        // m: a nanometre of push left over is none

/// What each contact lacks, less what its velocity will do by itself.
void wantPushes(Island& island, double most) noexcept {
  const ResponseSettings& settings = *island.settings;
  for (std::size_t k = 0; k < island.count; ++k) {
    ActiveContact& a = island.active[k];
    const double leaving = std::max(0.0, a.n.dot(island.velocityAt(a)) * island.h);
    a.push = std::min(settings.pushFraction * (a.depth - settings.allowedDepth), most) - leaving;
  }
}

Eigen::Vector3d shiftAt(const Island& island, const ActiveContact& a) noexcept {
  return relative(a, island.shift(a.body), a.other == kAnatomy ? nullptr : &island.shift(a.other));
}

ActiveContact* mostLacking(Island& island, double& lack) noexcept {
  ActiveContact* worst = nullptr;
  lack = kShiftTolerance;
  for (std::size_t k = 0; k < island.count; ++k) {
    ActiveContact& a = island.active[island.order[k]];
    const double l = a.push - a.n.dot(shiftAt(island, a));
    if (l > lack) {
      lack = l;
      worst = &a;
    }
  }
  return worst;
}

/// A body whose contact points would travel farther is shifted less; one that would go nowhere
/// sensible not at all.
void bound(Island& island, double most) noexcept {
  const auto count = static_cast<std::uint16_t>(island.bodies->size());
  for (std::uint16_t body = 0; body < count; ++body) {
    Vector6d& shift = island.shift(body);
    double travel = 0.0;
    for (std::size_t k = 0; k < island.count; ++k) {
      const ActiveContact& a = island.active[k];
      if (a.body != body && a.other != body) continue;
      const Eigen::Vector3d& r = a.body == body ? a.r : a.rOther;
      travel = std::max(travel, (shift.head<3>() + shift.tail<3>().cross(r)).norm());
    }
    if (travel > most) shift *= most / travel;
    if (!shift.allFinite()) shift.setZero();
  }
}

}  // namespace

void resolvePosition(Island& island) noexcept {
  const double most = island.settings->pushSpeed * island.h;
  wantPushes(island, most);
  const auto passes = kShiftIterations * static_cast<std::uint32_t>(island.bodyCount);
  for (std::uint32_t i = 0; i < passes; ++i) {
    double lack = 0.0;
    ActiveContact* worst = mostLacking(island, lack);
    if (worst == nullptr) break;
    if (!worst->prepared) island.prepare(*worst);
    const Eigen::Vector3d push = (lack / worst->Kn) * worst->n;
    island.shift(worst->body).noalias() += worst->toTwist * push;
    if (worst->other != kAnatomy)
      island.shift(worst->other).noalias() -= worst->toTwistOther * push;
  }
  bound(island, 2.0 * most);
}

}  // namespace palpate
