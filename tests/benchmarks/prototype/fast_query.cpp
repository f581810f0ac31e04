#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

#include "tests/benchmarks/field_pose.h"
#include "tests/benchmarks/prototype/fast_world.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/prototype/fast_query.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tests/benchmarks/pack-inl.h"

#ifndef PALPATE_BENCH_FAST_QUERY_ONCE
#define PALPATE_BENCH_FAST_QUERY_ONCE
namespace palpate::bench {

struct FastWork {
  const FastWorld* world = nullptr;
  const ProbeTree* probe = nullptr;
  const LeafPoints* leaves = nullptr;
  bool everyPoint = false;
  std::vector<std::uint32_t> frontier, next;
  std::size_t tests = 0;
};

}  // namespace palpate::bench
#endif

HWY_BEFORE_NAMESPACE();
namespace palpate::bench {
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
struct Int3 {
  VI x, y, z;
};

HWY_INLINE VF mix(VF a, VF b, VF t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), t));
}

struct Frame {
  Frame(const FastWorld& w, const FieldPose& pose)
      : p(pose),
        top(reinterpret_cast<const std::int32_t*>(w.top.data())),
        words(reinterpret_cast<const std::int32_t*>(w.words.data())),
        fine(reinterpret_cast<const std::int32_t*>(w.fine.data())),
        codes(w.codes.data()),
        pairs(w.pairs.data()),
        topNode(w.topNode.data()),
        brickStart(w.brickStart.data()),
        topRow(w.topRow),
        topSlice(w.topSlice) {
    for (std::size_t a = 0; a < 3; ++a) {
      last[a] = static_cast<float>(w.dims[a] - 1);
      axis[a] = w.axis[a];
    }
  }
  HWY_INLINE Lane3 apply(const float* x, const float* y, const float* z) const {
    const DF d;
    const VF px = hn::LoadU(d, x);
    const VF py = hn::LoadU(d, y);
    const VF pz = hn::LoadU(d, z);
    const auto row = [&](int a) HWY_ATTR {
      return hn::Add(
          hn::Add(hn::Mul(hn::Set(d, p.m[a][0]), px), hn::Mul(hn::Set(d, p.m[a][1]), py)),
          hn::Add(hn::Mul(hn::Set(d, p.m[a][2]), pz), hn::Set(d, p.t[a])));
    };
    return {row(0), row(1), row(2)};
  }
  HWY_INLINE Lane3 clamp(const Lane3& u) const {
    const DF d;
    const auto one = [&](VF v, float top)
                         HWY_ATTR { return hn::Min(hn::Max(v, hn::Zero(d)), hn::Set(d, top)); };
    return {one(u.x, last[0]), one(u.y, last[1]), one(u.z, last[2])};
  }
  HWY_INLINE VI topOf(const Int3& i) const {
    const DI di;
    return hn::Add(hn::Add(hn::Mul(hn::ShiftRight<4>(i.z), hn::Set(di, topSlice)),
                           hn::Mul(hn::ShiftRight<4>(i.y), hn::Set(di, topRow))),
                   hn::ShiftRight<4>(i.x));
  }
  // Number of the 4³ block in its 16³ one.
  static HWY_INLINE VI childOf(const Int3& i) {
    const DI di;
    const VI mask = hn::Set(di, 12);
    return hn::Or(hn::And(hn::ShiftRight<2>(i.x), hn::Set(di, 3)),
                  hn::Or(hn::And(i.y, mask), hn::ShiftLeft<2>(hn::And(i.z, mask))));
  }

  const FieldPose& p;
  const std::int32_t* top;
  const std::int32_t* words;
  const std::int32_t* fine;
  const std::uint8_t* codes;
  const std::int32_t* pairs;
  const std::uint32_t* topNode;
  const std::uint32_t* brickStart;
  std::int32_t topRow, topSlice;
  float last[3];
  float axis[3];
};

// ---- spheres ----

