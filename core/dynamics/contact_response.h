#pragma once
/// Impulses that keep a body from moving into what it touches (paper 3.3.1).
///
/// From one step's contacts the deepest that would not separate by itself gets an impulse for a
/// separating velocity; the body's velocity is updated; so on with the same set until none is left
/// or the cap is reached. The cumulative impulse is applied once, by the caller's body. Friction is
/// Coulomb's, restitution Newton's per impulse.
///
/// Departures from the paper, and why:
/// - Impulses are remembered per contact, so friction is bounded by that contact's whole normal
///   impulse, and one that later impulses made needless is taken back. Each single update lowers
///   (or keeps) the kinetic energy in the metric of `mobility`, so the whole cannot raise it.
/// - Penetration is removed by a bounded shift of the pose without velocity, not by the impulse:
///   a separating velocity sized by depth adds energy.
/// - Thousands of contacts are reduced to the deepest of each bucket of place and direction; the
///   full set is checked after each round, and what still approaches joins (at most three rounds).
///
/// Any number of bodies: bodies that touch each other are resolved together, as an island; islands
/// do not see each other. A contact's impulse acts on both its bodies, so momentum is kept to
/// rounding.
///
/// Cost: c passes over all n contacts (2 <= c <= 4, about 10 ns each) plus at most `iterations`
/// scans of at most kActiveContacts a body: linear in n.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "core/collision/contact.h"
#include "core/dynamics/rigid_body.h"

namespace palpate {

/// Of a pair of materials.
struct SurfaceMaterial {
  double friction = 0.2;     ///< Coulomb's coefficient, >= 0.
  double restitution = 0.0;  ///< 0..1
};
/// What one body's surface meets: by the contact's label.
using SurfaceTable = std::array<SurfaceMaterial, 256>;

struct ResponseSettings {
  std::uint32_t iterations = 200;  ///< Impulses a step and body of an island.
  bool friction = true;
  double allowedDepth = 2e-5;      ///< m left in, so that a resting contact persists.
  double pushFraction = 0.3;       ///< Of the remaining depth, removed a step.
  double pushSpeed = 0.095;        ///< m/s: depth is never removed faster than this.
  double restitutionSpeed = 0.02;  ///< m/s: slower approaches do not bounce (no buzzing at rest).
  double tolerance = 1e-5;         ///< m/s: approach or slip below this counts as none.
};

/// What moves: where its centre is, its twist, and how it answers an impulse. For a free body
/// mobility is RigidBody::mobility(); for a body on an implicit coupling it is that of the coupled
/// system (ToolBody), so that the contact force in rest equals the coupling's force.
struct ContactBody {
  Eigen::Vector3d p_WC = Eigen::Vector3d::Zero();
  Vector6d twist = Vector6d::Zero();
  Matrix6d mobility = Matrix6d::Identity();
};

/// In the place of a body: what does not move.
inline constexpr std::uint16_t kAnatomy = 0xFFFF;

/// The contacts of one body's shell with another's tree, or with the anatomy's.
struct ContactSet {
  std::uint16_t body = 0;          ///< Whose shell it is; n pushes it.
  std::uint16_t other = kAnatomy;  ///< Whose tree it is; -n pushes it. Not the same body.
  std::span<const Contact> contacts_W;
  const SurfaceTable* materials = nullptr;  ///< What the shell's body meets there.
};

struct BodyResponse {
  Vector6d twist = Vector6d::Zero();    ///< After the impulses.
  Vector6d impulse = Vector6d::Zero();  ///< Cumulative, on the body: N·s, N·m·s about its centre.
  Vector6d shift = Vector6d::Zero();    ///< Pose correction: m, rad about its centre.
};

struct ResponseEffort {
  std::uint32_t iterations = 0;      ///< Impulses used (velocity).
  std::uint32_t activeContacts = 0;  ///< That took part.
  bool capReached = false;           ///< Some contact still approaches.
};

/// Of one body among what does not move.
struct ContactResponse : BodyResponse, ResponseEffort {};

/// The most contacts of a body that take part in one response.
inline constexpr std::size_t kActiveContacts = 256;
/// From this number of bodies on an island's active contacts are no more.
inline constexpr std::size_t kBodiesWithOwnContacts = 16;

/// Owns the scratch, sized at construction. One thread at a time.
class ContactResolver {
 public:
  explicit ContactResolver(std::size_t bodies = 1);
  ContactResolver(ContactResolver&&) noexcept;
  ContactResolver& operator=(ContactResolver&&) noexcept;
  ~ContactResolver();

  /// Contacts with p and n in W, any order; equal inputs give equal bits. Contacts that are not
  /// finite are left out; so are sets of bodies that are not there or whose numbers are not finite.
  /// `out` and `bodies` are of one length, at most what the constructor was told. Real-time safe.
  ResponseEffort resolve(std::span<const ContactBody> bodies, std::span<const ContactSet> sets,
                         const ResponseSettings& settings, double h,
                         std::span<BodyResponse> out) noexcept;

  /// The same for a single body.
  [[nodiscard]] ContactResponse resolveContacts(const ContactBody& body,
                                                std::span<const Contact> contacts_W,
                                                const SurfaceTable& materials,
                                                const ResponseSettings& settings,
                                                double h) noexcept;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace palpate
