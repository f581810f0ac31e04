// Per-target include guard, as Highway wants it.
#if defined(PALPATE_POINT_PASS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PALPATE_POINT_PASS_INL_H_
#undef PALPATE_POINT_PASS_INL_H_
#else
#define PALPATE_POINT_PASS_INL_H_
#endif

#include <algorithm>

#include "core/collision/lanes-inl.h"
#include "core/collision/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace palpate {
namespace HWY_NAMESPACE {

// The points of some leaves at a time, in passes over memory that stays in the first cache: cells
// of all, then their codes by scalar loads (quicker than gathers on the machines measured), then
// the arithmetic.
constexpr std::size_t kLeaves = 16;
constexpr std::size_t kAhead = 6;  // leaves between asking for one and reading it

struct alignas(64) PointWork {
  std::int32_t coarse[kLeaves * 16];
  std::uint32_t child[kLeaves * 16];
  std::uint32_t row[kLeaves * 16];    // y + 5 z in the brick
  std::uint32_t shift[kLeaves * 16];  // of the codes at x in a row; see `select`
  std::int32_t wx[kLeaves * 16];      // weights of the two depths along x: low half, high half
  float fy[kLeaves * 16], fz[kLeaves * 16];
  float limit[kLeaves * 16];              // a value below this is a contact
  std::uint32_t depths[4][kLeaves * 16];  // of four rows, two a word: (y,z), (y+1,z), (y,z+1), ...
#if HWY_TARGET == HWY_AVX3_DL
  std::uint32_t rows[kLeaves * 16][4];  // words of four rows; points dealt out as `deal` says
  // Of batches with wide bricks: the same of the upper six bits; all ones for points in such.
  std::uint32_t upper[kLeaves * 16][4];
  std::uint32_t wide[kLeaves * 16];
#endif
};

#if HWY_TARGET == HWY_AVX3_DL
// At x = 0: the first code twice, the second twice; odd lanes are the upper half of 64 bits.
alignas(64) constexpr std::uint32_t kSelect[16] = {
    0x06060000, 0x26262020, 0x06060000, 0x26262020, 0x06060000, 0x26262020, 0x06060000, 0x26262020,
    0x06060000, 0x26262020, 0x06060000, 0x26262020, 0x06060000, 0x26262020, 0x06060000, 0x26262020};
#endif

HWY_INLINE void findCells(const Frame& frame, const PointBlock& leaf, std::size_t slot,
                          PointWork& work) {
  const DF d;
  const DI di;
  const DU du;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Lane3 u = frame.apply(leaf.x + l, leaf.y + l, leaf.z + l);
    const Lane3 c = frame.clamp(u);
    const Cell3 i = frame.cellOf(c);
    const VI three = hn::Set(di, 3);
    const VI z = hn::And(i.z, three);
    const VI row = hn::Add(hn::And(i.y, three), hn::Add(z, hn::ShiftLeft<2>(z)));
    const VI x = hn::And(i.x, three);
    hn::Store(frame.coarseAt(i), di, work.coarse + slot + l);
    hn::Store(hn::BitCast(du, Frame::childOf(i)), du, work.child + slot + l);
    hn::Store(hn::BitCast(du, row), du, work.row + slot + l);
#if HWY_TARGET == HWY_AVX3_DL
    // Where each byte of a lane's four begins in its 64 bits.
    const VI select = hn::Add(hn::Mul(x, hn::Set(di, 0x06060606)),
                              hn::Load(di, reinterpret_cast<const std::int32_t*>(kSelect)));
    hn::Store(hn::BitCast(du, select), du, work.shift + slot + l);
#else
    hn::Store(hn::BitCast(du, hn::Mul(x, hn::Set(di, 6))), du, work.shift + slot + l);
#endif
    const VF fx = hn::Sub(c.x, hn::ConvertTo(d, i.x));
    const VI q = hn::ConvertTo(
        di, hn::Add(hn::Mul(fx, hn::Set(d, static_cast<float>(kFractionOne))), hn::Set(d, 0.5f)));
    hn::Store(hn::Add(hn::Sub(hn::Set(di, kFractionOne), q), hn::ShiftLeft<16>(q)), di,
              work.wx + slot + l);
    hn::Store(hn::Sub(c.y, hn::ConvertTo(d, i.y)), d, work.fy + slot + l);
    hn::Store(hn::Sub(c.z, hn::ConvertTo(d, i.z)), d, work.fz + slot + l);
    // A point outside the box can't be in contact: its limit is below every value.
    const auto in = hn::And(hn::And(hn::Eq(u.x, c.x), hn::Eq(u.y, c.y)), hn::Eq(u.z, c.z));
    hn::Store(hn::IfThenElse(in, hn::Zero(d), hn::Set(d, -1e30f)), d, work.limit + slot + l);
  }
}

