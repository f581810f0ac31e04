#include "core/dynamics/contact_response.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/dynamics/active_contact.h"

namespace palpate {
namespace {

constexpr int kCheckRounds = 3;

void solve(Island& island, ContactSelection& selection) noexcept {
  selection.gatherDeepest(island);
  for (int round = 0; round < kCheckRounds && island.count > 0; ++round) {
    resolveVelocity(island);
    if (!selection.gatherApproaching(island)) break;
    const auto most = island.settings->iterations * static_cast<std::uint32_t>(island.bodyCount);
    if (round + 1 == kCheckRounds || island.effort.iterations >= most) {
      island.effort.capReached = true;
      break;
    }
  }
  if (island.count > 0) resolvePosition(island);
}

/// The cumulative impulse of each body, once.
void sumImpulses(Island& island) noexcept {
  for (std::size_t i = 0; i < island.count; ++i) {
    const ActiveContact& a = island.active[i];
    if (!a.prepared) continue;
    Vector6d& on = (*island.bodies)[a.body].response.impulse;
    on.head<3>() += a.impulse;
    on.tail<3>() += a.r.cross(a.impulse);
    if (a.other == kAnatomy) continue;
    Vector6d& against = (*island.bodies)[a.other].response.impulse;
    against.head<3>() -= a.impulse;
    against.tail<3>() -= a.rOther.cross(a.impulse);
  }
}

}  // namespace

struct ContactResolver::Scratch {
  explicit Scratch(std::size_t bodyCount) : bodies(std::max<std::size_t>(1, bodyCount)) {
    const std::size_t most =
        kActiveContacts * std::min<std::size_t>(bodies.size(), kBodiesWithOwnContacts);
    island.bodies = &bodies;
    island.active.resize(most);
    island.order.resize(most);
    // Every body with the anatomy, and every pair of bodies.
    const std::size_t sets = bodies.size() * (bodies.size() + 1) / 2;
    island.own.resize(sets);
    island.reduced.resize(sets);
  }

  [[nodiscard]] bool usable(const ContactSet& set) const noexcept {
    const auto there = [this](std::uint16_t body) {
      return body < bodies.size() && bodies[body].good;
    };
    return there(set.body) && (set.other == kAnatomy || there(set.other)) &&
           set.body != set.other && !set.contacts_W.empty() && set.materials != nullptr;
  }

  [[nodiscard]] std::uint16_t rootOf(std::uint16_t body) const noexcept {
    while (bodies[body].island != body) body = bodies[body].island;
    return body;
  }

  /// Bodies that touch, joined under the lowest.
  void join(std::span<const ContactSet> sets) noexcept {
    const auto count = static_cast<std::uint16_t>(bodies.size());
    for (std::uint16_t i = 0; i < count; ++i) bodies[i].island = i;
    for (const ContactSet& set : sets) {
      if (set.other == kAnatomy || !usable(set)) continue;
      const std::uint16_t a = rootOf(set.body), b = rootOf(set.other);
      bodies[std::max(a, b)].island = std::min(a, b);
    }
    for (std::uint16_t i = 0; i < count; ++i) bodies[i].island = rootOf(i);
  }

  /// The island of that root; false where nothing of it is touched.
  [[nodiscard]] bool enter(std::uint16_t root) noexcept {
    island.setCount = island.count = island.bodyCount = 0;
    island.effort = {};
    for (std::uint32_t s = 0; s < island.sets.size(); ++s) {
      const ContactSet& set = island.sets[s];
      if (usable(set) && bodies[set.body].island == root) island.own[island.setCount++] = s;
    }
    for (const ResponseBody& body : bodies) island.bodyCount += body.island == root ? 1 : 0;
    return island.setCount > 0;
  }

  std::vector<ResponseBody> bodies;
  Island island;
  ContactSelection selection;
};

ContactResolver::ContactResolver(std::size_t bodies)
    : scratch_(std::make_unique<Scratch>(bodies)) {}
ContactResolver::ContactResolver(ContactResolver&&) noexcept = default;
ContactResolver& ContactResolver::operator=(ContactResolver&&) noexcept = default;
ContactResolver::~ContactResolver() = default;

ResponseEffort ContactResolver::resolve(std::span<const ContactBody> bodies,
                                        std::span<const ContactSet> sets,
                                        const ResponseSettings& settings, double h,
                                        std::span<BodyResponse> out) noexcept {
  Scratch& s = *scratch_;
  const std::size_t count = std::min({bodies.size(), out.size(), s.bodies.size()});
  for (std::size_t i = 0; i < s.bodies.size(); ++i) {
    ResponseBody& body = s.bodies[i];
    body.response = {};
    body.good = i < count && bodies[i].twist.allFinite() && bodies[i].mobility.allFinite();
    if (i >= count) continue;
    body.p_WC = bodies[i].p_WC;
    body.mobility = bodies[i].mobility;
    body.response.twist = bodies[i].twist;
  }
  ResponseEffort effort;
  if (h > 0.0 && !sets.empty()) {
    s.island.sets = sets.first(std::min(sets.size(), s.island.own.size()));
    s.island.settings = &settings;
    s.island.h = h;
    s.join(s.island.sets);
    for (std::uint16_t root = 0; root < static_cast<std::uint16_t>(count); ++root) {
      if (s.bodies[root].island != root || !s.enter(root)) continue;
      solve(s.island, s.selection);
      sumImpulses(s.island);
      effort.iterations += s.island.effort.iterations;
      effort.activeContacts += static_cast<std::uint32_t>(s.island.count);
      effort.capReached = effort.capReached || s.island.effort.capReached;
    }
  }
  for (std::size_t i = 0; i < count; ++i) out[i] = s.bodies[i].response;
  return effort;
}

ContactResponse ContactResolver::resolveContacts(const ContactBody& body,
                                                 std::span<const Contact> contacts_W,
                                                 const SurfaceTable& materials,
                                                 const ResponseSettings& settings,
                                                 double h) noexcept {
  const ContactSet set{0, kAnatomy, contacts_W, &materials};
  ContactResponse out;
  BodyResponse& response = out;
  ResponseEffort& effort = out;
  effort = resolve({&body, 1}, {&set, 1}, settings, h, {&response, 1});
  return out;
}

}  // namespace palpate