HWY_INLINE VF clearance(const Frame& frame, const Lane3& u) {
  const DF d;
  const DI di;
  const Int3 i{hn::ConvertTo(di, u.x), hn::ConvertTo(di, u.y), hn::ConvertTo(di, u.z)};
  VI w = hn::GatherIndex(di, frame.top, frame.topOf(i));
  const auto linked = hn::Lt(w, hn::Zero(di));
  VI edgeMask = hn::Set(di, 15);
  VF unit = hn::Set(d, 16.0f / 64.0f);
  if (!hn::AllFalse(di, linked)) {
    const VI at = hn::Add(hn::ShiftLeft<6>(w), Frame::childOf(i));
    const VI below = hn::GatherIndex(di, frame.words, hn::IfThenElseZero(linked, at));
    w = hn::IfThenElse(linked, below, w);
    edgeMask = hn::IfThenElse(linked, hn::Set(di, 3), edgeMask);
    unit = hn::IfThenElse(hn::RebindMask(d, linked), hn::Set(d, 4.0f / 64.0f), unit);
    const auto brick = hn::Lt(w, hn::Zero(di));
    if (!hn::AllFalse(di, brick)) {
      VI at4 = hn::And(w, hn::Set(di, 0x7FFFFFFF));
      if constexpr (kFineSide == 2) {
        const VI two = hn::Set(di, 2);
        at4 = hn::Or(hn::ShiftLeft<3>(at4),
                     hn::Or(hn::And(hn::ShiftRight<1>(i.x), hn::Set(di, 1)),
                            hn::Or(hn::And(i.y, two), hn::ShiftLeft<1>(hn::And(i.z, two)))));
      }
      const VI f = hn::GatherIndex(di, frame.fine, hn::IfThenElseZero(brick, at4));
      w = hn::IfThenElse(brick, f, w);
      edgeMask = hn::IfThenElse(brick, hn::Set(di, kFineEdge - 1), edgeMask);
      const auto brickF = hn::RebindMask(d, brick);
      unit = hn::IfThenElse(brickF, hn::Set(d, 1.0f / kFineSteps), unit);
    }
  }
  // L = h b + g (u - c), with c = (i & ~edgeMask) + h/2
  const VF half = hn::Mul(hn::ConvertTo(d, hn::Add(edgeMask, hn::Set(di, 1))), hn::Set(d, 0.5f));
  const auto rel = [&](VF v, VI i0, int a) HWY_ATTR {
    const VF r = hn::Sub(v, hn::Add(hn::ConvertTo(d, hn::AndNot(edgeMask, i0)), half));
    return hn::Mul(r, hn::Set(d, frame.axis[a]));
  };
  const VI seven = hn::Set(di, 127);
  const VI bias = hn::Set(di, 64);
  const auto slope = [&](VI bits)
                         HWY_ATTR { return hn::ConvertTo(d, hn::Sub(hn::And(bits, seven), bias)); };
  const VF g = hn::Add(hn::Add(hn::Mul(slope(w), rel(u.x, i.x, 0)),
                               hn::Mul(slope(hn::ShiftRight<7>(w)), rel(u.y, i.y, 1))),
                       hn::Mul(slope(hn::ShiftRight<14>(w)), rel(u.z, i.z, 2)));
  const VF b = hn::ConvertTo(d, hn::Sub(hn::ShiftRight<21>(w), hn::Set(di, 512)));
  return hn::Add(hn::Mul(b, unit), hn::Mul(g, hn::Set(d, 1.0f / 63.0f)));
}

HWY_INLINE std::size_t testSpheres(const Frame& frame, const SphereBlock& block, std::size_t first,
                                   std::uint32_t* out) {
  const DF d;
  const DU du;
  std::size_t count = 0;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const std::size_t at = first + l;
    const Lane3 u = frame.apply(block.x + l, block.y + l, block.z + l);
    // What single precision may have lost of the centre, in voxels, is added to every radius.
    const VF r =
        hn::Add(hn::Mul(hn::Load(d, block.r + l), hn::Set(d, frame.p.perUnit)), hn::Set(d, 2e-3f));
    const Lane3 c = frame.clamp(u);
    const VF sx = hn::Mul(hn::Sub(u.x, c.x), hn::Set(d, frame.axis[0]));
    const VF sy = hn::Mul(hn::Sub(u.y, c.y), hn::Set(d, frame.axis[1]));
    const VF sz = hn::Mul(hn::Sub(u.z, c.z), hn::Set(d, frame.axis[2]));
    const VF away2 = hn::Add(hn::Add(hn::Mul(sx, sx), hn::Mul(sy, sy)), hn::Mul(sz, sz));
    const VF r2 = hn::Mul(r, hn::Abs(r));
    auto live = hn::Le(away2, r2);
    if (hn::AllFalse(d, live)) continue;
    const VF clear = hn::Max(clearance(frame, c), hn::Zero(d));
    live = hn::Le(hn::Add(away2, hn::Mul(clear, clear)), r2);
    const VU id = hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(at)));
    const Packer<DF> packer(live);
    packer.store(id, out + count);
    count += packer.count();
  }
  return count;
}

