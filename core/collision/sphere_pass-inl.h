// Per-target include guard, as Highway wants it.
#if defined(PALPATE_SPHERE_PASS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PALPATE_SPHERE_PASS_INL_H_
#undef PALPATE_SPHERE_PASS_INL_H_
#else
#define PALPATE_SPHERE_PASS_INL_H_
#endif

#include <algorithm>
#include <utility>

#include "core/collision/lanes-inl.h"
#include "core/collision/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {

/// A lower bound of the distance from points of the box to the contact region, smallest spacings:
/// the word of the finest block that each lies in.
HWY_INLINE VF clearance(const Frame& frame, const Lane3& u) {
  const DF d;
  const DI di;
  const Cell3 i = frame.cellOf(u);
  VI w = hn::GatherIndex(di, frame.coarse, frame.coarseAt(i));
  VI inBlock = hn::Set(di, DepthBricks::kCoarseEdge - 1);
  VF unit = hn::Set(d, 1.0f / ClearanceWord::kCoarseSteps);
  const auto linked = hn::Lt(w, hn::Zero(di));  // the link bit is the sign
  if (!hn::AllFalse(di, linked)) {
    const VI at = hn::Add(hn::ShiftLeft<6>(w), Frame::childOf(i));
    w = hn::IfThenElse(linked, hn::GatherIndex(di, frame.words, hn::IfThenElseZero(linked, at)), w);
    inBlock = hn::IfThenElse(linked, hn::Set(di, DepthBricks::kEdge - 1), inBlock);
    unit = hn::IfThenElse(hn::RebindMask(d, linked), hn::Set(d, 1.0f / ClearanceWord::kBlockSteps),
                          unit);
    const auto brick = hn::Lt(w, hn::Zero(di));
    if (!hn::AllFalse(di, brick)) {
      const VI place = hn::And(w, hn::Set(di, static_cast<std::int32_t>(DepthBricks::kPlaceMask)));
      const VI own = hn::Add(hn::ShiftLeft<1>(place),
                             hn::Set(di, static_cast<std::int32_t>(DepthBricks::kRows)));
      const auto* slots = reinterpret_cast<const std::int32_t*>(frame.slots);
      w = hn::IfThenElse(brick, hn::GatherIndex(di, slots, hn::IfThenElseZero(brick, own)), w);
      unit = hn::IfThenElse(hn::RebindMask(d, brick), hn::Set(d, 1.0f / ClearanceWord::kBrickSteps),
                            unit);
    }
  }
  // b + g·(u − c), with c = (i & ~inBlock) + half an edge.
  const VF half = hn::Mul(hn::ConvertTo(d, hn::Add(inBlock, hn::Set(di, 1))), hn::Set(d, 0.5f));
  const auto from = [&](VF v, VI cell, int a) HWY_ATTR {
    const VF r = hn::Sub(v, hn::Add(hn::ConvertTo(d, hn::AndNot(inBlock, cell)), half));
    return hn::Mul(r, hn::Set(d, frame.edge[a]));
  };
  const auto slope = [&](VI bits) HWY_ATTR {
    return hn::ConvertTo(d, hn::Sub(hn::And(bits, hn::Set(di, ClearanceWord::kSlopeMask)),
                                    hn::Set(di, ClearanceWord::kSlopeBias)));
  };
  const VF g = hn::Add(
      hn::Add(hn::Mul(slope(w), from(u.x, i.x, 0)),
              hn::Mul(slope(hn::ShiftRight<ClearanceWord::kSlopeBits>(w)), from(u.y, i.y, 1))),
      hn::Mul(slope(hn::ShiftRight<2 * ClearanceWord::kSlopeBits>(w)), from(u.z, i.z, 2)));
  const VF b = hn::ConvertTo(d, hn::Sub(hn::ShiftRight<ClearanceWord::kBoundShift>(w),
                                        hn::Set(di, ClearanceWord::kBoundBias)));
  return hn::Add(hn::Mul(b, unit), hn::Mul(g, hn::Set(d, 1.0f / ClearanceWord::kSlopeSteps)));
}

