#include "core/collision/contact_budget.h"

#include <algorithm>
#include <numeric>
#include <span>

namespace palpate {
namespace {

// The two places where contacts may lie, by their slot there.
struct PackedView {
  QueryWork& work;
  [[nodiscard]] std::size_t count() const noexcept { return work.packed.count; }
  [[nodiscard]] std::uint32_t rank(std::uint32_t slot) const noexcept { return work.hitRank[slot]; }
  [[nodiscard]] double depth(std::uint32_t slot) const noexcept {
    return static_cast<double>(work.packed.depth[slot]);
  }
  [[nodiscard]] std::uint32_t index(std::uint32_t slot) const noexcept {
    return work.packed.index[slot];
  }
  void move(std::uint32_t from, std::size_t to) const noexcept {
    PackedContacts& packed = work.packed;
    packed.index[to] = packed.index[from];
    packed.depth[to] = packed.depth[from];
    packed.nx[to] = packed.nx[from];
    packed.ny[to] = packed.ny[from];
    packed.nz[to] = packed.nz[from];
  }
  void resize(std::size_t count) const noexcept { work.packed.count = count; }
};

struct HitView {
  QueryWork& work;
  [[nodiscard]] std::size_t count() const noexcept { return work.hitCount; }
  [[nodiscard]] std::uint32_t rank(std::uint32_t slot) const noexcept { return work.hitRank[slot]; }
  [[nodiscard]] double depth(std::uint32_t slot) const noexcept { return work.hits[slot].depth; }
  [[nodiscard]] std::uint32_t index(std::uint32_t slot) const noexcept {
    return work.hits[slot].shellIndex;
  }
  void move(std::uint32_t from, std::size_t to) const noexcept {
    work.hits[to] = work.hits[from];
    work.hitRank[to] = work.hitRank[from];
  }
  void resize(std::size_t count) const noexcept { work.hitCount = count; }
};

using Slots = std::span<std::uint32_t>;

// A rank shifted by this is the number of its node at a level.
int shiftOf(std::size_t level) noexcept {
  static_assert(ShellHierarchy::kGroup == 16 && ShellHierarchy::kArity == 16);
  return std::min(4 + 4 * static_cast<int>(level), 31);
}

// Nodes of a level that hold contacts. @param byRank  slots in the order of rank.
template <class View>
std::size_t nodesAt(const View& view, Slots byRank, std::size_t level) noexcept {
  const int shift = shiftOf(level);
  std::size_t nodes = 0;
  std::uint32_t last = ~0U;
  for (const std::uint32_t slot : byRank) {
    const std::uint32_t node = view.rank(slot) >> shift;
    nodes += node != last ? 1 : 0;
    last = node;
  }
  return nodes;
}

// Puts the deepest of each node to the front of byRank; returns how many there are.
template <class View>
std::size_t deepestOfNodes(const View& view, Slots byRank, std::size_t level) noexcept {
  const int shift = shiftOf(level);
  const auto deeper = [&view](std::uint32_t a, std::uint32_t b) {
    const double da = view.depth(a);
    const double db = view.depth(b);
    return da != db ? da > db : view.index(a) < view.index(b);
  };
  std::size_t kept = 0;
  for (std::size_t i = 0; i < byRank.size();) {
    std::uint32_t best = byRank[i];
    const std::uint32_t node = view.rank(best) >> shift;
    for (; i < byRank.size() && view.rank(byRank[i]) >> shift == node; ++i) {
      if (deeper(byRank[i], best)) best = byRank[i];
    }
    byRank[kept++] = best;
  }
  return kept;
}

template <class View>
void keepIn(const View& view, Slots byRank, const QueryWork& work) noexcept {
  const std::size_t budget = work.options.contactBudget;
  std::size_t level = 0;
  while (level + 1 < work.shell->level.size() && nodesAt(view, byRank, level) > budget) ++level;
  const std::size_t kept = std::min(deepestOfNodes(view, byRank, level), budget);
  // Ascending slots, so that moving contacts forward overwrites none still needed.
  const Slots stay = byRank.first(kept);
  std::sort(stay.begin(), stay.end());
  for (std::size_t i = 0; i < kept; ++i) view.move(stay[i], i);
  view.resize(kept);
}

}  // namespace

void keepDeepest(QueryWork& work) noexcept {
  const std::size_t count = work.packed.count + work.hitCount;
  const Slots byRank = Slots(work.slotOf).first(count);  // free until contacts are written out
  std::iota(byRank.begin(), byRank.end(), 0U);
  if (work.packed.count > 0) {
    for (std::size_t i = 0; i < count; ++i) work.hitRank[i] = work.rankOf[work.packed.index[i]];
    return keepIn(PackedView{work}, byRank, work);
  }
  const HitView hits{work};
  std::sort(byRank.begin(), byRank.end(),
            [&](std::uint32_t a, std::uint32_t b) { return hits.rank(a) < hits.rank(b); });
  keepIn(hits, byRank, work);
  for (std::size_t i = 0; i < work.hitCount; ++i) work.hits[i].flags |= kContactApproximate;
}

std::vector<ThinnedShell> shellsBefore(const ShellHierarchy& shell, const ShellBlocks& blocks,
                                       std::size_t budget) {
  std::vector<ThinnedShell> shells;
  for (std::size_t level = shell.level.size(); level-- > 0;) {
    if (shell.level[level].size() <= budget || shell.level[level].size() == shell.size()) continue;
    shells.push_back(thinToLevel(shell, blocks, level));
  }
  return shells;
}

}  // namespace palpate
