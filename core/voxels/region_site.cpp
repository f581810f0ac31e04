#include "core/voxels/region_site.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate {
namespace {

constexpr int kParts = 4;
constexpr float kPart = 1.0f / kParts;

// How far N reaches along one axis of the unit cell; `c` with that axis fastest. Along it the value
// is linear: on each of 5x5 lines the negative part is an interval; between four lines the value is
// bilinear at any x, smallest on one of them.
bool reachAlong(const std::array<float, 8>& c, float slack, float& lo, float& hi) {
  lo = 2.0f;
  hi = -1.0f;
  for (int k = 0; k <= kParts; ++k) {
    const float tz = static_cast<float>(k) * kPart;
    for (int j = 0; j <= kParts; ++j) {
      const float ty = static_cast<float>(j) * kPart;
      const auto at = [&](std::size_t i) {
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
  explicit Trilinear(const std::array<float, 8>& v) {
    const auto sum = [&](unsigned axes) {  // of v with the signs of these axes
      float s = 0;
      for (unsigned i = 0; i < 8; ++i) {
        s += (std::popcount(~i & axes) & 1) != 0 ? -v[i] : v[i];
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

// The least h for which N lies below n·p <= h. In a part with middle m the value is at least
// f(m) + G·(p − m) − bend; where that may be negative, n·p is bounded by what of n lies along G,
// and the rest by the part's size. `p` is n along the cell's axes.
float planeOf(const Trilinear& f, const std::array<float, 3>& p, float slack) {
  constexpr float kHalf = 0.5f * kPart;
  const float bend = (std::abs(f.xy) + std::abs(f.yz) + std::abs(f.xz)) * kHalf * kHalf +
                     std::abs(f.xyz) * (kHalf * kHalf * kHalf + 1.5f * kHalf * kHalf);
  float h = -1e9f;
  for (int part = 0; part < kParts * kParts * kParts; ++part) {
    const auto middle = [](int i) { return (static_cast<float>(i) + 0.5f) * kPart - 0.5f; };
    const float x = middle(part % kParts);
    const float y = middle(part / kParts % kParts);
    const float z = middle(part / (kParts * kParts));
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
    for (std::size_t a = 0; a < 3; ++a) {
      rest += std::abs(p[a] - along * g[a]) * kHalf;
      all += std::abs(p[a]) * kHalf;
    }
    h = std::max(h, p[0] * (x + 0.5f) + p[1] * (y + 0.5f) + p[2] * (z + 0.5f) +
                        std::min(all, along * room + rest));
  }
  return h;
}

}  // namespace

bool siteOfCell(const std::array<float, 8>& corner, const std::array<float, 3>& edge, float slack,
                RegionSite& site) {
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t u = std::size_t{1} << a;
    const std::size_t v = std::size_t{1} << (a + 1) % 3;
    const std::size_t w = std::size_t{1} << (a + 2) % 3;
    float lo = 0;
    float hi = 0;
    if (!reachAlong({corner[0], corner[u], corner[v], corner[v + u], corner[w], corner[w + u],
                     corner[w + v], corner[w + v + u]},
                    slack, lo, hi)) {
      return false;
    }
    // A thousandth of a step covers the rounding of the crossings.
    site.lo[a] =
        static_cast<std::uint8_t>(std::max(0.0f, std::floor(lo * RegionSite::kBoxSteps - 1e-3f)));
    site.hi[a] =
        static_cast<std::uint8_t>(std::min(255.0f, std::ceil(hi * RegionSite::kBoxSteps + 1e-3f)));
  }
  const Trilinear f(corner);
  std::array<float, 3> n{f.x / edge[0], f.y / edge[1], f.z / edge[2]};
  const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  std::array<float, 3> p{};
  for (std::size_t a = 0; a < 3; ++a) {
    // Towards zero, so that |n| stays at most 1.
    site.n[a] = length > 1e-3f ? static_cast<std::int8_t>(n[a] / length * RegionSite::kNormalSteps)
                               : std::int8_t{0};
    p[a] = static_cast<float>(site.n[a]) / RegionSite::kNormalSteps * edge[a];
  }
  const float h = std::ceil(planeOf(f, p, slack) * RegionSite::kPlaneSteps + 0.05f);
  site.h = static_cast<std::int16_t>(std::clamp(h, -32768.0f, 32767.0f));
  return true;
}

}  // namespace palpate
