#include "tests/benchmarks/dense_peers.h"

#include <array>
#include <cstring>
#include <utility>

#include "tests/benchmarks/field_pose.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/dense_peers.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/collision/pack-inl.h"

#ifndef PALPATE_BENCH_DENSE_PEERS_ONCE
#define PALPATE_BENCH_DENSE_PEERS_ONCE
namespace palpate::bench {

// What a step of the dense peers works on.
struct DenseWork {
  const DenseField* field = nullptr;
  const ProbeTree* probe = nullptr;
  std::vector<std::uint32_t> frontier, next;
  std::size_t tests = 0;
};

}  // namespace palpate::bench
#endif

HWY_BEFORE_NAMESPACE();
namespace palpate::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using Packer = palpate::HWY_NAMESPACE::Packer<D>;

using DF = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using VI = hn::Vec<DI>;

struct Lane3 {
  VF x, y, z;
};

struct Pose {
  explicit Pose(const FieldPose& pose) : p(pose) {}
  HWY_INLINE Lane3 apply(VF x, VF y, VF z) const {
    const DF d;
    const auto row = [&](int a) HWY_ATTR {
      return hn::Add(
          hn::Add(hn::Add(hn::Mul(hn::Set(d, p.m[a][0]), x), hn::Mul(hn::Set(d, p.m[a][1]), y)),
                  hn::Mul(hn::Set(d, p.m[a][2]), z)),
          hn::Set(d, p.t[a]));
    };
    return {row(0), row(1), row(2)};
  }
  const FieldPose& p;
};

// The dense field as the SIMD peers read it.
struct Field {
  explicit Field(const DenseField& f)
      : base(f.value.data()), row(f.dims[0]), slice(f.dims[0] * f.dims[1]) {
    for (std::size_t a = 0; a < 3; ++a) last[a] = static_cast<float>(f.dims[a] - 1);
  }

  struct Cell {
    VI at;
    Lane3 f;
  };
  // Clamped into the box of centres.
  HWY_INLINE Lane3 clamp(const Lane3& u) const {
    const DF d;
    const auto one = [&](VF v, float top)
                         HWY_ATTR { return hn::Min(hn::Max(v, hn::Zero(d)), hn::Set(d, top)); };
    return {one(u.x, last[0]), one(u.y, last[1]), one(u.z, last[2])};
  }
  HWY_INLINE hn::Mask<DF> inside(const Lane3& u, const Lane3& clamped) const {
    return hn::And(hn::And(hn::Eq(u.x, clamped.x), hn::Eq(u.y, clamped.y)), hn::Eq(u.z, clamped.z));
  }
  // `u` within the box. A far face's points read one sample past it with weight zero.
  HWY_INLINE Cell cell(const Lane3& u) const {
    const DF d;
    const DI di;
    const VI i = hn::ConvertTo(di, u.x);
    const VI j = hn::ConvertTo(di, u.y);
    const VI k = hn::ConvertTo(di, u.z);
    const VI at = hn::Add(hn::Add(hn::Mul(k, hn::Set(di, slice)), hn::Mul(j, hn::Set(di, row))), i);
    return {at,
            {hn::Sub(u.x, hn::ConvertTo(d, i)), hn::Sub(u.y, hn::ConvertTo(d, j)),
             hn::Sub(u.z, hn::ConvertTo(d, k))}};
  }
  HWY_INLINE VF nearest(const Lane3& u) const {
    const DF d;
    const VF half = hn::Set(d, 0.5f);
    const Cell c = cell({hn::Add(u.x, half), hn::Add(u.y, half), hn::Add(u.z, half)});
    return hn::GatherIndex(d, base, c.at);
  }

  const float* base;
  std::int32_t row, slice;
  float last[3];
};

struct Corners {
  VF v[8];
};
HWY_INLINE Corners corners(const Field& field, VI at) {
  const DF d;
  const std::int32_t r = field.row;
  const std::int32_t s = field.slice;
  const float* b = field.base;
  return {{hn::GatherIndex(d, b, at), hn::GatherIndex(d, b + 1, at), hn::GatherIndex(d, b + r, at),
           hn::GatherIndex(d, b + r + 1, at), hn::GatherIndex(d, b + s, at),
           hn::GatherIndex(d, b + s + 1, at), hn::GatherIndex(d, b + s + r, at),
           hn::GatherIndex(d, b + s + r + 1, at)}};
}

HWY_INLINE VF mix(VF a, VF b, VF t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), t));
}