HWY_INLINE std::size_t descend(FastWork& work, const Frame& frame) {
  const ProbeTree& probe = *work.probe;
  std::size_t l = probe.start;
  std::size_t count = 0;
  for (std::size_t b = 0; b < probe.level[l].block.size(); ++b) {
    count += testSpheres(frame, probe.level[l].block[b], b * 16, work.frontier.data() + count);
  }
  work.tests += probe.level[l].count;
  while (l-- > 0) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t node = work.frontier[i];
      next += testSpheres(frame, probe.level[l].block[node], node * 16, work.next.data() + next);
    }
    work.tests += count * 16;
    std::swap(work.frontier, work.next);
    count = next;
  }
  work.tests += count * 16;
  return count;
}

// ---- points ----

constexpr std::size_t kBlock = 16;
constexpr std::size_t kAhead = 6;  // leaves between asking for one and reading it
struct alignas(64) Block {
  std::int32_t top[kBlock * 16];
  std::uint32_t child[kBlock * 16];
  std::uint32_t sample[kBlock * 16];  // in the brick
  std::int32_t wx[kBlock * 16];       // 16384 (1 - fx) | 16384 fx << 16
  float fy[kBlock * 16], fz[kBlock * 16], limit[kBlock * 16];
#if HWY_TARGET == HWY_AVX3_DL
  std::uint32_t wide[kBlock * 16];     // all ones for points in wide bricks
  std::uint8_t raw[kBlock * 16][32];   // from the cell's lower corner to its upper one
  std::uint8_t high[kBlock * 16][32];  // of wide bricks: the same of the next brick
#else
  std::int32_t depths[4][kBlock * 16];  // two a row
#endif
};

HWY_INLINE void address(const Frame& frame, const LeafPoints& leaf, std::size_t slot,
                        Block& block) {
  const DF d;
  const DI di;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Lane3 u = frame.apply(leaf.x + l, leaf.y + l, leaf.z + l);
    const Lane3 c = frame.clamp(u);
    const Int3 i{hn::ConvertTo(di, c.x), hn::ConvertTo(di, c.y), hn::ConvertTo(di, c.z)};
    const VI three = hn::Set(di, 3);
    const VI y = hn::And(i.y, three);
    const VI z = hn::And(i.z, three);
    const VI yz = hn::Add(y, hn::Add(z, hn::ShiftLeft<2>(z)));  // y + 5 z
    const VI local = hn::Add(hn::And(i.x, three), hn::Add(yz, hn::ShiftLeft<2>(yz)));
    hn::Store(frame.topOf(i), di, block.top + slot + l);
    hn::Store(hn::BitCast(DU(), Frame::childOf(i)), DU(), block.child + slot + l);
    hn::Store(hn::BitCast(DU(), local), DU(), block.sample + slot + l);
    const VF fx = hn::Sub(c.x, hn::ConvertTo(d, i.x));
    const VI q = hn::ConvertTo(di, hn::Add(hn::Mul(fx, hn::Set(d, 16384.0f)), hn::Set(d, 0.5f)));
    hn::Store(hn::Add(hn::Sub(hn::Set(di, 16384), q), hn::ShiftLeft<16>(q)), di,
              block.wx + slot + l);
    hn::Store(hn::Sub(c.y, hn::ConvertTo(d, i.y)), d, block.fy + slot + l);
    hn::Store(hn::Sub(c.z, hn::ConvertTo(d, i.z)), d, block.fz + slot + l);
    const auto in = hn::And(hn::And(hn::Eq(u.x, c.x), hn::Eq(u.y, c.y)), hn::Eq(u.z, c.z));
    hn::Store(hn::IfThenElse(in, hn::Zero(d), hn::Set(d, -1e30f)), d, block.limit + slot + l);
  }
}

