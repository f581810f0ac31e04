#include "core/collision/contact_finder.h"

#include <algorithm>
#include <bit>
#include <cmath>

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
  const LeafTest<Bits> leaf(*work.tree);
  for (auto cut = begin; cut != end; ++cut) {
    if (cut != begin && cut->node == (cut - 1)->node) continue;
    double p[3];
    work.pose.apply(work.shell->x[cut->rank], work.shell->y[cut->rank], work.shell->z[cut->rank],
                    p);
    Item item;
    if (!leaf.locate(p, item)) continue;
    Contact& contact = work.hits[work.hitCount];
    leaf.evaluateCut(p, item, cut->node, work.stopLevel, contact);
    contact.shellIndex = cut->shellIndex;
    contact.body = 0;
    work.hitRank[work.hitCount++] = cut->rank;
  }
}

// Marks every hit in `present` and remembers where it is.
void indexHits(QueryWork& work) noexcept {
  for (std::size_t i = 0; i < work.hitCount; ++i) {
    const std::uint32_t index = work.hits[i].shellIndex;
    work.present[index >> 6] |= std::uint64_t{1} << (index & 63U);
    work.slotOf[index] = static_cast<std::uint32_t>(i);
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

// Ascending shell index, by walking the bits that indexHits set; clears them.
std::size_t writeInOrder(QueryWork& work, std::span<Contact> out) noexcept {
  std::size_t written = 0;
  for (std::size_t w = 0; w < work.present.size(); ++w) {
    std::uint64_t bits = work.present[w];
    if (bits == 0) continue;
    work.present[w] = 0;
    for (; bits != 0 && written < out.size(); bits &= bits - 1) {
      const std::size_t index = w * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      out[written++] = work.hits[work.slotOf[index]];
    }
  }
  return written;
}

template <int Bits>
void collect(QueryWork& work) noexcept {
  runMethod<Bits>(work);
  if (work.stopLevel > 0) resolveCuts<Bits>(work);
}

}  // namespace

struct ContactFinder::Scratch : QueryWork {
  double shellReach = 0.0;
};

ContactFinder::ContactFinder(const VoxelTree& tree, const PointShell& shell,
                             const QueryOptions& options)
    : scratch_(std::make_unique<Scratch>()) {
  Scratch& s = *scratch_;
  s.tree = &tree.data();
  s.shell = &shell.data().hierarchy;
  s.shellReach = shell.reach();
  s.options = options;
  s.stopLevel = std::clamp(options.stopLevel, 0, s.tree->levels);
  const std::size_t points = shell.size();
  s.hits.resize(points);
  s.hitRank.resize(points);
  s.slotOf.resize(points);
  s.present.assign((points + 63) / 64, 0);
  s.cuts.resize(points);
  const std::size_t groups = s.shell->level[0].size();
  if (options.method == QueryMethod::Hierarchy) {
    s.frontier.resize(groups + ShellHierarchy::kArity);
    s.nextFrontier.resize(groups + ShellHierarchy::kArity);
  }
  if (options.method == QueryMethod::Paper) {
    // Enough for a true breadth-first descent of common scenes; beyond it goes depth-first.
    const std::size_t pairs = std::clamp<std::size_t>(groups * 64, 1024, std::size_t{1} << 20);
    s.pairs.resize(pairs);
    s.nextPairs.resize(pairs);
  }
}

ContactFinder::ContactFinder(ContactFinder&&) noexcept = default;
ContactFinder::~ContactFinder() = default;

QueryResult ContactFinder::find(const Eigen::Isometry3d& X_VT, std::span<Contact> out) noexcept {
  QueryResult result;
  if (!isRigidPose(X_VT)) {
    result.status = QueryStatus::BadPose;
    return result;
  }
  Scratch& s = *scratch_;
  s.pose = QueryPose::of(X_VT);
  s.slack = slackFor(*s.tree, s.shellReach, s.pose);
  s.tests = 0;
  s.hitCount = 0;
  s.cutCount = 0;
  switch (s.tree->bits) {
    case 1:
      collect<1>(s);
      break;
    case 2:
      collect<2>(s);
      break;
    default:
      collect<3>(s);
      break;
  }
  if (s.hitCount > s.options.contactBudget) {
    thinToBudget(s);
    result.status = QueryStatus::BudgetSpent;
  }
  if (s.hitCount > out.size()) result.status = QueryStatus::OutputFull;
  if (s.hitCount > 0) {
    indexHits(s);
    result.contactCount = writeInOrder(s, out);
  }
  result.tests = s.tests;
  return result;
}

}  // namespace palpate