struct Sample {
  VF value, gx, gy, gz;
};
HWY_INLINE VF interpolate(const Corners& c, const Lane3& f) {
  const VF r00 = mix(c.v[0], c.v[1], f.x);
  const VF r01 = mix(c.v[2], c.v[3], f.x);
  const VF r10 = mix(c.v[4], c.v[5], f.x);
  const VF r11 = mix(c.v[6], c.v[7], f.x);
  return mix(mix(r00, r01, f.y), mix(r10, r11, f.y), f.z);
}
HWY_INLINE Sample sample(const Corners& c, const Lane3& f) {
  const VF r00 = mix(c.v[0], c.v[1], f.x);
  const VF r01 = mix(c.v[2], c.v[3], f.x);
  const VF r10 = mix(c.v[4], c.v[5], f.x);
  const VF r11 = mix(c.v[6], c.v[7], f.x);
  const VF s0 = mix(r00, r01, f.y);
  const VF s1 = mix(r10, r11, f.y);
  return {mix(s0, s1, f.z),
          mix(mix(hn::Sub(c.v[1], c.v[0]), hn::Sub(c.v[3], c.v[2]), f.y),
              mix(hn::Sub(c.v[5], c.v[4]), hn::Sub(c.v[7], c.v[6]), f.y), f.z),
          mix(hn::Sub(r01, r00), hn::Sub(r11, r10), f.z), hn::Sub(s1, s0)};
}

HWY_INLINE void emit(const Sample& s, hn::Mask<DF> mask, const std::uint32_t* index,
                     ContactList& out) {
  const DF d;
  const hn::Rebind<std::uint32_t, DF> du;
  const VF length2 =
      hn::Add(hn::Add(hn::Mul(s.gx, s.gx), hn::Mul(s.gy, s.gy)), hn::Mul(s.gz, s.gz));
  const VF scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(length2, hn::Set(d, 1e-30f))));
  const std::size_t n = out.count;
  const Packer<DF> packer(mask);
  packer.store(hn::LoadU(du, index), &out.index[n]);
  packer.store(hn::Neg(s.value), &out.depth[n]);
  packer.store(hn::Mul(s.gx, scale), &out.nx[n]);
  packer.store(hn::Mul(s.gy, scale), &out.ny[n]);
  packer.store(hn::Mul(s.gz, scale), &out.nz[n]);
  out.count = n + packer.count();
}

// Sixteen points from `rank` on.
HWY_INLINE void testPoints(const Field& field, const Pose& pose, const ProbeTree& probe,
                           std::size_t rank, ContactList& out) {
  const DF d;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Lane3 u =
        pose.apply(hn::LoadU(d, &probe.point.x[rank + l]), hn::LoadU(d, &probe.point.y[rank + l]),
                   hn::LoadU(d, &probe.point.z[rank + l]));
    const Lane3 c = field.clamp(u);
    const auto in = field.inside(u, c);
    if (hn::AllFalse(d, in)) continue;
    const Field::Cell cell = field.cell(c);
    const Sample s = sample(corners(field, cell.at), cell.f);
    const auto hit = hn::And(in, hn::Lt(s.value, hn::Zero(d)));
    if (!hn::AllFalse(d, hit)) emit(s, hit, &probe.order[rank + l], out);
  }
}

void findDense(DenseWork& work, const FieldPose& p, ContactList& out) {
  const Field field(*work.field);
  const Pose pose(p);
  out.count = 0;
  for (std::size_t rank = 0; rank < work.probe->point.x.size(); rank += 16) {
    testPoints(field, pose, *work.probe, rank, out);
  }
  work.tests = work.probe->points;
}

// Which of the sixteen spheres from `first` on may touch: their numbers are appended to `out`.
template <bool kTuned, bool kExact = false>
HWY_INLINE std::size_t testSpheres(const Field& field, const Pose& pose, const float* const* sphere,
                                   std::size_t first, std::uint32_t* out) {
  const DF d;
  const hn::Rebind<std::uint32_t, DF> du;
  std::size_t count = 0;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const std::size_t at = first + l;
    const Lane3 u = pose.apply(hn::LoadU(d, sphere[0] + l), hn::LoadU(d, sphere[1] + l),
                               hn::LoadU(d, sphere[2] + l));
    const VF r = hn::Mul(hn::LoadU(d, sphere[3] + l), hn::Set(d, pose.p.perUnit));
    const Lane3 c = field.clamp(u);
    const VF sx = hn::Sub(u.x, c.x);
    const VF sy = hn::Sub(u.y, c.y);
    const VF sz = hn::Sub(u.z, c.z);
    const VF away2 = hn::Add(hn::Add(hn::Mul(sx, sx), hn::Mul(sy, sy)), hn::Mul(sz, sz));
    auto live = hn::And(hn::Ge(r, hn::Zero(d)), hn::Le(away2, hn::Mul(r, r)));
    if (hn::AllFalse(d, live)) continue;
    if constexpr (kTuned) {
      // Half the diagonal of a voxel is the farthest that the nearest sample can be.
      live = hn::And(live, hn::Le(field.nearest(c), hn::Add(r, hn::Set(d, 0.8661f))));
      // Where that was close, the interpolated value decides as in the published version.
      if (kExact && !hn::AllFalse(d, live)) {
        const Field::Cell cell = field.cell(c);
        live = hn::And(live, hn::Le(interpolate(corners(field, cell.at), cell.f), r));
      }
    } else {
      const Field::Cell cell = field.cell(c);
      live = hn::And(live, hn::Le(interpolate(corners(field, cell.at), cell.f), r));
    }
    const auto id = hn::Add(hn::Iota(du, 0), hn::Set(du, static_cast<std::uint32_t>(at)));
    const Packer<DF> packer(live);
    packer.store(id, out + count);
    count += packer.count();
  }
  return count;
}

