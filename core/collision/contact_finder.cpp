#include "core/collision/contact_finder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <type_traits>

#include "core/collision/query_work.h"

namespace palpate {
namespace {

// How far R may be from a rotation. A pose off by this much moves a point a metre away from its
// rotation's axis by a micrometre.
constexpr double kRigidTolerance = 1e-6;

bool isRigidPose(const Eigen::Isometry3d& X) noexcept {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (!std::isfinite(X(i, j))) return false;
    }
  }
  double worst = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double dot = X(0, i) * X(0, j) + X(1, i) * X(1, j) + X(2, i) * X(2, j);
      worst = std::max(worst, std::abs(dot - (i == j ? 1.0 : 0.0)));
    }
  }
  const double det = X(0, 0) * (X(1, 1) * X(2, 2) - X(1, 2) * X(2, 1)) -
                     X(0, 1) * (X(1, 0) * X(2, 2) - X(1, 2) * X(2, 0)) +
                     X(0, 2) * (X(1, 0) * X(2, 1) - X(1, 1) * X(2, 0));
  return worst <= kRigidTolerance && det > 0.0;
}

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
      return runHierarchy<Bits>(work);
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

// Over budget: of every node of the shell's hierarchy, at the finest level that fits, only the
// deepest contact stays. `nextFrontier` holds the hits in the order of rank.
void thinToBudget(QueryWork& work) noexcept {
  auto& byRank = work.slotOf;  // free until the hits are indexed
  for (std::size_t i = 0; i < work.hitCount; ++i) byRank[i] = static_cast<std::uint32_t>(i);
  const auto begin = byRank.begin();
  const auto end = begin + static_cast<std::ptrdiff_t>(work.hitCount);
  std::sort(begin, end, [&work](std::uint32_t a, std::uint32_t b) {
    return work.hitRank[a] < work.hitRank[b];
  });
  std::size_t level = 0;
  for (; level + 1 < work.shell->level.size(); ++level) {
    const std::size_t points = ShellHierarchy::pointsPerNode(level);
    std::size_t groups = 0;
    for (auto i = begin; i != end; ++i) {
      groups += i == begin || work.hitRank[*i] / points != work.hitRank[*(i - 1)] / points ? 1 : 0;
    }
    if (groups <= work.options.contactBudget) break;
  }
  const std::size_t points = ShellHierarchy::pointsPerNode(level);
  const auto better = [&work](std::uint32_t a, std::uint32_t b) {
    const Contact& ca = work.hits[a];
    const Contact& cb = work.hits[b];
    return ca.depth != cb.depth ? ca.depth > cb.depth : ca.shellIndex < cb.shellIndex;
  };
  std::size_t kept = 0;
  for (auto i = begin; i != end;) {
    auto best = i;
    const std::size_t group = work.hitRank[*i] / points;
    for (; i != end && work.hitRank[*i] / points == group; ++i) {
      if (better(*i, *best)) best = i;
    }
    if (kept < work.options.contactBudget) work.cuts[kept++].rank = *best;
  }
  // The kept places in ascending order, so that moving hits forward overwrites none still needed.
  std::sort(work.cuts.begin(), work.cuts.begin() + static_cast<std::ptrdiff_t>(kept),
            [](const CutPoint& a, const CutPoint& b) { return a.rank < b.rank; });
  for (std::size_t i = 0; i < kept; ++i) {
    work.hits[i] = work.hits[work.cuts[i].rank];
    work.hits[i].flags |= kContactApproximate;
  }
  work.hitCount = kept;
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
}

template <int Bits>
void unpackAll(QueryWork& work) noexcept {
  const LeafTest<Bits> leaf(*work.tree, work.memo);
  for (std::size_t i = 0; i < work.packed.count; ++i) {
    unpack<Bits>(work, leaf, i, work.hits[i]);
    work.hitRank[i] = work.rankOf[work.packed.index[i]];
  }
  work.hitCount = work.packed.count;
  work.packed.count = 0;
}

