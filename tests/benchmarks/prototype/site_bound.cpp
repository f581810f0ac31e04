#include "tests/benchmarks/prototype/site_bound.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/benchmarks/prototype/site_bound.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace palpate::bench {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Three bounds hold for every u of the block and s of the site, with w = c - (nearest point of the
// box to c), d = |w|, m = w / d:
//   |u - s| >= m·(u - s) >= d + m·(u - c)             (s lies behind the plane through that point)
//   |u - s| >= n·(u - s) >= n·u - h                   (s lies below the site's plane)
//   |u - s| >= g·(u - s) >= g·u - max over box of g·s
// Each, less g·(u - c), is smallest at a corner of the block.
float lowestOverSites(const float* const* column, std::size_t count, const float* c, const float* g,
                      const float* half) {
  const hn::CappedTag<float, 16> d;
  auto best = hn::Set(d, 1e9f);
  const auto zero = hn::Zero(d);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    auto d2 = zero;
    decltype(d2) w[3];
    auto along = zero;
    auto plane = hn::Neg(hn::LoadU(d, column[9] + i));
    auto planeTurn = zero;
    auto gc = 0.0f;
    for (int a = 0; a < 3; ++a) {
      const auto centre = hn::Set(d, c[a]);
      const auto lo = hn::LoadU(d, column[a] + i);
      const auto hi = hn::LoadU(d, column[3 + a] + i);
      w[a] = hn::Sub(centre, hn::Min(hn::Max(centre, lo), hi));
      d2 = hn::Add(d2, hn::Mul(w[a], w[a]));
      const auto slope = hn::Set(d, g[a]);
      along = hn::Add(along, hn::Max(hn::Mul(slope, lo), hn::Mul(slope, hi)));
      gc += g[a] * c[a];
      const auto n = hn::LoadU(d, column[6 + a] + i);
      plane = hn::Add(plane, hn::Mul(n, centre));
      planeTurn = hn::Add(planeTurn, hn::Mul(hn::Abs(hn::Sub(n, slope)), hn::Set(d, half[a])));
    }
    const auto dist = hn::Sqrt(d2);
    const auto inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(dist, hn::Set(d, 1e-6f)));
    auto turn = zero;
    for (int a = 0; a < 3; ++a) {
      turn = hn::Add(turn, hn::Mul(hn::Abs(hn::Sub(hn::Mul(w[a], inverse), hn::Set(d, g[a]))),
                                   hn::Set(d, half[a])));
    }
    const auto one = hn::Sub(dist, turn);
    const auto two = hn::Sub(plane, planeTurn);
    const auto three = hn::Sub(hn::Set(d, gc), along);
    best = hn::Min(best, hn::Max(one, hn::Max(two, three)));
  }
  return hn::GetLane(hn::MinOfLanes(d, best));
}

}  // namespace HWY_NAMESPACE
}  // namespace palpate::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::bench {
namespace {

HWY_EXPORT(lowestOverSites);

constexpr std::size_t kWidest = 16;

}  // namespace

namespace {

constexpr int kParts = 4;
constexpr float kPart = 1.0f / kParts;

// How far N reaches along one axis of the unit cell. `c` with that axis fastest. Along it the value
// is linear: on each of 5x5 lines the negative part is an interval; between four lines the value is
// bilinear, smallest on one of them.
bool extent(const float c[8], float slack, float& lo, float& hi) {
  lo = 2.0f;
  hi = -1.0f;
  for (int k = 0; k <= kParts; ++k) {
    const float tz = static_cast<float>(k) * kPart;
    for (int j = 0; j <= kParts; ++j) {
      const float ty = static_cast<float>(j) * kPart;
      const auto at = [&](int i) {
        const float below = c[i] + (c[2 + i] - c[i]) * ty;
        const float above = c[4 + i] + (c[6 + i] - c[4 + i]) * ty;
        return below + (above - below) * tz - slack;
      };
      const float a = at(0);
      const float b = at(1);
      if (a < 0) lo = 0.0f;
      if (b < 0) hi = 1.0f;
      if (a < 0 && b >= 0) hi = std::max(hi, a / (a - b));
      if (b < 0 && a >= 0) lo = std::min(lo, a / (a - b));
    }
  }
  return lo <= hi;
}

// The value as a polynomial about the cell's middle.
struct Trilinear {
  float c, x, y, z, xy, yz, xz, xyz;
  explicit Trilinear(const float v[8]) {
    const auto sum = [&](int axes) {  // of v with the signs of these axes
      float s = 0;
      for (int i = 0; i < 8; ++i) {
        const bool minus = (__builtin_popcount(static_cast<unsigned>(~i & axes)) & 1) != 0;
        s += minus ? -v[i] : v[i];
      }
      return s;
    };
    c = sum(0) / 8;
    x = sum(1) / 4;
    y = sum(2) / 4;
    z = sum(4) / 4;
    xy = sum(3) / 2;
    yz = sum(6) / 2;
    xz = sum(5) / 2;
    xyz = sum(7);
  }
};

}  // namespace