// Rows of a cell from its own on.
inline constexpr std::size_t kRow[4] = {0, 1, 5, 6};

// Two depths of a wide brick's row, from its words shifted to the first of the two.
inline std::uint32_t wideDepths(const Frame& frame, std::uint32_t low, std::uint32_t high) {
  const auto first = static_cast<std::uint16_t>(frame.steps[(low & 63U) | (high & 63U) << 6]);
  const auto second =
      static_cast<std::uint16_t>(frame.steps[(low >> 6 & 63U) | (high >> 6 & 63U) << 6]);
  return first | static_cast<std::uint32_t>(second) << 16;
}

#if HWY_TARGET == HWY_AVX3_DL
// Four rows of a point's cell, two and two of them neighbours.
HWY_INLINE void copyRows(const std::uint32_t* row, std::uint32_t* to) {
  // Rows are aligned as words only.
  const __m128d lower = _mm_castsi128_pd(_mm_loadu_si64(row));
  _mm_store_pd(reinterpret_cast<double*>(to),
               _mm_loadh_pd(lower, reinterpret_cast<const double*>(row + 5)));
}
#endif

// The link of a point's brick, 0 without a branch where there is none: the place of "nothing".
HWY_INLINE std::uint32_t linkOf(const Frame& frame, std::size_t i, const PointWork& work) {
  const std::int32_t word = frame.words[frame.firstWord[work.coarse[i]] + work.child[i]];
  return static_cast<std::uint32_t>(word & (word >> 31));
}

// Returns the link. `kUpper`: with the upper bits, of bricks that are wide.
template <bool kUpper>
HWY_INLINE std::uint32_t fetchPoint(const Frame& frame, std::size_t i,
                                    [[maybe_unused]] std::size_t deal, PointWork& work) {
  const std::uint32_t link = linkOf(frame, i, work);
  const std::uint32_t* row = frame.slots + DepthBricks::placeOf(link) + work.row[i];
#if HWY_TARGET == HWY_AVX3_DL
  copyRows(row, work.rows[deal]);
  if constexpr (kUpper) {
    const std::uint32_t wide = link / DepthBricks::kWide & 1U;
    copyRows(row + wide * DepthBricks::kSlotWords, work.upper[deal]);
    work.wide[i] = 0U - wide;
  }
#else
  const std::uint32_t x6 = work.shift[i];
  if ((link & DepthBricks::kWide) == 0) [[likely]] {
    for (std::size_t k = 0; k < 4; ++k) {
      work.depths[k][i] = frame.pairs[row[kRow[k]] >> x6 & 4095U];
    }
  } else {
    for (std::size_t k = 0; k < 4; ++k) {
      work.depths[k][i] =
          wideDepths(frame, row[kRow[k]] >> x6, row[kRow[k] + DepthBricks::kSlotWords] >> x6);
    }
  }
#endif
  return link;
}

constexpr std::size_t dealOf(std::size_t p) {
  return ((p & 3) << 2) + (p >> 2);
}

template <bool kUpper>
HWY_INLINE bool fetchBatch(const Frame& frame, std::size_t leaves, PointWork& work) {
  std::uint32_t links = 0;
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
#pragma GCC unroll 16
    for (std::size_t p = 0; p < 16; ++p) {
      links |= fetchPoint<kUpper>(frame, leaf * 16 + p, leaf * 16 + dealOf(p), work);
    }
  }
  return (links & DepthBricks::kWide) != 0;
}

// Returns whether any of the bricks is wide. The upper bits are fetched at once where the batch
// before had such bricks, else only when the first is found: a guess that costs time alone.
HWY_INLINE bool fetchDepths(const Frame& frame, std::size_t leaves, bool wideBefore,
                            PointWork& work) {
  if (wideBefore) return fetchBatch<true>(frame, leaves, work);
  return fetchBatch<false>(frame, leaves, work) && fetchBatch<true>(frame, leaves, work);
}

