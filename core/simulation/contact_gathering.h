#pragma once
/// Finds what touches what in a step: the instrument's shell in the anatomy and in every loose
/// body, every body's shell in the anatomy, and of two bodies the smaller one's shell in the other.

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "core/collision/contact_finder.h"
#include "core/dynamics/contact_response.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// Body 0 is the instrument, body i + 1 the scene's loose body i. Real-time safe after
/// construction. Levels that differ in their query have a finder of their own for each pair. One
/// thread at a time. A scene without bodies costs one query a step.
class ContactGathering {
 public:
  explicit ContactGathering(std::shared_ptr<const PreparedScene> scene);

  /// @param X_WB  of the loose bodies, as many as the scene has.
  void gather(const Eigen::Isometry3d& X_WT, std::span<const Eigen::Isometry3d> X_WB) noexcept;

  /// From the next gather() on: one of the scene's levels. No more than pointers are moved.
  void setLevel(std::size_t level) noexcept;

  /// Of the last gather(): not empty ones, p and n in W.
  [[nodiscard]] std::span<const ContactSet> sets() const noexcept {
    return {sets_.data(), setCount_};
  }
  /// Those of the instrument, by ascending touched body and shellIndex; Contact::body tells which.
  [[nodiscard]] std::span<const Contact> ofTool() const noexcept {
    return {contacts_.data(), toolCount_};
  }
  /// The bodies' own.
  [[nodiscard]] std::size_t betweenBodies() const noexcept { return count_ - toolCount_; }
  /// Sphere and leaf tests of the last gather().
  [[nodiscard]] std::uint32_t tests() const noexcept { return tests_; }
  /// Contacts were left out or cut: capacity or budget reached.
  [[nodiscard]] bool cut() const noexcept { return cut_; }
  [[nodiscard]] std::span<const Contact> memory() const noexcept { return contacts_; }

 private:
  /// A shell that may touch a tree.
  struct Pair {
    std::uint16_t body = 0, other = kAnatomy;
    ContactFinder finder;               ///< Of the level in force.
    std::vector<ContactFinder> others;  ///< Of the levels, by slot; that in use is empty there.
    const SurfaceTable* surface = nullptr;
    Eigen::Isometry3d X_otherV, X_Vother;  ///< Of the tree's grid in its body (or W) and back.
  };
  struct Sphere {  ///< Holds a body's voxels, in B.
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius = 0.0;
  };
  void planLevels();
  void add(std::uint16_t body, std::uint16_t other);
  [[nodiscard]] bool near(const Pair& pair) const noexcept;
  void query(Pair& pair) noexcept;

  std::shared_ptr<const PreparedScene> scene_;
  std::vector<QueryOptions> slots_;     ///< Queries that differ among the levels, the own first.
  std::vector<std::size_t> slotOf_;     ///< By level; empty where the scene has none.
  std::size_t inUse_ = 0;               ///< Slot
  std::vector<Pair> pairs_;             ///< The instrument's first.
  std::vector<Eigen::Isometry3d> X_W_;  ///< Of the bodies at this step.
  std::vector<Sphere> sphere_, sphere_W_;
  std::vector<Contact> contacts_;
  std::vector<ContactSet> sets_;
  std::size_t toolCount_ = 0, count_ = 0, setCount_ = 0, capacity_ = 0;
  std::uint32_t tests_ = 0;
  bool cut_ = false;
};

}  // namespace palpate