// Gathers of the vector unit are no faster than this on any machine we measured.
// A point's cell in its brick: rows at these bytes, two codes each.
inline constexpr std::size_t kRow[4] = {0, 5, 25, 30};

template <bool kAnyWide>
HWY_INLINE void fetch(const Frame& frame, std::size_t count, Block& block) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t node = frame.topNode[block.top[i]];
    const std::uint32_t link = frame.brickStart[node + block.child[i]];
    const std::size_t brick = kAnyWide ? link & ~kWide : link;
    const std::uint8_t* from = frame.codes + brick * kBrickBytes + block.sample[i];
#if HWY_TARGET == HWY_AVX3_DL
    std::memcpy(block.raw[i], from, 32);
    if constexpr (kAnyWide) {
      const std::size_t wide = link >> 31;
      std::memcpy(block.high[i], from + wide * kBrickBytes, 32);
      block.wide[i] = 0U - static_cast<std::uint32_t>(wide);
    }
#else
    for (std::size_t k = 0; k < 4; ++k) {
      std::uint16_t pair = 0;
      std::memcpy(&pair, from + kRow[k], 2);
      block.depths[k][i] = frame.pairs[pair];
    }
    if (kAnyWide && link >> 31 != 0) {
      for (std::size_t k = 0; k < 4; ++k) {
        const std::uint8_t* low = from + kRow[k];
        const std::uint8_t* high = low + kBrickBytes;
        block.depths[k][i] = static_cast<std::int32_t>(
            low[0] | static_cast<std::uint32_t>(high[0]) << 8 |
            static_cast<std::uint32_t>(low[1]) << 16 | static_cast<std::uint32_t>(high[1]) << 24);
      }
    }
#endif
  }
}

// The pair of values along x at four rows: 16-bit numbers, low half first.
struct Rows {
  VI v[4];
};