struct Rows {
  VI v[4];
};

#if HWY_TARGET == HWY_AVX3_DL
class Decoder {
 public:
  explicit Decoder(const Frame& frame)
      : frame_(frame), low_(frame.lowBytes), high_(frame.highBytes) {}

  template <bool kAnyWide>
  HWY_INLINE Rows rows(const PointWork& work, std::size_t at) const {
    const __m512i select = _mm512_load_si512(work.shift + at);
    __m512i row[4];
    turn(work.rows + at, row);
    Rows rows;
    for (int k = 0; k < 4; ++k) {
      row[k] = _mm512_multishift_epi64_epi8(select, row[k]);
      rows.v[k] = VI{narrow(row[k])};
    }
    if constexpr (kAnyWide) {
      const __mmask16 wide = _mm512_movepi32_mask(_mm512_load_si512(work.wide + at));
      if (wide != 0) replaceWide(work, at, wide, row, rows);
    }
    return rows;
  }

 private:
  static constexpr __mmask64 kUpperBytes = 0xAAAAAAAAAAAAAAAAULL;

  // Sixteen points: their words were dealt so that point 4l + j is in lane l of vector j; turned
  // by fours, vector k holds row k of all in order.
  static HWY_INLINE void turn(const std::uint32_t (*words)[4], __m512i* row) {
    const __m512i p0 = _mm512_load_si512(words[0]);
    const __m512i p1 = _mm512_load_si512(words[4]);
    const __m512i p2 = _mm512_load_si512(words[8]);
    const __m512i p3 = _mm512_load_si512(words[12]);
    const __m512i a = _mm512_unpacklo_epi32(p0, p1);
    const __m512i b = _mm512_unpacklo_epi32(p2, p3);
    const __m512i c = _mm512_unpackhi_epi32(p0, p1);
    const __m512i e = _mm512_unpackhi_epi32(p2, p3);
    row[0] = _mm512_unpacklo_epi64(a, b);
    row[1] = _mm512_unpackhi_epi64(a, b);
    row[2] = _mm512_unpacklo_epi64(c, e);
    row[3] = _mm512_unpackhi_epi64(c, e);
  }
  HWY_INLINE __m512i table(const std::uint8_t* bytes, int i) const {
    return _mm512_loadu_si512(bytes + 64 * i);
  }
  // The look-up reads six bits of each byte, so the codes need no masking.
  HWY_INLINE __m512i narrow(__m512i code) const {
    return _mm512_mask_permutexvar_epi8(_mm512_permutexvar_epi8(code, table(low_, 0)), kUpperBytes,
                                        code, table(high_, 0));
  }
  // Codes of seven bits in tables 2i and 2i + 1.
  HWY_INLINE __m512i pairOfTables(__m512i code, int i) const {
    const __m512i low = _mm512_permutex2var_epi8(table(low_, 2 * i), code, table(low_, 2 * i + 1));
    const __m512i high =
        _mm512_permutex2var_epi8(table(high_, 2 * i), code, table(high_, 2 * i + 1));
    return _mm512_mask_blend_epi8(kUpperBytes, low, high);
  }
  void replaceWide(const PointWork& work, std::size_t at, __mmask16 wide, const __m512i* lowCode,
                   Rows& rows) const {
    const __m512i select = _mm512_load_si512(work.shift + at);
    const __m512i six = _mm512_set1_epi8(63);
    __m512i row[4];
    turn(work.upper + at, row);
    __mmask16 beyond = 0;  // points with a code that the tables do not reach
    for (int k = 0; k < 4; ++k) {
      const __m512i upper = _mm512_and_si512(_mm512_multishift_epi64_epi8(select, row[k]), six);
      const __m512i lower = _mm512_and_si512(lowCode[k], six);
      const __m512i seventh = _mm512_and_si512(_mm512_slli_epi16(upper, 6), _mm512_set1_epi8(64));
      const __m512i code = _mm512_or_si512(lower, seventh);
      __m512i depth = pairOfTables(code, 0);
      depth = _mm512_mask_blend_epi8(_mm512_test_epi8_mask(upper, _mm512_set1_epi8(2)), depth,
                                     pairOfTables(code, 1));
      depth = _mm512_mask_blend_epi8(_mm512_test_epi8_mask(upper, _mm512_set1_epi8(4)), depth,
                                     pairOfTables(code, 2));
      rows.v[k] = VI{_mm512_mask_blend_epi32(wide, rows.v[k].raw, depth)};
      // Six tables: the upper bits are 0 to 5.
      const __mmask64 over = _mm512_cmpgt_epu8_mask(upper, _mm512_set1_epi8(5));
      beyond =
          static_cast<__mmask16>(beyond | _mm512_mask_test_epi32_mask(wide, _mm512_movm_epi8(over),
                                                                      _mm512_set1_epi32(-1)));
    }
    if (beyond != 0) [[unlikely]]
      replaceBeyond(work, at, beyond, rows);
  }
  // Unequal spacings have more depths than six tables: one point at a time.
  HWY_NOINLINE void replaceBeyond(const PointWork& work, std::size_t at, unsigned points,
                                  Rows& rows) const {
    alignas(64) std::uint32_t depth[4][16];
    for (int k = 0; k < 4; ++k) _mm512_store_si512(depth[k], rows.v[k].raw);
    for (unsigned left = points; left != 0; left &= left - 1) {
      const auto p = static_cast<std::size_t>(__builtin_ctz(left));
      const std::size_t deal = at + dealOf(p);
      const std::uint32_t x6 = work.shift[at + p] & 31U;
      for (std::size_t k = 0; k < 4; ++k) {
        depth[k][p] = wideDepths(frame_, work.rows[deal][k] >> x6, work.upper[deal][k] >> x6);
      }
    }
    for (int k = 0; k < 4; ++k) rows.v[k] = VI{_mm512_load_si512(depth[k])};
  }