bool siteOfCell(const float corner[8], const int cell[3], const float axis[3], float slack,
                Site& site) {
  float lo[3];
  float hi[3];
  for (int a = 0; a < 3; ++a) {
    const int u = 1 << a;
    const int v = 1 << (a + 1) % 3;
    const int w = 1 << (a + 2) % 3;
    const float turned[8] = {corner[0], corner[u],     corner[v],     corner[v + u],
                             corner[w], corner[w + u], corner[w + v], corner[w + v + u]};
    if (!extent(turned, slack, lo[a], hi[a])) return false;
  }
  const Trilinear f(corner);
  float n[3] = {f.x / axis[0], f.y / axis[1], f.z / axis[2]};
  const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (float& v : n) v = length > 1e-3f ? v / length : 0.0f;
  const float p[3] = {n[0] * axis[0], n[1] * axis[1], n[2] * axis[2]};  // n·s along the grid
  // In a part with middle m, f(s) >= f(m) + G·(s - m) - bend; where that may be negative, n·s is
  // bounded by what of p lies along G, and the rest by the part's size.
  constexpr float kHalf = 0.5f * kPart;
  const float bend = (std::abs(f.xy) + std::abs(f.yz) + std::abs(f.xz)) * kHalf * kHalf +
                     std::abs(f.xyz) * (kHalf * kHalf * kHalf + 1.5f * kHalf * kHalf);
  float h = -1e9f;
  for (int k = 0; k < kParts; ++k) {
    for (int j = 0; j < kParts; ++j) {
      for (int i = 0; i < kParts; ++i) {
        const float x = (static_cast<float>(i) + 0.5f) * kPart - 0.5f;
        const float y = (static_cast<float>(j) + 0.5f) * kPart - 0.5f;
        const float z = (static_cast<float>(k) + 0.5f) * kPart - 0.5f;
        const float value = f.c + f.x * x + f.y * y + f.z * z + f.xy * x * y + f.yz * y * z +
                            f.xz * x * z + f.xyz * x * y * z;
        const float g[3] = {f.x + f.xy * y + f.xz * z + f.xyz * y * z,
                            f.y + f.xy * x + f.yz * z + f.xyz * x * z,
                            f.z + f.yz * y + f.xz * x + f.xyz * x * y};
        const float room = slack + bend - value;  // G·d < room
        if ((std::abs(g[0]) + std::abs(g[1]) + std::abs(g[2])) * kHalf < -room) continue;
        const float g2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
        const float along =
            std::max(0.0f, (p[0] * g[0] + p[1] * g[1] + p[2] * g[2]) / std::max(g2, 1e-12f));
        float rest = 0;
        float all = 0;
        for (int a = 0; a < 3; ++a) {
          rest += std::abs(p[a] - along * g[a]) * kHalf;
          all += std::abs(p[a]) * kHalf;
        }
        h = std::max(h, p[0] * (x + 0.5f) + p[1] * (y + 0.5f) + p[2] * (z + 0.5f) +
                            std::min(all, along * room + rest));
      }
    }
  }
  site.h = h;
  for (int a = 0; a < 3; ++a) {
    const auto origin = static_cast<float>(cell[a]);
    site.lo[a] = axis[a] * (origin + lo[a]);
    site.hi[a] = axis[a] * (origin + hi[a]);
    site.n[a] = n[a];
    site.h += p[a] * origin;
  }
  return true;
}

void SiteList::clear() {
  for (auto& c : column_) c.clear();
}

void SiteList::add(const Site& s) {
  for (std::size_t a = 0; a < 3; ++a) {
    column_[a].push_back(s.lo[a]);
    column_[3 + a].push_back(s.hi[a]);
    column_[6 + a].push_back(s.n[a]);
  }
  column_[9].push_back(s.h);
}

float SiteList::bound(const float c[3], const float g[3], const float half[3]) const {
  if (size() == 0) return 1e9f;
  const float* column[10];
  for (std::size_t i = 0; i < 10; ++i) column[i] = column_[i].data();
  const std::size_t whole = size() / kWidest * kWidest;
  float best = 1e9f;
  if (whole > 0) best = HWY_DYNAMIC_DISPATCH(lowestOverSites)(column, whole, c, g, half);
  if (whole < size()) {
    // The rest, filled up with its last one.
    float rest[10][kWidest];
    for (std::size_t i = 0; i < 10; ++i) {
      for (std::size_t l = 0; l < kWidest; ++l) {
        rest[i][l] = column_[i][std::min(whole + l, size() - 1)];
      }
      column[i] = rest[i];
    }
    best = std::min(best, HWY_DYNAMIC_DISPATCH(lowestOverSites)(column, kWidest, c, g, half));
  }
  return best - 2e-3f;  // single precision, coordinates up to some thousands
}

}  // namespace palpate::bench
#endif
