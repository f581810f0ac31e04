#include "core/collision/contact_finder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>

#include "core/collision/contact_budget.h"
#include "core/collision/query_work.h"
#include "core/collision/rigid_pose.h"

namespace palpate {
namespace {

// More than rounding can err in a transformed centre, wherever the pose is: a billionth of a voxel
// and 2^-40 of the lengths involved (a transform errs by a few 2^-53 of them).
double slackFor(const VoxelTree::Data& tree, double shellReach, const QueryPose& pose) noexcept {
  const double far =
      std::max({std::abs(pose.t[0]), std::abs(pose.t[1]), std::abs(pose.t[2])}) + shellReach;
  return 1e-9 * tree.geometry.spacing.minCoeff() + 0x1p-40 * far;
}

template <int Bits>
void runMethod(QueryWork& work) noexcept {
  switch (work.options.method) {
    case QueryMethod::Hierarchy:
      return runMasks<Bits>(work);
    case QueryMethod::Paper:
      return runPaper<Bits>(work);
    case QueryMethod::BruteForce:
      return runBruteForce<Bits>(work);
  }
}

// Where descent was stopped at a level: one contact a node, at its point of the lowest index.
template <int Bits>
void resolveCuts(QueryWork& work) noexcept {
  const auto begin = work.cuts.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(work.cutCount);
  std::sort(begin, end, [](const CutPoint& a, const CutPoint& b) {
    return a.node != b.node ? a.node < b.node : a.shellIndex < b.shellIndex;
  });
  LeafTest<Bits> leaf(*work.tree, work.memo);
  for (auto cut = begin; cut != end; ++cut) {
    if (cut != begin && cut->node == (cut - 1)->node) continue;
    const PlacedPoint point = work.place(cut->rank);
    Item item;
    if (!leaf.locate(point, item)) continue;
    Contact& contact = work.hits[work.hitCount];
    leaf.evaluateCut(point, item, cut->node, work.stopLevel, contact);
    contact.shellIndex = cut->shellIndex;
    contact.body = 0;
    work.hitRank[work.hitCount++] = cut->rank;
  }
}

// Distance leaves, whole: many points at a time.
bool isFast(const QueryWork& work) noexcept {
  return work.tree->options.leaf == LeafModel::Distance && !work.tree->options.surfaceOnly &&
         work.stopLevel == 0 && work.options.method != QueryMethod::Paper;
}

// What a packed contact is in full.
template <int Bits>
void unpack(const QueryWork& work, const LeafTest<Bits>& leaf, std::size_t i,
            Contact& contact) noexcept {
  const PackedContacts& packed = work.packed;
  const std::uint32_t index = packed.index[i];
  const float normal[3] = {packed.nx[i], packed.ny[i], packed.nz[i]};
  leaf.fillDistance(work.place(work.rankOf[index]), packed.depth[i], normal, contact);
  contact.shellIndex = index;
  contact.body = 0;
  contact.flags |= work.flagsOf(work.rankOf[index]);
  if (work.overBudget) contact.flags |= kContactApproximate;
}

// In the order of rank, by walking one bit a rank; the bits are left clear.
void pack(QueryWork& work) noexcept {
  PackedContacts& packed = work.packed;
  for (std::size_t i = 0; i < work.hitCount; ++i) {
    const std::uint32_t rank = work.hitRank[i];
    work.present[rank >> 6] |= std::uint64_t{1} << (rank & 63U);
    work.slotOf[rank] = static_cast<std::uint32_t>(i);
  }
  packed.count = 0;
  for (std::size_t w = 0; packed.count < work.hitCount; ++w) {
    for (std::uint64_t& bits = work.present[w]; bits != 0; bits &= bits - 1) {
      const auto rank = w * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      const Contact& c = work.hits[work.slotOf[rank]];
      packed.index[packed.count] = c.shellIndex;
      packed.depth[packed.count] = static_cast<float>(c.depth);
      packed.nx[packed.count] = static_cast<float>(c.n[0]);
      packed.ny[packed.count] = static_cast<float>(c.n[1]);
      packed.nz[packed.count] = static_cast<float>(c.n[2]);
      ++packed.count;
    }
  }
  work.hitCount = 0;
}

// Ascending shell index, by walking one bit a point; the bits are left clear. Contacts lie in
// `packed` or in `hits`, never in both.
template <int Bits>
std::size_t writeInOrder(QueryWork& work, std::span<Contact> out) noexcept {
  const std::size_t packed = work.packed.count;
  const std::size_t count = packed + work.hitCount;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = packed > 0 ? work.packed.index[i] : work.hits[i].shellIndex;
    work.present[index >> 6] |= std::uint64_t{1} << (index & 63U);
    work.slotOf[index] = static_cast<std::uint32_t>(i);
  }
  const LeafTest<Bits> leaf(*work.tree, work.memo);
  std::size_t written = 0;
  for (std::size_t w = 0; count > 0 && w < work.present.size(); ++w) {
    std::uint64_t bits = work.present[w];
    if (bits == 0) continue;
    work.present[w] = 0;
    for (; bits != 0 && written < out.size(); bits &= bits - 1) {
      const std::size_t slot =
          work.slotOf[w * 64 + static_cast<std::size_t>(std::countr_zero(bits))];
      if (packed > 0) {
        unpack<Bits>(work, leaf, slot, out[written++]);
      } else {
        out[written++] = work.hits[slot];
      }
    }
  }
  return written;
}

// Leaves the contacts in `packed` or in `hits`.
template <int Bits>
void collect(QueryWork& work) noexcept {
  work.hitCount = 0;
  work.cutCount = 0;
  work.packed.count = 0;
  if (isFast(work)) {
    findFast(work.fast, work.cellPose, work.options.method == QueryMethod::BruteForce, work.packed);
    work.tests = work.fast.tests;
  } else {
    work.tests = 0;
    runMethod<Bits>(work);
    if (work.stopLevel > 0) resolveCuts<Bits>(work);
  }
  work.overBudget = work.packed.count + work.hitCount > work.options.contactBudget;
}

void placeAt(QueryWork& work, const Eigen::Isometry3d& X_VT) noexcept {
  const Eigen::Vector3d& spacing = work.tree->geometry.spacing;
  work.pose = QueryPose::of(X_VT);
  work.cellPose = CellPose(X_VT, work.blocks->middle, work.blocks->reach, spacing);
  work.slack = slackFor(*work.tree, work.shellReach, work.pose);
  if (work.fast.shell != nullptr) {
    work.slack += static_cast<double>(work.cellPose.slack) * spacing.minCoeff();
  }
}

// Calls f for the tree's branching.
template <class F>
auto withBits(const VoxelTree::Data& tree, F&& f) noexcept {
  switch (tree.bits) {
    case 1:
      return f(std::integral_constant<int, 1>());
    case 2:
      return f(std::integral_constant<int, 2>());
    default:
      return f(std::integral_constant<int, 3>());
  }
}

}  // namespace