// Down the probe's tree; leaves the live nodes of level 0 in work.frontier.
template <bool kTuned>
HWY_INLINE std::size_t descend(DenseWork& work, const Field& field, const Pose& pose) {
  const ProbeTree& probe = *work.probe;
  std::size_t l = kTuned ? probe.start : probe.level.size() - 1;
  const auto testNode = [&](std::size_t node, std::uint32_t* to) HWY_ATTR {
    const SphereLevel& level = probe.level[l];
    const std::size_t first = node * 16;
    if constexpr (kTuned) {
      const SphereBlock& b = level.block[node];
      const float* const sphere[4] = {b.x, b.y, b.z, b.r};
      return l == 0 ? testSpheres<true, true>(field, pose, sphere, first, to)
                    : testSpheres<true>(field, pose, sphere, first, to);
    } else {
      const float* const sphere[4] = {&level.x[first], &level.y[first], &level.z[first],
                                      &level.r[first]};
      return testSpheres<false>(field, pose, sphere, first, to);
    }
  };
  std::size_t count = 0;
  for (std::size_t node = 0; node < probe.level[l].block.size(); ++node) {
    count += testNode(node, work.frontier.data() + count);
  }
  work.tests += probe.level[l].count;
  while (l-- > 0) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < count; ++i) {
      next += testNode(work.frontier[i], work.next.data() + next);
    }
    work.tests += count * 16;
    std::swap(work.frontier, work.next);
    count = next;
  }
  work.tests += count * 16;
  return count;
}

void findRival(DenseWork& work, const FieldPose& p, ContactList& out) {
  const Field field(*work.field);
  const Pose pose(p);
  out.count = 0;
  work.tests = 0;
  const std::size_t count = descend<false>(work, field, pose);
  for (std::size_t i = 0; i < count; ++i) {
    testPoints(field, pose, *work.probe, std::size_t{work.frontier[i]} * 16, out);
  }
}

// Tuned leaves, in blocks of batches that stay in the first cache: cells of all points, then their
// values by scalar loads of two (quicker than gathers here), then the arithmetic; contacts are
// packed with their gradient and get their normals together.
constexpr std::size_t kBlock = 16;
struct alignas(64) Block {
  std::int32_t at[kBlock * 16];
  float fx[kBlock * 16], fy[kBlock * 16], fz[kBlock * 16];
  float limit[kBlock * 16];
  float pair[4][kBlock * 16][2];
};

HWY_INLINE void address(const Field& field, const Pose& pose, const LeafPoints& leaf,
                        std::size_t slot, Block& block) {
  const DF d;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Lane3 u =
        pose.apply(hn::Load(d, leaf.x + l), hn::Load(d, leaf.y + l), hn::Load(d, leaf.z + l));
    const Lane3 c = field.clamp(u);
    const Field::Cell cell = field.cell(c);
    hn::Store(cell.at, DI(), block.at + slot + l);
    hn::Store(cell.f.x, d, block.fx + slot + l);
    hn::Store(cell.f.y, d, block.fy + slot + l);
    hn::Store(cell.f.z, d, block.fz + slot + l);
    // A point outside the box can't be in contact: its bound stays below every value.
    hn::Store(hn::IfThenElse(field.inside(u, c), hn::Zero(d), hn::Set(d, -1e30f)), d,
              block.limit + slot + l);
  }
}

HWY_INLINE void fetch(const Field& field, std::size_t count, Block& block) {
  const std::ptrdiff_t offset[4] = {0, field.row, field.slice, field.slice + field.row};
  for (std::size_t i = 0; i < count; ++i) {
    const float* from = field.base + block.at[i];
    for (std::size_t k = 0; k < 4; ++k) std::memcpy(block.pair[k][i], from + offset[k], 8);
  }
}

