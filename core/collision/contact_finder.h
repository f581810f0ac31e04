#pragma once
/// Contacts between the voxel tree and a moving point shell (paper 3.2).

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/collision/contact.h"
#include "core/collision/packed_contacts.h"
#include "core/collision/point_shell.h"
#include "core/voxels/voxel_tree.h"

namespace palpate {

/// `Hierarchy`: a hierarchy over the shell's points against the tree (the default, fast).
/// `Paper`: both trees descended breadth-first as the paper has it. `BruteForce`: every point.
/// Distance leaves are read many points at a time by the first and the last of these.
enum class QueryMethod : std::uint8_t { Hierarchy, Paper, BruteForce };

/// Exact options (tightSpheres, oneChildSkip, sideOffset, threads, coherence) never change the
/// contact set; stopLevel, contactBudget and perceptualBound trade: contacts that stand for more
/// are flagged approximate, and are the same whatever the method and the exact options.
struct QueryOptions {
  QueryMethod method = QueryMethod::Hierarchy;
  bool tightSpheres = true;
  bool oneChildSkip = true;
  bool sideOffset = false;
  int stopLevel = 0;  ///< 0: down to the voxels.

  /// More contacts than this: cut, and say so. Before the whole shell one point for each node of
  /// its hierarchy's levels is asked, the coarsest level with more nodes than the budget first; a
  /// level that has more contacts than the budget already promises too many, and nothing finer is
  /// looked at. So no more than about 16 times the budget's contacts are ever found, and time
  /// follows. Then the deepest of those found stays in every node, at the finest level of nodes
  /// that fits. Where the cut came before the points themselves, the deepest is that of the nodes'
  /// points nearest to their middles: others may be deeper, by up to what perceptualBound says of a
  /// node of that size. Below the budget nothing changes but a sixteenth of the time.
  std::uint32_t contactBudget = 0xFFFFFFFF;

  /// Threads of a query, the caller included; beyond 64 are 64. Where distance leaves are read many
  /// points at a time and enough of them are live to pay for the hand-off (fast_query.h), the
  /// others help; elsewhere they sleep. Order and bits are the same at any number. They are started
  /// with the finder, and inherit scheduling and processors of the thread that makes it.
  int threads = 1;

  /// Remember the nodes near the last pose and descend from these alone while the tool has moved
  /// less than a margin (fast_query.h; QueryMethod::Hierarchy on whole distance leaves, elsewhere
  /// it does nothing). Off, since it is worth little today: out of reach 0.23 -> 0.08 µs for
  /// 100,000 points, but in contact, where the leaves cost and not the nodes above them, 0.98
  /// to 1.04 of the time without, sliding, approaching and teleporting alike.
  bool coherence = false;

  /// Metres; 0 is off. After Otaduy & Lin's contact levels of detail ("Sensation preserving
  /// simplification for haptic rendering", 2003): descent of the shell's hierarchy stops where what
  /// it could still reveal is not felt. A node whose points all lie within b = perceptualBound of
  /// one of them (the one nearest to the middle of its sphere) is not descended: that point stands
  /// for the node, and is a contact where the leaf model finds it inside, as deep as it is. So the
  /// contacts are some of the exact ones, bit for bit. Against those that are left out:
  ///  - the stand-in lies within b;
  ///  - distance leaves: its depth differs by at most L·b, and a node that goes without a contact
  ///    holds none deeper than L·b. L = √3 where voxels are cubes: distances are 1-Lipschitz along
  ///    each edge of a cell, so their interpolation is along each axis; else
  ///    L = √Σ(2 − s/h)² over the spacings h, with s the smallest. Depths are stored to within
  ///    s/1000 each. Contacts end abruptly at the box of voxel centres (and at the walls of a
  ///    surface-only tree): a node across it may go without.
  ///  - voxel leaves jump from voxel to voxel: b plus two diagonals of a voxel instead of L·b.
  /// Departure: their bound is weighted by the area of contact, which takes a pass over all
  /// contacts first; this one is the same for all, hence on the safe side where contacts are small.
  double perceptualBound = 0.0;
};

enum class QueryStatus : std::uint8_t {
  Complete,
  OutputFull,   ///< Contacts are valid; more exist.
  BudgetSpent,  ///< Contacts are valid; some regions were not descended.
  /// Contacts are valid; perceptualBound left out some points of this shell, whatever the pose.
  Approximate,
  BadPose,  ///< X_VT not finite or not rigid; nothing written.
};

struct QueryResult {
  QueryStatus status = QueryStatus::Complete;
  std::size_t contactCount = 0;
  std::uint32_t tests = 0;  ///< Sphere and leaf tests.
};

/// Owns the scratch of one query, sized at construction; the tree and the shell must outlive it.
/// One thread at a time.
class ContactFinder {
 public:
  ContactFinder(const VoxelTree& tree, const PointShell& shell, const QueryOptions& options = {});
  ContactFinder(ContactFinder&&) noexcept;
  ContactFinder& operator=(ContactFinder&&) noexcept;  ///< Frees the memory that it had, if any.
  ~ContactFinder();

  /// Writes contacts by ascending shellIndex, p and n in V (metres), so that equal inputs replay
  /// bit for bit. Real-time safe: no allocation, lock, exception or log.
  /// @param X_VT  tool pose in the voxel frame: p_V = X_VT * p_T.
  [[nodiscard]] QueryResult find(const Eigen::Isometry3d& X_VT, std::span<Contact> out) noexcept;

  /// The same query, its contacts left side by side in packed() and in the order of the shell's
  /// hierarchy: what a step costs where nobody needs more than index, depth and normal. Flags are
  /// not told apart there: depths beyond 16 smallest spacings are saturated.
  [[nodiscard]] QueryResult findPacked(const Eigen::Isometry3d& X_VT) noexcept;
  /// Of the last findPacked(); overwritten by the next query.
  [[nodiscard]] const PackedContacts& packed() const noexcept;

 private:
  struct Scratch;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace palpate
