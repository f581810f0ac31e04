// Per-target include guard, as Highway wants it.
#if defined(PALPATE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PALPATE_LANES_INL_H_
#undef PALPATE_LANES_INL_H_
#else
#define PALPATE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "core/collision/fast_query.h"

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using DU = hn::RebindToUnsigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;
using VU = hn::Vec<DU>;

struct Lane3 {
  VF x, y, z;
};
struct Cell3 {
  VI x, y, z;
};

HWY_INLINE VF mix(VF a, VF b, VF t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), t));
}

/// The world and the pose of one query, as the passes read them.
struct Frame {
  Frame(const FastWork& work, const CellPose& cellPose)
      : pose(cellPose),
        coarse(reinterpret_cast<const std::int32_t*>(work.bricks->coarse.data())),
        firstWord(work.bricks->firstWord.data()),
        words(reinterpret_cast<const std::int32_t*>(work.bricks->words.data())),
        slots(work.bricks->slots.data()),
        pairs(work.bricks->palette.pairTable()),
        steps(work.bricks->palette.stepsTable()),
        lowBytes(work.bricks->palette.lowBytes()),
        highBytes(work.bricks->palette.highBytes()),
        row(work.bricks->blocks[0]),
        layer(work.bricks->blocks[0] * work.bricks->blocks[1]) {
    for (std::size_t a = 0; a < 3; ++a) {
      lastCell[a] = work.lastCell[a];
      edge[a] = std::sqrt(work.bricks->palette.weight()[a]);
    }
  }
  /// From the shell's middle to cells of the grid: the sums of CellPose::apply.
  HWY_INLINE Lane3 apply(const float* x, const float* y, const float* z) const {
    const DF d;
    const VF px = hn::LoadU(d, x);
    const VF py = hn::LoadU(d, y);
    const VF pz = hn::LoadU(d, z);
    const auto axis = [&](int a) HWY_ATTR {
      return hn::Add(
          hn::Add(hn::Mul(hn::Set(d, pose.m[a][0]), px), hn::Mul(hn::Set(d, pose.m[a][1]), py)),
          hn::Add(hn::Mul(hn::Set(d, pose.m[a][2]), pz), hn::Set(d, pose.t[a])));
    };
    return {axis(0), axis(1), axis(2)};
  }
  /// Into the box of centres, which is closed.
  HWY_INLINE Lane3 clamp(const Lane3& u) const {
    const DF d;
    const auto one = [&](VF v, float last) HWY_ATTR {
      return hn::Min(hn::Max(v, hn::Zero(d)), hn::Set(d, last + 1.0f));
    };
    return {one(u.x, lastCell[0]), one(u.y, lastCell[1]), one(u.z, lastCell[2])};
  }
  /// The cells of clamped points; the far faces belong to the last ones.
  HWY_INLINE Cell3 cellOf(const Lane3& c) const {
    const DF d;
    const DI di;
    const auto one = [&](VF v, float last)
                         HWY_ATTR { return hn::ConvertTo(di, hn::Min(v, hn::Set(d, last))); };
    return {one(c.x, lastCell[0]), one(c.y, lastCell[1]), one(c.z, lastCell[2])};
  }
  HWY_INLINE VI coarseAt(const Cell3& i) const {
    const DI di;
    return hn::Add(hn::Add(hn::Mul(hn::ShiftRight<4>(i.z), hn::Set(di, layer)),
                           hn::Mul(hn::ShiftRight<4>(i.y), hn::Set(di, row))),
                   hn::ShiftRight<4>(i.x));
  }
  /// Number of the 4³ block in its 16³ one.
  static HWY_INLINE VI childOf(const Cell3& i) {
    const DI di;
    const VI mask = hn::Set(di, 12);
    return hn::Or(hn::And(hn::ShiftRight<2>(i.x), hn::Set(di, 3)),
                  hn::Or(hn::And(i.y, mask), hn::ShiftLeft<2>(hn::And(i.z, mask))));
  }

  const CellPose& pose;
  const std::int32_t* coarse;
  const std::uint32_t* firstWord;
  const std::int32_t* words;
  const std::uint32_t* slots;
  const std::uint32_t* pairs;
  const std::int16_t* steps;
  const std::uint8_t* lowBytes;
  const std::uint8_t* highBytes;
  std::int32_t row, layer;
  float lastCell[3];
  float edge[3];
};

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#endif