void pack(QueryWork& work) noexcept {
  PackedContacts& packed = work.packed;
  packed.count = work.hitCount;
  for (std::size_t i = 0; i < work.hitCount; ++i) {
    const Contact& c = work.hits[i];
    packed.index[i] = c.shellIndex;
    packed.depth[i] = static_cast<float>(c.depth);
    packed.nx[i] = static_cast<float>(c.n[0]);
    packed.ny[i] = static_cast<float>(c.n[1]);
    packed.nz[i] = static_cast<float>(c.n[2]);
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
QueryStatus collect(QueryWork& work) noexcept {
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
  if (work.packed.count + work.hitCount <= work.options.contactBudget) {
    return work.thinned != nullptr ? QueryStatus::Approximate : QueryStatus::Complete;
  }
  if (work.packed.count > 0) unpackAll<Bits>(work);
  thinToBudget(work);
  return QueryStatus::BudgetSpent;
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

struct ContactFinder::Scratch : QueryWork {
  std::optional<ThinnedShell> felt;  // what the perceptual bound leaves
  std::unique_ptr<QueryWorkers> helpers;

  [[nodiscard]] bool placeAt(const Eigen::Isometry3d& X_VT) noexcept {
    if (!isRigidPose(X_VT)) return false;
    pose = QueryPose::of(X_VT);
    cellPose = CellPose(X_VT, blocks->middle, blocks->reach, tree->geometry.spacing);
    slack = slackFor(*tree, shellReach, pose);
    if (fast.shell != nullptr) {
      slack += static_cast<double>(cellPose.slack) * tree->geometry.spacing.minCoeff();
    }
    return true;
  }

  void useShell(const PointShell& whole) {
    const PointShell::Data& data = whole.data();
    shell = &data.hierarchy;
    blocks = &data.blocks;
    shellReach = whole.reach();
    if (!(options.perceptualBound > 0.0)) return;
    felt = thinToBound(data.hierarchy, data.blocks, options.perceptualBound);
    if (felt->hierarchy.size() == whole.size()) return;  // no node is as small as that
    thinned = &*felt;
    shell = &felt->hierarchy;
    blocks = &felt->blocks;
  }
};

namespace {

// `indices`: how many there are in the whole shell.
void sizeFor(QueryWork& work, std::size_t indices) {
  const std::size_t points = work.shell->size();
  work.hits.resize(points);
  work.hitRank.resize(points);
  work.slotOf.resize(indices);
  work.present.assign((indices + 63) / 64, 0);
  work.cuts.resize(points);
  work.packed = PackedContacts(work.blocks->leaf.size() * 16);
  if (work.tree->options.leaf == LeafModel::Distance) {
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

}  // namespace

ContactFinder::ContactFinder(const VoxelTree& tree, const PointShell& shell,
                             const QueryOptions& options)
    : scratch_(std::make_unique<Scratch>()) {
  Scratch& s = *scratch_;
  s.tree = &tree.data();
  s.options = options;
  s.stopLevel = std::clamp(options.stopLevel, 0, s.tree->levels);
  s.useShell(shell);
  sizeFor(s, shell.size());
  if (isFast(s) && options.threads > 1) {
    s.helpers = std::make_unique<QueryWorkers>(options.threads);
    s.fast.workers = s.helpers.get();
  }
  if (options.method == QueryMethod::Paper) {
    // A body's own trees hold all its voxels.
    const auto& body = shell.data().body;
    preparePaper(s, body && s.thinned == nullptr ? &*body : nullptr);
  }
}

ContactFinder::ContactFinder(ContactFinder&&) noexcept = default;
ContactFinder::~ContactFinder() = default;

QueryResult ContactFinder::find(const Eigen::Isometry3d& X_VT, std::span<Contact> out) noexcept {
  Scratch& s = *scratch_;
  QueryResult result;
  if (!s.placeAt(X_VT)) {
    result.status = QueryStatus::BadPose;
    return result;
  }
  withBits(*s.tree, [&](auto bits) {
    result.status = collect<bits>(s);
    if (s.packed.count + s.hitCount > out.size()) result.status = QueryStatus::OutputFull;
    result.contactCount = writeInOrder<bits>(s, out);
  });
  result.tests = s.tests;
  return result;
}

QueryResult ContactFinder::findPacked(const Eigen::Isometry3d& X_VT) noexcept {
  Scratch& s = *scratch_;
  QueryResult result;
  s.packed.count = 0;
  if (!s.placeAt(X_VT)) {
    result.status = QueryStatus::BadPose;
    return result;
  }
  withBits(*s.tree, [&](auto bits) { result.status = collect<bits>(s); });
  if (s.hitCount > 0) pack(s);
  result.contactCount = s.packed.count;
  result.tests = s.tests;
  return result;
}

const PackedContacts& ContactFinder::packed() const noexcept {
  return scratch_->packed;
}

}  // namespace palpate