/// Which of sixteen spheres may touch: their numbers, from `first` on, are written to `out`.
HWY_INLINE std::size_t testSpheres(const Frame& frame, const SphereBlock& block, std::size_t first,
                                   std::uint32_t* out) {
  const DF d;
  const DU du;
  std::size_t count = 0;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Lane3 u = frame.apply(block.x + l, block.y + l, block.z + l);
    const VF r = hn::Add(hn::Mul(hn::Load(d, block.r + l), hn::Set(d, frame.pose.perUnit)),
                         hn::Set(d, frame.pose.slack));
    // To the box of centres first: what lies outside it is farther by at least that much.
    const Lane3 c = frame.clamp(u);
    const VF sx = hn::Mul(hn::Sub(u.x, c.x), hn::Set(d, frame.edge[0]));
    const VF sy = hn::Mul(hn::Sub(u.y, c.y), hn::Set(d, frame.edge[1]));
    const VF sz = hn::Mul(hn::Sub(u.z, c.z), hn::Set(d, frame.edge[2]));
    const VF away2 = hn::Add(hn::Add(hn::Mul(sx, sx), hn::Mul(sy, sy)), hn::Mul(sz, sz));
    const VF r2 = hn::Mul(r, hn::Abs(r));  // negative where there is no sphere
    auto live = hn::Le(away2, r2);
    if (hn::AllFalse(d, live)) continue;
    const VF clear = hn::Max(clearance(frame, c), hn::Zero(d));
    live = hn::Le(hn::Add(away2, hn::Mul(clear, clear)), r2);
    const VU id = hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(first + l)));
    const Packer<DF> packer(live);
    packer.store(id, out + count);
    count += packer.count();
  }
  return count;
}

/// The children of `count` nodes of a level that may touch, to work.frontier; returns how many.
HWY_INLINE std::size_t testChildren(FastWork& work, const Frame& frame, std::size_t childLevel,
                                    const std::uint32_t* nodes, std::size_t count) {
  const std::vector<SphereBlock>& blocks = work.shell->level[childLevel];
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    next += testSpheres(frame, blocks[nodes[i]], nodes[i] * std::size_t{16}, &work.next[next]);
  }
  work.tests += static_cast<std::uint32_t>(count * 16);
  std::swap(work.frontier, work.next);
  return next;
}

/// Down the shell's hierarchy, level by level; leaves the live nodes of level `last` (at most that
/// where a descent begins) in work.frontier.
HWY_INLINE std::size_t descend(FastWork& work, const Frame& frame, std::size_t last) {
  const ShellBlocks& shell = *work.shell;
  std::size_t l = shell.start;
  std::size_t count = 0;
  for (std::size_t b = 0; b < shell.level[l].size(); ++b) {
    count += testSpheres(frame, shell.level[l][b], b * 16, work.frontier.data() + count);
  }
  work.tests += static_cast<std::uint32_t>(shell.count[l]);
  for (; l > last; --l) count = testChildren(work, frame, l - 1, work.frontier.data(), count);
  return count;
}

/// The same, from the nodes that were live around a past pose. Some of their leaves may be live
/// though a node further up is not: these hold no contact.
HWY_INLINE std::size_t descendNearby(FastWork& work, const Frame& frame) {
  NearbyNodes& nearby = work.nearby;
  if (!nearby.hold(frame.pose, frame.edge, work.shell->reach)) {
    CellPose wide = frame.pose;
    wide.slack += NearbyNodes::kMargin;
    nearby.count = descend(work, Frame(work, wide), 1);
    std::copy_n(work.frontier.begin(), nearby.count, nearby.node.begin());
    nearby.at = frame.pose;
    nearby.known = true;
  }
  return testChildren(work, frame, 0, nearby.node.data(), nearby.count);
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#endif