namespace {

// Sizes what a query of this shell needs. @param indices  of the whole shell.
void sizeFor(QueryWork& work, std::size_t indices) {
  const std::size_t points = work.shell->size();
  work.hits.resize(points);
  work.hitRank.resize(points);
  work.slotOf.resize(indices);
  work.present.assign((indices + 63) / 64, 0);
  work.cuts.resize(points);
  work.packed = PackedContacts(work.blocks->leaf.size() * 16);
  if (work.tree->options.leaf == LeafModel::Distance) {
    work.fast.nearby.wanted = work.options.coherence;
    work.fast.prepare(work.tree->depth, work.tree->extent, *work.blocks,
                      work.tree->geometry.spacing.minCoeff());
    work.rankOf.resize(indices);
    for (std::uint32_t rank = 0; rank < points; ++rank) {
      work.rankOf[work.shell->order[rank]] = rank;
    }
  }
  const std::size_t groups = work.shell->level[0].size();
  if (work.options.method == QueryMethod::Hierarchy && !isFast(work)) {
    work.frontier.resize(groups + ShellHierarchy::kArity);
    work.nextFrontier.resize(groups + ShellHierarchy::kArity);
  }
}

void useShell(QueryWork& work, const ThinnedShell& thinned) {
  work.thinned = &thinned;
  work.shell = &thinned.hierarchy;
  work.blocks = &thinned.blocks;
}

}  // namespace

