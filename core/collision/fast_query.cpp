#include "core/collision/fast_query.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/collision/fast_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/collision/lanes-inl.h"
#include "core/collision/pack-inl.h"
#include "core/collision/point_pass-inl.h"
#include "core/collision/sphere_pass-inl.h"

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {

// Runs of whole batches, one a thread. A thread that does two in succession writes them in
// succession, so that nothing moves where the caller has done all.
struct LeafRuns {
  static constexpr std::size_t kMost = QueryWorkers::kMaxThreads;
  struct Run {
    std::size_t place, found;  // in the packed contacts
  };
  struct Done {
    std::size_t runs, end;  // up to which run this thread has done its last ones; their end
  };
  const FastWork& work;
  const Frame& frame;
  PackedContacts& out;
  std::size_t leaves, count;
  Run run[kMost];
  Done done[kMost];

  [[nodiscard]] std::size_t begin(std::size_t r) const {
    const std::size_t batches = (leaves + kLeaves - 1) / kLeaves;
    return std::min(leaves, batches * r / count * kLeaves);
  }
};

void testRun(void* context, std::size_t r, std::size_t thread) noexcept {
  auto& all = *static_cast<LeafRuns*>(context);
  LeafRuns::Done& done = all.done[thread];
  const std::size_t first = all.begin(r);
  const std::size_t place = r > 0 && done.runs == r ? done.end : first * 16;
  PackedRun out(all.out, place);
  (void)testLeaves(all.work, all.frame, first, all.begin(r + 1), out);
  all.run[r] = {place, out.count};
  done = {r + 1, place + out.count};
}

void shareLeaves(const FastWork& work, const Frame& frame, std::size_t count, PackedContacts& out) {
  LeafRuns all{work, frame, out, count, work.workers->threads(), {}, {}};
  work.workers->run(&testRun, &all, all.count);
  for (std::size_t r = 0; r < all.count; ++r) {
    const auto [place, found] = all.run[r];
    if (place != out.count) movePacked(out, place, found, out.count);
    out.count += found;
  }
}

void findFastHere(FastWork& work, const CellPose& pose, bool everyPoint, PackedContacts& out) {
  const Frame frame(work, pose);
  out.count = 0;
  work.tests = 0;
  std::size_t count = work.shell->leaf.size();
  if (everyPoint) {
    for (std::size_t i = 0; i < count; ++i) work.frontier[i] = static_cast<std::uint32_t>(i);
  } else {
    count = work.nearby.wanted && work.shell->start > 0 ? descendNearby(work, frame)
                                                        : descend(work, frame, 0);
  }
  work.tests += static_cast<std::uint32_t>(count * 16);
  if (count == 0) return;
  std::fill_n(work.frontier.begin() + static_cast<std::ptrdiff_t>(count), kAhead, 0U);
  if (work.workers != nullptr &&
      count >= (work.workers->awake() ? kLeavesToShare : kLeavesToWake)) {
    shareLeaves(work, frame, count, out);
    return;
  }
  PackedRun all(out, 0);
  work.wideBefore = testLeaves(work, frame, 0, count, all);
  out.count = all.count;
}

const char* targetHere() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate {

HWY_EXPORT(findFastHere);
HWY_EXPORT(targetHere);

void FastWork::prepare(const DepthBricks& depth, const std::array<std::int32_t, 3>& cells,
                       const ShellBlocks& blocks, double unit) {
  bricks = &depth;
  shell = &blocks;
  for (std::size_t a = 0; a < 3; ++a) lastCell[a] = static_cast<float>(cells[a] - 1);
  depthLimit = static_cast<float>(kSaturationVoxels * unit);
  metresPerStep = metresPerStepOf(depth.palette, unit);
  // A whole vector may be stored past the last node, and leaves are asked for ahead.
  const std::size_t nodes = blocks.leaf.size() + 64;
  frontier.assign(nodes, 0);
  next.assign(nodes, 0);
  nearby.node.assign(nearby.wanted ? nodes : 0, 0);
  nearby.known = false;
}

// A point's move is at most that of the middle and that of the turn at the shell's reach. What the
// sums in single precision err by is in the radii's slack; the thousandth is for those of here.
bool NearbyNodes::hold(const CellPose& pose, const float edge[3], double reach) const noexcept {
  if (!known) return false;
  double move2 = 0.0;
  double turn2 = 0.0;
  for (int a = 0; a < 3; ++a) {
    const double t = static_cast<double>(edge[a]) * (double{pose.t[a]} - double{at.t[a]});
    move2 += t * t;
    for (int b = 0; b < 3; ++b) {
      const double m = static_cast<double>(edge[a]) * (double{pose.m[a][b]} - double{at.m[a][b]});
      turn2 += m * m;
    }
  }
  return std::sqrt(move2) + std::sqrt(turn2) * reach <= double{kMargin} - 1e-3;
}

void findFast(FastWork& work, const CellPose& pose, bool everyPoint, PackedContacts& out) noexcept {
  HWY_DYNAMIC_DISPATCH(findFastHere)(work, pose, everyPoint, out);
}

const char* fastQueryTarget() noexcept {
  return HWY_DYNAMIC_DISPATCH(targetHere)();
}

}  // namespace palpate
#endif
