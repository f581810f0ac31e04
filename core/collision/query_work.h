#pragma once
/// What one query reads and writes, shared by the methods of ContactFinder. Internal.
///
/// A method's job is to find which points may touch and to call `PointSink::offer` for each of
/// them once; the leaf test there decides. Everything is sized when the finder is made.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/collision/contact_finder.h"
#include "core/collision/fast_query.h"
#include "core/collision/leaf_test.h"
#include "core/collision/paper_work.h"
#include "core/collision/shell_hierarchy.h"
#include "core/collision/thinned_shell.h"
#include "core/voxels/voxel_tree_data.h"

namespace palpate {

/// A shell point in a node where descent was cut.
struct CutPoint {
  std::uint32_t node = 0;
  std::uint32_t shellIndex = 0;
  std::uint32_t rank = 0;
};

struct QueryWork {
  const VoxelTree::Data* tree = nullptr;
  const ShellHierarchy* shell = nullptr;  ///< Of the whole shell, or of what stands for it.
  const ShellBlocks* blocks = nullptr;    ///< The same.
  const ThinnedShell* thinned = nullptr;  ///< None: the whole shell.
  double shellReach = 0.0;                ///< Of the points from the tool's origin, metres.
  QueryOptions options;
  int stopLevel = 0;  ///< Of the options, within the tree.

  QueryPose pose;
  CellPose cellPose;
  double slack = 0.0;  ///< Metres added to every radius: more than rounding can err at this pose.
  std::uint32_t tests = 0;
  bool overBudget = false;  ///< More contacts were found than the options' budget.

  std::vector<Contact> hits;  ///< In the order of discovery.
  std::vector<std::uint32_t> hitRank;
  std::size_t hitCount = 0;
  std::vector<CutPoint> cuts;
  std::size_t cutCount = 0;

  std::vector<std::uint32_t> frontier, nextFrontier;  ///< mask_query: nodes of a shell level.
  PaperWork paper;
  FastWork fast;  ///< Distance leaves, many points at a time.
  PackedContacts packed;
  std::vector<std::uint32_t> rankOf;  ///< Shell index -> rank; distance leaves.
  VoxelMemo memo;

  std::vector<std::uint64_t> present;  ///< One bit a shell index.
  std::vector<std::uint32_t> slotOf;   ///< Shell index -> place in hits or packed.

  /// What a contact of this point says besides the leaf model's flags.
  [[nodiscard]] std::uint8_t flagsOf(std::uint32_t rank) const noexcept {
    const bool more = thinned != nullptr && thinned->standsForMore[rank] != 0;
    return more ? std::uint8_t{kContactApproximate} : std::uint8_t{0};
  }
  [[nodiscard]] PlacedPoint place(std::uint32_t rank) const noexcept {
    PlacedPoint point;
    pose.apply(shell->x[rank], shell->y[rank], shell->z[rank], point.p);
    if (fast.shell != nullptr) {
      const PointBlock& leaf = fast.shell->leaf[rank / 16];
      const std::size_t l = rank % 16;
      for (int a = 0; a < 3; ++a) {
        point.u[a] = cellPose.apply(a, leaf.x[l], leaf.y[l], leaf.z[l]);
      }
    }
    return point;
  }
};

/// Takes candidate points to the leaf test. One per query.
template <int Bits>
class PointSink {
 public:
  explicit PointSink(QueryWork& work) noexcept : work_(work), leaf_(*work.tree, work.memo) {}

  void offer(std::uint32_t rank) noexcept {
    const PlacedPoint point = work_.place(rank);
    ++work_.tests;
    if (work_.stopLevel > 0) return offerCut(rank, point);
    Contact& contact = work_.hits[work_.hitCount];
    if (!leaf_.evaluate(point, contact)) return;
    contact.shellIndex = work_.shell->order[rank];
    contact.body = 0;
    contact.flags |= work_.flagsOf(rank);
    work_.hitRank[work_.hitCount++] = rank;
  }
  /// The item that holds a point; false outside.
  [[nodiscard]] bool itemOf(std::uint32_t rank, Item& item) const noexcept {
    return leaf_.locate(work_.place(rank), item);
  }

 private:
  void offerCut(std::uint32_t rank, const PlacedPoint& point) noexcept {
    Item item;
    if (!leaf_.locate(point, item)) return;
    const std::uint32_t node = findNode<Bits>(*work_.tree, item, work_.stopLevel);
    if (node == kNoNode) return;
    work_.cuts[work_.cutCount++] = {node, work_.shell->order[rank], rank};
  }

  QueryWork& work_;
  LeafTest<Bits> leaf_;
};

template <int Bits>
void runBruteForce(QueryWork& work) noexcept;
template <int Bits>
void runMasks(QueryWork& work) noexcept;
/// Sizes the scratch of QueryMethod::Paper and computes its spheres; takes memory. Wants tree,
/// shell and options set. `body`: the trees of the shell's voxels, null where it has none.
void preparePaper(QueryWork& work, const VoxelBody* body);
template <int Bits>
void runPaper(QueryWork& work) noexcept;

}  // namespace palpate