struct ContactFinder::Scratch {
  std::shared_ptr<const ThinnedShell> felt;  // what the perceptual bound leaves
  std::vector<ThinnedShell> before;          // what the budget asks first
  std::unique_ptr<QueryWorkers> workers;
  std::vector<QueryWork> work;  // a shell each, in the order of asking; the last has all points
  QueryWork* answer = nullptr;  // of the last findPacked()

  void add(const QueryWork& like, const ThinnedShell* thinned, const PointShell& whole) {
    QueryWork& added = work.emplace_back(like);
    if (thinned != nullptr) useShell(added, *thinned);
    sizeFor(added, whole.size());
    added.fast.workers = workers.get();
    if (added.options.method != QueryMethod::Paper) return;
    const auto& body = whole.data().body;  // its own trees hold all its voxels
    preparePaper(added, body && added.thinned == nullptr ? &*body : nullptr);
  }

  // Up to the first shell with more contacts than the budget, or the last; the others' tests count.
  [[nodiscard]] QueryWork& query(const Eigen::Isometry3d& X_VT, QueryResult& result) noexcept {
    QueryWork* deciding = nullptr;
    for (QueryWork& next : work) {
      deciding = &next;
      placeAt(next, X_VT);
      withBits(*next.tree, [&](auto bits) { collect<bits>(next); });
      result.tests += next.tests;
      if (next.overBudget) break;
    }
    if (deciding->overBudget) {
      keepDeepest(*deciding);
      result.status = QueryStatus::BudgetSpent;
    } else if (felt) {
      result.status = QueryStatus::Approximate;
    }
    return *deciding;
  }
};

ContactFinder::ContactFinder(const VoxelTree& tree, const PointShell& shell,
                             const QueryOptions& options)
    : scratch_(std::make_unique<Scratch>()) {
  Scratch& s = *scratch_;
  QueryWork first;
  first.tree = &tree.data();
  first.options = options;
  first.stopLevel = std::clamp(options.stopLevel, 0, first.tree->levels);
  first.shell = &shell.data().hierarchy;
  first.blocks = &shell.data().blocks;
  first.shellReach = shell.reach();
  if (options.perceptualBound > 0.0) {
    s.felt = shell.data().thinned->toBound(*first.shell, *first.blocks, options.perceptualBound);
    if (s.felt->hierarchy.size() == shell.size()) s.felt.reset();  // no node is as small as that
    if (s.felt) useShell(first, *s.felt);
  }
  if (isFast(first) && options.threads > 1) {
    s.workers = std::make_unique<QueryWorkers>(options.threads);
  }
  s.before = shellsBefore(*first.shell, *first.blocks, options.contactBudget);
  s.work.reserve(s.before.size() + 1);
  for (const ThinnedShell& thinned : s.before) s.add(first, &thinned, shell);
  s.add(first, nullptr, shell);
  s.answer = &s.work.back();
}

ContactFinder::ContactFinder(ContactFinder&&) noexcept = default;
ContactFinder& ContactFinder::operator=(ContactFinder&&) noexcept = default;
ContactFinder::~ContactFinder() = default;

QueryResult ContactFinder::find(const Eigen::Isometry3d& X_VT, std::span<Contact> out) noexcept {
  QueryResult result;
  if (!isRigidPose(X_VT)) {
    result.status = QueryStatus::BadPose;
    return result;
  }
  QueryWork& work = scratch_->query(X_VT, result);
  if (work.packed.count + work.hitCount > out.size()) result.status = QueryStatus::OutputFull;
  withBits(*work.tree, [&](auto bits) { result.contactCount = writeInOrder<bits>(work, out); });
  return result;
}

QueryResult ContactFinder::findPacked(const Eigen::Isometry3d& X_VT) noexcept {
  Scratch& s = *scratch_;
  s.answer = &s.work.back();
  s.answer->packed.count = 0;
  QueryResult result;
  if (!isRigidPose(X_VT)) {
    result.status = QueryStatus::BadPose;
    return result;
  }
  s.answer = &s.query(X_VT, result);
  if (s.answer->hitCount > 0) pack(*s.answer);
  result.contactCount = s.answer->packed.count;
  return result;
}

const PackedContacts& ContactFinder::packed() const noexcept {
  return scratch_->answer->packed;
}

}  // namespace palpate
