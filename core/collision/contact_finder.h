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

/// Exact options never change the contact set; stopLevel and budget trade (contacts are flagged).
struct QueryOptions {
  QueryMethod method = QueryMethod::Hierarchy;
  bool tightSpheres = true;
  bool oneChildSkip = true;
  bool sideOffset = false;
  int stopLevel = 0;                         ///< 0: down to the voxels.
  std::uint32_t contactBudget = 0xFFFFFFFF;  ///< More contacts than this: cut, and say so.
  /// Threads of a query, the caller included; beyond 64 are 64. Where distance leaves are read many
  /// points at a time and enough of them are live to pay for the hand-off (fast_query.h), the
  /// others help; elsewhere they sleep. Exact: the same contacts, order and bits at any number.
  /// They are started with the finder, and inherit scheduling and processors of the thread that
  /// makes it.
  int threads = 1;
};

enum class QueryStatus : std::uint8_t {
  Complete,
  OutputFull,   ///< Contacts are valid; more exist.
  BudgetSpent,  ///< Contacts are valid; some regions were not descended.
  BadPose,      ///< X_VT not finite or not rigid; nothing written.
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