  const Frame& frame_;
  const std::uint8_t* low_;
  const std::uint8_t* high_;
};
#else
class Decoder {
 public:
  explicit Decoder(const Frame& /*frame*/) {}
  template <bool kAnyWide>
  HWY_INLINE Rows rows(const PointWork& work, std::size_t at) const {
    const DU du;
    const DI di;
    return {{hn::BitCast(di, hn::Load(du, work.depths[0] + at)),
             hn::BitCast(di, hn::Load(du, work.depths[1] + at)),
             hn::BitCast(di, hn::Load(du, work.depths[2] + at)),
             hn::BitCast(di, hn::Load(du, work.depths[3] + at))}};
  }
};
#endif

// Low times low plus high times high half, of each lane.
HWY_INLINE VI dot(VI a, VI b) {
#if HWY_TARGET == HWY_AVX3_DL || HWY_TARGET == HWY_AVX3
  return VI{_mm512_madd_epi16(a.raw, b.raw)};
#elif HWY_TARGET == HWY_AVX2
  return VI{_mm256_madd_epi16(a.raw, b.raw)};
#else
  const auto low = [](VI v) HWY_ATTR { return hn::ShiftRight<16>(hn::ShiftLeft<16>(v)); };
  return hn::Add(hn::Mul(low(a), low(b)), hn::Mul(hn::ShiftRight<16>(a), hn::ShiftRight<16>(b)));
#endif
}

