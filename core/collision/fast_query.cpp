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

void findFastHere(FastWork& work, const CellPose& pose, bool everyPoint, PackedContacts& out) {
  const Frame frame(work, pose);
  out.count = 0;
  work.tests = 0;
  std::size_t count = work.shell->leaf.size();
  if (everyPoint) {
    for (std::size_t i = 0; i < count; ++i) work.frontier[i] = static_cast<std::uint32_t>(i);
  } else {
    count = descend(work, frame);
  }
  work.tests += static_cast<std::uint32_t>(count * 16);
  if (count == 0) return;
  std::fill_n(work.frontier.begin() + static_cast<std::ptrdiff_t>(count), kAhead, 0U);
  testLeaves(work, frame, count, out);
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
}

void findFast(FastWork& work, const CellPose& pose, bool everyPoint, PackedContacts& out) noexcept {
  HWY_DYNAMIC_DISPATCH(findFastHere)(work, pose, everyPoint, out);
}

const char* fastQueryTarget() noexcept {
  return HWY_DYNAMIC_DISPATCH(targetHere)();
}

}  // namespace palpate
#endif