#if HWY_TARGET == HWY_AVX3_DL
struct Palette {
  explicit Palette(const FastWorld& w) {
    for (int i = 0; i < 4; ++i) {
      low[i] = _mm512_load_si512(w.low.data() + 64 * i);
      high[i] = _mm512_load_si512(w.high.data() + 64 * i);
    }
    pick = _mm512_load_si512(w.pick.data());
  }
  static HWY_INLINE __m512i look(const __m512i* t, __m512i code, __mmask64 upper) {
    return _mm512_mask_blend_epi8(upper, _mm512_permutex2var_epi8(t[0], code, t[1]),
                                  _mm512_permutex2var_epi8(t[2], code, t[3]));
  }
  // Depths of 16 points at two rows each, from a word of four codes a point.
  static HWY_INLINE void spread(__m512i lo, __m512i hi, VI& r0, VI& r1) {
    const __m512 a = _mm512_castsi512_ps(_mm512_unpacklo_epi8(lo, hi));
    const __m512 b = _mm512_castsi512_ps(_mm512_unpackhi_epi8(lo, hi));
    r0 = VI{_mm512_castps_si512(_mm512_shuffle_ps(a, b, 0x88))};
    r1 = VI{_mm512_castps_si512(_mm512_shuffle_ps(a, b, 0xDD))};
  }
  // The eight codes of each point: those at z, and those at z+1.
  HWY_INLINE void pickCodes(const std::uint8_t (*raw)[32], __m512i& z0, __m512i& z1) const {
    const auto four = [&](int i) HWY_ATTR {
      return _mm512_permutex2var_epi8(_mm512_load_si512(raw[i]), pick,
                                      _mm512_load_si512(raw[i + 2]));
    };
    const __m512i a = _mm512_inserti64x4(four(0), _mm512_castsi512_si256(four(4)), 1);
    const __m512i b = _mm512_inserti64x4(four(8), _mm512_castsi512_si256(four(12)), 1);
    z0 = _mm512_shuffle_i64x2(a, b, 0x88);
    z1 = _mm512_shuffle_i64x2(a, b, 0xDD);
  }
  template <bool kAnyWide>
  HWY_INLINE Rows rows(const Block& block, std::size_t at) const {
    __m512i code[2];
    pickCodes(block.raw + at, code[0], code[1]);
    __m512i highCode[2];
    __mmask16 wide = 0;
    if constexpr (kAnyWide) {
      pickCodes(block.high + at, highCode[0], highCode[1]);
      wide = _mm512_movepi32_mask(_mm512_load_si512(block.wide + at));
    }
    Rows r;
    for (int z = 0; z < 2; ++z) {
      const __mmask64 upper = _mm512_movepi8_mask(code[z]);
      __m512i lo = look(low, code[z], upper);
      __m512i hi = look(high, code[z], upper);
      if constexpr (kAnyWide) {
        lo = _mm512_mask_blend_epi32(wide, lo, code[z]);
        hi = _mm512_mask_blend_epi32(wide, hi, highCode[z]);
      }
      spread(lo, hi, r.v[2 * z], r.v[2 * z + 1]);
    }
    return r;
  }
  __m512i low[4], high[4], pick;
};
HWY_INLINE VI dot(VI pair, VI weights) {
  return VI{_mm512_madd_epi16(pair.raw, weights.raw)};
}
#else
struct Palette {
  explicit Palette(const FastWorld& /*w*/) {}
  template <bool kAnyWide>
  HWY_INLINE Rows rows(const Block& block, std::size_t at) const {
    const DI di;
    return {{hn::Load(di, block.depths[0] + at), hn::Load(di, block.depths[1] + at),
             hn::Load(di, block.depths[2] + at), hn::Load(di, block.depths[3] + at)}};
  }
};
HWY_INLINE VI dot(VI pair, VI weights) {
  const auto low = [](VI v) HWY_ATTR { return hn::ShiftRight<16>(hn::ShiftLeft<16>(v)); };
  return hn::Add(hn::Mul(low(pair), low(weights)),
                 hn::Mul(hn::ShiftRight<16>(pair), hn::ShiftRight<16>(weights)));
}
#endif

template <bool kAnyWide>
HWY_INLINE void evaluate(const Palette& palette, const LeafPoints& leaf, const Block& block,
                         std::size_t slot, ContactList& out) {
  const DF d;
  const DI di;
  const DU du;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Rows rows = palette.rows<kAnyWide>(block, slot + l);
    const VI wx = hn::Load(di, block.wx + slot + l);
    const VF fy = hn::Load(d, block.fy + slot + l);
    const VF fz = hn::Load(d, block.fz + slot + l);
    const VF r0 = hn::ConvertTo(d, dot(rows.v[0], wx));
    const VF r1 = hn::ConvertTo(d, dot(rows.v[1], wx));
    const VF r2 = hn::ConvertTo(d, dot(rows.v[2], wx));
    const VF r3 = hn::ConvertTo(d, dot(rows.v[3], wx));
    const VF s0 = mix(r0, r1, fy);
    const VF s1 = mix(r2, r3, fy);
    const VF value = mix(s0, s1, fz);
    const auto hit = hn::Lt(value, hn::Load(d, block.limit + slot + l));
    if (hn::AllFalse(d, hit)) continue;
    const VI step = hn::Set(di, (1 << 16) | 0xFFFF);  // -1, +1
    const VF x0 = hn::ConvertTo(d, dot(rows.v[0], step));
    const VF x1 = hn::ConvertTo(d, dot(rows.v[1], step));
    const VF x2 = hn::ConvertTo(d, dot(rows.v[2], step));
    const VF x3 = hn::ConvertTo(d, dot(rows.v[3], step));
    const VF gx = hn::Mul(mix(mix(x0, x1, fy), mix(x2, x3, fy), fz), hn::Set(d, 16384.0f));
    const VF gy = mix(hn::Sub(r1, r0), hn::Sub(r3, r2), fz);
    const VF gz = hn::Sub(s1, s0);
    const std::size_t n = out.count;
    const Packer<DF> packer(hit);
    packer.store(hn::Load(du, leaf.index + l), &out.index[n]);
    packer.store(hn::Mul(value, hn::Set(d, -1.0f / (2048.0f * 16384.0f))), &out.depth[n]);
    packer.store(gx, &out.nx[n]);
    packer.store(gy, &out.ny[n]);
    packer.store(gz, &out.nz[n]);
    out.count = n + packer.count();
  }
}