HWY_INLINE void evaluate(const LeafPoints& leaf, const Block& block, std::size_t slot,
                         ContactList& out) {
  const DF d;
  const hn::Rebind<std::uint32_t, DF> du;
  for (std::size_t l = 0; l < 16; l += hn::Lanes(d)) {
    const Lane3 f{hn::Load(d, block.fx + slot + l), hn::Load(d, block.fy + slot + l),
                  hn::Load(d, block.fz + slot + l)};
    Corners c;
    for (std::size_t k = 0; k < 4; ++k) {
      hn::LoadInterleaved2(d, block.pair[k][slot + l], c.v[2 * k], c.v[2 * k + 1]);
    }
    const Sample s = sample(c, f);
    const auto hit = hn::Lt(s.value, hn::Load(d, block.limit + slot + l));
    if (hn::AllFalse(d, hit)) continue;
    const std::size_t n = out.count;
    const Packer<DF> packer(hit);
    packer.store(hn::Load(du, leaf.index + l), &out.index[n]);
    packer.store(hn::Neg(s.value), &out.depth[n]);
    packer.store(s.gx, &out.nx[n]);
    packer.store(s.gy, &out.ny[n]);
    packer.store(s.gz, &out.nz[n]);
    out.count = n + packer.count();
  }
}

HWY_INLINE void normalise(std::size_t from, ContactList& out) {
  const DF d;
  for (std::size_t i = from; i < out.count; i += hn::Lanes(d)) {
    const VF x = hn::LoadU(d, &out.nx[i]);
    const VF y = hn::LoadU(d, &out.ny[i]);
    const VF z = hn::LoadU(d, &out.nz[i]);
    const VF length2 = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    const VF scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(length2, hn::Set(d, 1e-30f))));
    hn::StoreU(hn::Mul(x, scale), d, &out.nx[i]);
    hn::StoreU(hn::Mul(y, scale), d, &out.ny[i]);
    hn::StoreU(hn::Mul(z, scale), d, &out.nz[i]);
  }
}

void findTunedRival(DenseWork& work, const FieldPose& p, ContactList& out) {
  const Field field(*work.field);
  const Pose pose(p);
  const ProbeTree& probe = *work.probe;
  out.count = 0;
  work.tests = 0;
  const std::size_t count = descend<true>(work, field, pose);
  Block block;
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t n = std::min(kBlock, count - first);
    const std::size_t from = out.count;
    for (std::size_t i = 0; i < n; ++i) {
      address(field, pose, probe.leaf[work.frontier[first + i]], i * 16, block);
    }
    fetch(field, n * 16, block);
    for (std::size_t i = 0; i < n; ++i) {
      evaluate(probe.leaf[work.frontier[first + i]], block, i * 16, out);
    }
    normalise(from, out);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::bench {
namespace {

HWY_EXPORT(findDense);
HWY_EXPORT(findRival);
HWY_EXPORT(findTunedRival);

enum class Kind { Dense, Rival, TunedRival };

class DensePeer : public Peer {
 public:
  DensePeer(Kind kind, const DenseField& field, const ProbeTree& probe) : kind_(kind) {
    work_.field = &field;
    work_.probe = &probe;
    const std::size_t nodes = probe.level.front().x.size() + 64;
    work_.frontier.resize(nodes);
    work_.next.resize(nodes);
  }
  [[nodiscard]] std::string name() const override {
    return kind_ == Kind::Dense   ? "dense field, SIMD"
           : kind_ == Kind::Rival ? "rival"
                                  : "rival, tuned";
  }
  [[nodiscard]] std::size_t worldBytes() const override {
    return work_.field->value.size() * sizeof(float);
  }
  [[nodiscard]] std::size_t tests() const override { return work_.tests; }
  void find(const Eigen::Isometry3d& X_VT, ContactList& out) override {
    const FieldPose pose(X_VT, work_.field->spacing, work_.field->unit);
    switch (kind_) {
      case Kind::Dense:
        HWY_DYNAMIC_DISPATCH(findDense)(work_, pose, out);
        break;
      case Kind::Rival:
        HWY_DYNAMIC_DISPATCH(findRival)(work_, pose, out);
        break;
      case Kind::TunedRival:
        HWY_DYNAMIC_DISPATCH(findTunedRival)(work_, pose, out);
        break;
    }
  }

 private:
  Kind kind_;
  DenseWork work_;
};

}  // namespace

std::unique_ptr<Peer> makeDenseSimd(const DenseField& field, const ProbeTree& probe) {
  return std::make_unique<DensePeer>(Kind::Dense, field, probe);
}
std::unique_ptr<Peer> makeRival(const DenseField& field, const ProbeTree& probe) {
  return std::make_unique<DensePeer>(Kind::Rival, field, probe);
}
std::unique_ptr<Peer> makeTunedRival(const DenseField& field, const ProbeTree& probe) {
  return std::make_unique<DensePeer>(Kind::TunedRival, field, probe);
}

}  // namespace palpate::bench
#endif
