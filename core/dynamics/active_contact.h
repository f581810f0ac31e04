#pragma once
/// The contacts of an island that take part in a response. Internal to contact_response.h.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "core/dynamics/contact_response.h"

namespace palpate {

using Matrix63d = Eigen::Matrix<double, 6, 3>;

/// A body while it is being resolved.
struct ResponseBody {
  Eigen::Vector3d p_WC = Eigen::Vector3d::Zero();
  Matrix6d mobility = Matrix6d::Identity();
  BodyResponse response;
  std::uint16_t island = 0;  ///< The lowest body it touches, through others or itself.
  bool good = false;         ///< Its numbers are finite.
};

/// A contact that takes part. What a scan reads comes first; the rest is filled when first chosen.
struct ActiveContact {
  Eigen::Vector3d r;       // from the body's centre of mass
  Eigen::Vector3d rOther;  // from the other's
  Eigen::Vector3d n;
  std::uint16_t body = 0, other = kAnatomy;
  bool prepared = false;
  bool bounced = false;
  bool settled = false;  // nothing of its impulse can be taken back
  double depth = 0.0;
  double push = 0.0;    // m of position correction wanted
  double inward = 0.0;  // m/s it may approach: to the allowed depth within the step
  double normalImpulse = 0.0;
  double tangentImpulse2 = 0.0;  // squared length
  double friction = 0.0;
  double restitution = 0.0;
  std::uint32_t set = 0, index = 0;  // in the step's contacts
  Eigen::Vector3d impulse;           // cumulative
  Matrix63d toTwist;                 // impulse here -> change of the body's twist
  Matrix63d toTwistOther;            // impulse here -> change of the other's twist, negative
  Eigen::Matrix3d K;                 // impulse here -> change of relative velocity here (Mirtich)
  Eigen::Matrix3d Kinverse;
  double Kn = 0.0;        // n·K·n
  double Ktangent = 0.0;  // largest eigenvalue of K in the tangent plane
};

/// Velocity, or shift, of the body's point less the other's.
[[nodiscard]] inline Eigen::Vector3d relative(const ActiveContact& a, const Vector6d& body,
                                              const Vector6d* other) noexcept {
  Eigen::Vector3d u = body.head<3>() + body.tail<3>().cross(a.r);
  if (other != nullptr) u -= other->head<3>() + other->tail<3>().cross(a.rOther);
  return u;
}

/// One island while it is resolved: which sets, and of their contacts which take part.
struct Island {
  std::vector<ResponseBody>* bodies = nullptr;
  std::span<const ContactSet> sets;
  const ResponseSettings* settings = nullptr;
  double h = 0.0;

  std::vector<std::uint32_t> own;     ///< Its sets, ascending.
  std::vector<std::uint8_t> reduced;  ///< By set: not all its contacts take part.
  std::vector<ActiveContact> active;
  std::vector<std::uint32_t> order;  ///< Of active, deepest first.
  std::size_t setCount = 0, count = 0, bodyCount = 0;
  ResponseEffort effort;

  [[nodiscard]] Vector6d& twist(std::uint16_t body) const noexcept {
    return (*bodies)[body].response.twist;
  }
  [[nodiscard]] Vector6d& shift(std::uint16_t body) const noexcept {
    return (*bodies)[body].response.shift;
  }
  [[nodiscard]] Eigen::Vector3d velocityAt(const ActiveContact& a) const noexcept {
    return relative(a, twist(a.body), a.other == kAnatomy ? nullptr : &twist(a.other));
  }
  /// Fills what an impulse needs.
  void prepare(ActiveContact& a) const noexcept;
};

/// Picks what takes part: everything where contacts are few; else of each set the deepest of each
/// bucket of place and direction, and later what still approaches.
class ContactSelection {
 public:
  ContactSelection();
  /// Fills active and order. Contacts that are not finite are left out.
  void gatherDeepest(Island& island) noexcept;
  /// Of each bucket the contact that still approaches fastest joins. False: none does.
  bool gatherApproaching(Island& island) noexcept;

 private:
  static constexpr std::size_t kDirections = 24;  // six faces of a cube, each in four
  static constexpr std::size_t kPlaces = 8;       // octants of the contacts' box
  static constexpr std::size_t kBuckets = kDirections * kPlaces;
  static_assert(kBuckets <= kActiveContacts);

  [[nodiscard]] std::size_t bucketOf(const Contact& c) const noexcept;
  void findMiddle(std::span<const Contact> contacts) noexcept;
  void clearBuckets() noexcept;
  void addBuckets(Island& island, std::uint32_t set) noexcept;
  void gatherDeepestOf(Island& island, std::uint32_t set) noexcept;
  bool gatherApproachingOf(Island& island, std::uint32_t set) noexcept;

  std::array<std::uint32_t, kBuckets> bucket_{};
  std::array<double, kBuckets> value_{};
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
};

/// Impulses until nothing approaches, or the cap is reached (paper 3.3.1).
void resolveVelocity(Island& island) noexcept;

/// Pushes apart without velocity: in the metric of the mobilities, deepest first, each contact by
/// what it lacks; each body by no more than twice the largest single push.
void resolvePosition(Island& island) noexcept;

}  // namespace palpate