HWY_INLINE void normalise(const Frame& frame, std::size_t from, ContactList& out) {
  const DF d;
  for (std::size_t i = from; i < out.count; i += hn::Lanes(d)) {
    // Slopes along the grid to slopes in space.
    const VF x = hn::Mul(hn::LoadU(d, &out.nx[i]), hn::Set(d, 1.0f / frame.axis[0]));
    const VF y = hn::Mul(hn::LoadU(d, &out.ny[i]), hn::Set(d, 1.0f / frame.axis[1]));
    const VF z = hn::Mul(hn::LoadU(d, &out.nz[i]), hn::Set(d, 1.0f / frame.axis[2]));
    const VF length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const VF scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(length2, hn::Set(d, 1e-30f))));
    hn::StoreU(hn::Mul(x, scale), d, &out.nx[i]);
    hn::StoreU(hn::Mul(y, scale), d, &out.ny[i]);
    hn::StoreU(hn::Mul(z, scale), d, &out.nz[i]);
  }
}

template <bool kAnyWide>
HWY_INLINE void testLeaves(const FastWork& work, const Frame& frame, std::size_t count,
                           ContactList& out) {
  const Palette palette(*work.world);
  Block block;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t n = std::min(kBlock, count - first);
    const std::size_t from = out.count;
    for (std::size_t i = 0; i < n; ++i) {
      const auto* soon =
          reinterpret_cast<const char*>(&work.leaves[work.frontier[first + i + kAhead]]);
      for (int line = 0; line < 4; ++line) __builtin_prefetch(soon + 64 * line);
      address(frame, work.leaves[work.frontier[first + i]], i * 16, block);
    }
    fetch<kAnyWide>(frame, n * 16, block);
    for (std::size_t i = 0; i < n; ++i) {
      evaluate<kAnyWide>(palette, work.leaves[work.frontier[first + i]], block, i * 16, out);
    }
    normalise(frame, from, out);
  }
}

void findFast(FastWork& work, const FieldPose& pose, ContactList& out) {
  const Frame frame(*work.world, pose);
  out.count = 0;
  work.tests = 0;
  std::size_t count = work.probe->leaf.size();
  if (work.everyPoint) {
    for (std::size_t i = 0; i < count; ++i) work.frontier[i] = static_cast<std::uint32_t>(i);
  } else {
    count = descend(work, frame);
  }
  if (count == 0) return;
  std::fill_n(work.frontier.begin() + static_cast<std::ptrdiff_t>(count), kAhead, 0U);
  if (work.world->wideBricks > 0) {
    testLeaves<true>(work, frame, count, out);
  } else {
    testLeaves<false>(work, frame, count, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::bench {
namespace {

HWY_EXPORT(findFast);

class FastPeer : public Peer {
 public:
  FastPeer(const FastWorld& world, const ProbeTree& probe, bool everyPoint) {
    work_.everyPoint = everyPoint;
    work_.world = &world;
    work_.probe = &probe;
    const std::size_t nodes = probe.level.front().x.size() + 64;
    work_.leaves = probe.leaf.data();
    work_.frontier.resize(nodes);
    work_.next.resize(nodes);
  }
  [[nodiscard]] std::string name() const override {
    return work_.everyPoint ? "prototype, every point" : "prototype";
  }
  [[nodiscard]] std::size_t worldBytes() const override { return work_.world->bytes(); }
  [[nodiscard]] std::size_t tests() const override { return work_.tests; }
  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    HWY_DYNAMIC_DISPATCH(findFast)
    (work_, FieldPose(X_VT, work_.world->spacing, work_.world->unit), out);
  }

 private:
  FastWork work_;
};

}  // namespace

std::unique_ptr<Peer> makePrototype(const FastWorld& world, const ProbeTree& probe,
                                    bool everyPoint) {
  return std::make_unique<FastPeer>(world, probe, everyPoint);
}

}  // namespace palpate::bench
#endif