template <bool kAnyWide>
HWY_INLINE void evaluate(const Decoder& decode, const PointBlock& leaf, const PointWork& points,
                         std::size_t slot, const FastWork& work, PackedRun& out) {
  const DF d;
  const DI di;
  const DU du;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Rows rows = decode.rows<kAnyWide>(points, slot + l);
    const VI wx = hn::Load(di, points.wx + slot + l);
    const VF fy = hn::Load(d, points.fy + slot + l);
    const VF fz = hn::Load(d, points.fz + slot + l);
    const VF r0 = hn::ConvertTo(d, dot(rows.v[0], wx));
    const VF r1 = hn::ConvertTo(d, dot(rows.v[1], wx));
    const VF r2 = hn::ConvertTo(d, dot(rows.v[2], wx));
    const VF r3 = hn::ConvertTo(d, dot(rows.v[3], wx));
    const VF s0 = mix(r0, r1, fy);
    const VF s1 = mix(r2, r3, fy);
    const VF value = mix(s0, s1, fz);
    const auto hit = hn::Lt(value, hn::Load(d, points.limit + slot + l));
    if (hn::AllFalse(d, hit)) continue;
    const VI step = hn::Set(di, (1 << 16) | 0xFFFF);  // −1, +1
    const VF x0 = hn::ConvertTo(d, dot(rows.v[0], step));
    const VF x1 = hn::ConvertTo(d, dot(rows.v[1], step));
    const VF x2 = hn::ConvertTo(d, dot(rows.v[2], step));
    const VF x3 = hn::ConvertTo(d, dot(rows.v[3], step));
    const VF gx = hn::Mul(mix(mix(x0, x1, fy), mix(x2, x3, fy), fz),
                          hn::Set(d, static_cast<float>(kFractionOne)));
    const VF gy = mix(hn::Sub(r1, r0), hn::Sub(r3, r2), fz);
    const VF gz = hn::Sub(s1, s0);
    const std::size_t n = out.count;
    const Packer<DF> packer(hit);
    packer.store(hn::Load(du, leaf.index + l), &out.index[n]);
    packer.store(
        hn::Min(hn::Mul(value, hn::Set(d, -work.metresPerStep)), hn::Set(d, work.depthLimit)),
        &out.depth[n]);
    packer.store(gx, &out.nx[n]);
    packer.store(gy, &out.ny[n]);
    packer.store(gz, &out.nz[n]);
    out.count = n + packer.count();
  }
}

// Gradients in cells, of the contacts from `from` on, to unit normals in space. A gradient this
// short is a balance of sides: +z.
HWY_INLINE void normalise(const Frame& frame, std::size_t from, PackedRun& out) {
  const DF d;
  for (std::size_t i = from; i < out.count; i += hn::Lanes(d)) {
    const VF x = hn::Mul(hn::LoadU(d, &out.nx[i]), hn::Set(d, 1.0f / frame.edge[0]));
    const VF y = hn::Mul(hn::LoadU(d, &out.ny[i]), hn::Set(d, 1.0f / frame.edge[1]));
    const VF z = hn::Mul(hn::LoadU(d, &out.nz[i]), hn::Set(d, 1.0f / frame.edge[2]));
    const VF length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const auto some = hn::Gt(length2, hn::Set(d, 1.0f));
    const VF scale =
        hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::IfThenElse(some, length2, hn::Set(d, 1.0f))));
    hn::StoreU(hn::IfThenElseZero(some, hn::Mul(x, scale)), d, &out.nx[i]);
    hn::StoreU(hn::IfThenElseZero(some, hn::Mul(y, scale)), d, &out.ny[i]);
    hn::StoreU(hn::IfThenElse(some, hn::Mul(z, scale), hn::Set(d, 1.0f)), d, &out.nz[i]);
  }
}

/// The contacts of the points in leaves begin .. end − 1 of work.frontier. Nothing is stored beyond
/// 16 contacts a leaf: a vector stored for the lanes of a leaf begins at or before the room that
/// the leaves up to it have, less its own length.
/// Returns whether the last of them met wide bricks, which is the guess for the next.
HWY_INLINE bool testLeaves(const FastWork& work, const Frame& frame, std::size_t begin,
                           std::size_t end, PackedRun& out) {
  const Decoder decode(frame);
  const PointBlock* leaves = work.shell->leaf.data();
  PointWork points;
  bool wide = work.wideBefore;
  for (std::size_t first = begin; first < end; first += kLeaves) {
    const std::size_t n = std::min(kLeaves, end - first);
    const std::size_t from = out.count;
    for (std::size_t i = 0; i < n; ++i) {
      const auto* soon = reinterpret_cast<const char*>(&leaves[work.frontier[first + i + kAhead]]);
      for (std::size_t line = 0; line < sizeof(PointBlock); line += 64) {
        __builtin_prefetch(soon + line);
      }
      findCells(frame, leaves[work.frontier[first + i]], i * 16, points);
    }
    wide = fetchDepths(frame, n, wide, points);
    for (std::size_t i = 0; i < n; ++i) {
      const PointBlock& leaf = leaves[work.frontier[first + i]];
      if (wide) {
        evaluate<true>(decode, leaf, points, i * 16, work, out);
      } else {
        evaluate<false>(decode, leaf, points, i * 16, work, out);
      }
    }
    normalise(frame, from, out);
  }
  return wide;
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate
HWY_AFTER_NAMESPACE();

#endif
