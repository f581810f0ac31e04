#include "tests/benchmarks/prototype/fast_world.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>
#include <vector>

#include "tests/benchmarks/prototype/depth_codes.h"
#include "tests/benchmarks/prototype/site_bound.h"

namespace palpate::bench {
namespace {

using Int3 = std::array<std::int32_t, 3>;

// Sites farther from a block of 16³ than this are not looked at; at most one such block.
constexpr float kWindow = 8.0f;
// A block of 16³ without bricks gets finer words where the region may be nearer than this.
constexpr float kNear = 6.0f;
// What the coded depths and the interpolation may add to the true value, units.
constexpr float kSlack = 1e-3f;

class Builder {
 public:
  Builder(const DenseField& field, FastWorld& world) : field_(field), world_(world) {}

  void run() {
    layOut();
    findBricks();
    chooseCodes();
    allocate();
    parallel(static_cast<int>(mask_.size()), [&](int t) { fillBlock(t); });
  }

 private:
  template <class F>
  static void parallel(int n, F&& f) {
    std::thread half([&] {
      for (int i = 0; i < n; i += 2) f(i);
    });
    for (int i = 1; i < n; i += 2) f(i);
    half.join();
  }
  [[nodiscard]] Int3 origin16(int t) const {
    return {t % tops_[0] * 16, t / tops_[0] % tops_[1] * 16, t / world_.topSlice * 16};
  }
  static Int3 origin4(Int3 o, int c) {
    return {o[0] + (c & 3) * 4, o[1] + (c >> 2 & 3) * 4, o[2] + (c >> 4) * 4};
  }
  // Beyond the grid its edge goes on.
  [[nodiscard]] float at(int i, int j, int k) const {
    const Int3& d = field_.dims;
    return field_.at(std::min(i, d[0] - 1), std::min(j, d[1] - 1), std::min(k, d[2] - 1));
  }
  [[nodiscard]] bool within(Int3 o) const {
    const Int3& d = field_.dims;
    return o[0] < d[0] && o[1] < d[1] && o[2] < d[2];
  }

  void layOut() {
    for (std::size_t a = 0; a < 3; ++a) {
      tops_[a] = (field_.dims[a] + 15) / 16;
      world_.axis[a] = static_cast<float>(field_.spacing[a] / field_.unit);
      diagonal_ += world_.axis[a] * world_.axis[a];
    }
    // N keeps within this of an inside centre. Cubic voxels: the worst is a point near the one
    // outside corner of a cell, 0.858 away. Otherwise a cell's diagonal does.
    diagonal_ = std::sqrt(diagonal_);
    overhang_ = field_.cubic() ? 0.87f : diagonal_;
    world_.dims = field_.dims;
    world_.spacing = field_.spacing;
    world_.unit = field_.unit;
    world_.topRow = tops_[0];
    world_.topSlice = tops_[0] * tops_[1];
    mask_.resize(static_cast<std::size_t>(world_.topSlice) * static_cast<std::size_t>(tops_[2]));
    near_.resize(mask_.size());
    sites_.resize(mask_.size());
  }

  // Which blocks of 4³ cells have a corner inside, and the sites of their cells.
  void findBricks() {
    parallel(static_cast<int>(mask_.size()), [&](int t) {
      const Int3 o = origin16(t);
      const auto n = static_cast<std::size_t>(t);
      float low = 1e9f;
      for (int c = 0; c < 64; ++c) {
        const Int3 b = origin4(o, c);
        if (!within(b)) continue;
        const float middle = at(b[0] + 2, b[1] + 2, b[2] + 2);
        low = std::min(low, middle - 2.0f * diagonal_ - 0.5f);
        if (middle > 2.0f * diagonal_ + 0.5f) continue;
        if (middle < 0 || anyInside(b)) mask_[n] |= std::uint64_t{1} << c;
      }
      near_[n] = low < kNear;
      if (mask_[n] != 0) findSites(o, sites_[n]);
    });
  }
  [[nodiscard]] bool anyInside(Int3 o) const {
    for (int k = 0; k <= 4; ++k)
      for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i)
          if (at(o[0] + i, o[1] + j, o[2] + k) < 0) return true;
    return false;
  }
  void findSites(Int3 o, std::vector<Site>& sites) const {
    const Int3& d = field_.dims;
    for (int k = o[2]; k < std::min(o[2] + 16, d[2] - 1); ++k)
      for (int j = o[1]; j < std::min(o[1] + 16, d[1] - 1); ++j)
        for (int i = o[0]; i < std::min(o[0] + 16, d[0] - 1); ++i) {
          float corner[8];
          int inside = 0;
          for (int n = 0; n < 8; ++n) {
            corner[n] = field_.at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
            inside += corner[n] < 0;
          }
          if (inside == 0 || inside == 8) continue;
          Site site;
          const int cell[3] = {i, j, k};
          if (siteOfCell(corner, cell, world_.axis.data(), kSlack, site)) sites.push_back(site);
        }
  }

  void chooseCodes() {
    std::vector<std::uint32_t> histogram(65536);
    for (std::size_t t = 0; t < mask_.size(); ++t) {
      for (std::uint64_t m = mask_[t]; m != 0; m &= m - 1) {
        const Int3 o = origin4(origin16(static_cast<int>(t)), std::countr_zero(m));
        for (int k = 0; k < 4; ++k)
          for (int j = 0; j < 4; ++j)
            for (int i = 0; i < 4; ++i) {
              ++histogram[static_cast<std::size_t>(depthSteps(at(o[0] + i, o[1] + j, o[2] + k)) +
                                                   32768)];
            }
      }
    }
    // An outside corner of a cell with an inside one is no farther from it than the diagonal.
    codes_ = std::make_unique<DepthCodes>(histogram, depthSteps(diagonal_));
    for (std::size_t c = 0; c < 256; ++c) {
      world_.palette[c] = codes_->steps[c];
      world_.low[c] = static_cast<std::uint8_t>(codes_->steps[c] & 255);
      world_.high[c] = static_cast<std::uint8_t>((codes_->steps[c] >> 8) & 255);
    }
    world_.pairs = HugeBuffer<std::int32_t>(65536);
    for (std::size_t i = 0; i < 65536; ++i) {
      const auto low = static_cast<std::uint32_t>(codes_->steps[i & 255]) & 0xFFFFU;
      const auto high = static_cast<std::uint32_t>(codes_->steps[i >> 8]) << 16;
      world_.pairs[i] = static_cast<std::int32_t>(low | high);
    }
    // 4 points of 32 bytes: the codes at z of all, then those at z+1.
    for (std::size_t i = 0; i < 32; ++i) {
      static constexpr std::uint8_t kByte[2][4] = {{0, 1, 5, 6}, {25, 26, 30, 31}};
      world_.pick[i] = static_cast<std::uint8_t>((i % 16) / 4 * 32 + kByte[i / 16][i % 4]);
    }
  }
  [[nodiscard]] bool isWide(Int3 o) const {
    for (int k = 0; k <= 4; ++k)
      for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i)
          if (codes_->of(depthSteps(at(o[0] + i, o[1] + j, o[2] + k))) < 0) return true;
    return false;
  }

  void allocate() {
    node_.resize(mask_.size());
    first_.resize(mask_.size());
    wide_.resize(mask_.size());
    parallel(static_cast<int>(mask_.size()), [&](int t) {
      const auto n = static_cast<std::size_t>(t);
      for (std::uint64_t m = mask_[n]; m != 0; m &= m - 1) {
        const int c = std::countr_zero(m);
        if (isWide(origin4(origin16(t), c))) wide_[n] |= std::uint64_t{1} << c;
      }
    });
    std::uint32_t nodes = 1;
    std::uint32_t bricks = 1;
    for (std::size_t t = 0; t < mask_.size(); ++t) {
      if (mask_[t] == 0 && near_[t] == 0) continue;
      node_[t] = nodes++;
      first_[t] = bricks;
      bricks += static_cast<std::uint32_t>(std::popcount(mask_[t]) + std::popcount(wide_[t]));
      world_.wideBricks += static_cast<std::size_t>(std::popcount(wide_[t]));
    }
    world_.nodes = nodes;
    world_.bricks = bricks;
    world_.top = HugeBuffer<std::uint32_t>(mask_.size());
    world_.topNode = HugeBuffer<std::uint32_t>(mask_.size());
    world_.words = HugeBuffer<std::uint32_t>(std::size_t{nodes} * 64);
    world_.brickStart = HugeBuffer<std::uint32_t>(std::size_t{nodes} * 64);
    world_.fine = HugeBuffer<std::uint32_t>(std::size_t{bricks} * kFineWords);
    world_.codes = HugeBuffer<std::uint8_t>(std::size_t{bricks} * kBrickBytes);  // brick 0: far
  }

  void fillBlock(int t) {
    const auto n = static_cast<std::size_t>(t);
    const Int3 o = origin16(t);
    if (node_[n] == 0) {
      world_.top[n] = word(o, 16, nullptr);
      return;
    }
    thread_local SiteList sites;
    gather(t, sites);
    world_.top[n] = kLink | node_[n];
    world_.topNode[n] = node_[n] * 64;
    std::uint32_t brick = first_[n];
    for (int c = 0; c < 64; ++c) {
      const Int3 b = origin4(o, c);
      const std::size_t to = std::size_t{node_[n]} * 64 + static_cast<std::size_t>(c);
      if ((mask_[n] >> c & 1) == 0) {
        world_.words[to] = word(b, 4, &sites);
        continue;
      }
      const bool wide = (wide_[n] >> c & 1) != 0;
      fillBrick(b, brick, wide, sites);
      world_.words[to] = kLink | brick;
      world_.brickStart[to] = brick | (wide ? kWide : 0U);
      brick += wide ? 2 : 1;
    }
  }
  void fillBrick(Int3 o, std::size_t brick, bool wide, const SiteList& sites) {
    std::uint8_t* const base = world_.codes.data() + brick * kBrickBytes;
    std::uint8_t* to = base;
    for (int k = 0; k <= 4; ++k)
      for (int j = 0; j <= 4; ++j)
        for (int i = 0; i <= 4; ++i, ++to) {
          const std::int16_t steps = depthSteps(at(o[0] + i, o[1] + j, o[2] + k));
          *to = static_cast<std::uint8_t>(wide ? steps & 255 : codes_->of(steps));
          if (wide) to[kBrickBytes] = static_cast<std::uint8_t>((steps >> 8) & 255);
        }
    for (int i = 0; i < kFineWords; ++i) {
      const Int3 sub{o[0] + i % kFineSide * kFineEdge, o[1] + i / kFineSide % kFineSide * kFineEdge,
                     o[2] + i / (kFineSide * kFineSide) * kFineEdge};
      world_.fine[brick * kFineWords + static_cast<std::size_t>(i)] = fineWord(sub, sites);
    }
  }

  // ---- clearances ----

  struct Affine {
    int q[3];
    float b;
  };
  // A lower bound at a sample that stays one between samples: N is `overhang_` from the centres at
  // most, and the square distance to any set exceeds the interpolated one by a quarter of the
  // square diagonal at most.
  [[nodiscard]] float sampled(float v) const {
    const float e = v + 0.5f - overhang_;
    const float sag = 0.25f * diagonal_ * diagonal_;
    return v > 0 && e > 0 && e * e > sag ? std::sqrt(e * e - sag) : -1e9f;
  }
  // The best affine bound of a block of h³ cells with slopes in units of 1/scale.
  [[nodiscard]] Affine affine(Int3 o, int h, float scale, const SiteList* sites) const {
    const int n = h + 1;
    float centre[3];
    float half[3];
    for (std::size_t a = 0; a < 3; ++a) {
      half[a] = 0.5f * static_cast<float>(h) * world_.axis[a];
      centre[a] = world_.axis[a] * static_cast<float>(o[a]) + half[a];
    }
    const auto rel = [&](int a, int i) {
      return world_.axis[static_cast<std::size_t>(a)] * static_cast<float>(i) - half[a];
    };
    float g[3] = {0, 0, 0};
    float s[17 * 17 * 17];
    int m = 0;
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const float v = at(o[0] + i, o[1] + j, o[2] + k);
          s[m++] = sampled(v);
          g[0] += v * rel(0, i);
          g[1] += v * rel(1, j);
          g[2] += v * rel(2, k);
        }
    // Least squares slope on a lattice of n³, no steeper than 1.
    const float norm =
        static_cast<float>(n * n) * static_cast<float>(h * (h + 1) * (h + 2)) / 12.0f;
    float length = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      g[a] /= norm * world_.axis[a] * world_.axis[a];
      length += g[a] * g[a];
    }
    length = std::max(1.0f, std::sqrt(length));
    Affine best{{0, 0, 0}, -1e9f};
    for (const bool level : {true, false}) {
      Affine a{{0, 0, 0}, -1e9f};
      float slope[3];
      for (int c = 0; c < 3; ++c) {
        a.q[c] = level ? 0 : static_cast<int>(scale * g[c] / length);  // towards 0
        slope[c] = static_cast<float>(a.q[c]) / scale;
      }
      float low = 1e9f;
      m = 0;
      for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i) {
            low = std::min(
                low, s[m++] - (slope[0] * rel(0, i) + slope[1] * rel(1, j) + slope[2] * rel(2, k)));
          }
      a.b = low - 1e-3f;
      if (sites != nullptr) {
        float beyond = kWindow;  // what is not in the list is at least that far away
        for (int c = 0; c < 3; ++c) beyond -= half[c] * std::abs(slope[c]);
        a.b = std::max(a.b, std::min(beyond, sites->bound(centre, slope, half)));
      }
      if (a.b > best.b) best = a;
    }
    return best;
  }
  // Three slopes of 7 bits and a bound of 10, in 1/64 of the block's edge in voxels.
  [[nodiscard]] std::uint32_t word(Int3 o, int h, const SiteList* sites) const {
    return encode(affine(o, h, 63.0f, sites), 64.0f / static_cast<float>(h));
  }
  // The same layout, the bound in 1/kFineSteps.
  [[nodiscard]] std::uint32_t fineWord(Int3 o, const SiteList& sites) const {
    Affine a = affine(o, kFineEdge, 63.0f, &sites);
    // Cells inside all over are part of N as well, though no sites.
    SiteList full;
    for (int k = o[2]; k < o[2] + kFineEdge; ++k)
      for (int j = o[1]; j < o[1] + kFineEdge; ++j)
        for (int i = o[0]; i < o[0] + kFineEdge; ++i) {
          bool inside = true;
          for (int n = 0; n < 8 && inside; ++n) {
            inside = at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2)) < 0;
          }
          if (!inside) continue;
          const int cell[3] = {i, j, k};
          Site site{};
          for (std::size_t c = 0; c < 3; ++c) {
            site.lo[c] = world_.axis[c] * static_cast<float>(cell[c]);
            site.hi[c] = site.lo[c] + world_.axis[c];
          }
          full.add(site);
        }
    if (full.size() > 0) {
      float centre[3];
      float half[3];
      float slope[3];
      for (std::size_t c = 0; c < 3; ++c) {
        half[c] = 0.5f * kFineEdge * world_.axis[c];
        centre[c] = world_.axis[c] * static_cast<float>(o[c]) + half[c];
        slope[c] = static_cast<float>(a.q[c]) / 63.0f;
      }
      a.b = std::min(a.b, full.bound(centre, slope, half));
    }
    return encode(a, kFineSteps);
  }
  static std::uint32_t encode(const Affine& a, float steps) {
    const int c = static_cast<int>(std::floor(steps * std::max(a.b, -1e6f)));
    if (c < -512) return 64U | 64U << 7 | 64U << 14;  // never clear
    return static_cast<std::uint32_t>(std::min(c, 511) + 512) << 21 |
           static_cast<std::uint32_t>(a.q[0] + 64) | static_cast<std::uint32_t>(a.q[1] + 64) << 7 |
           static_cast<std::uint32_t>(a.q[2] + 64) << 14;
  }
  // All sites within kWindow of the block of 16³ number t.
  void gather(int t, SiteList& list) const {
    list.clear();
    const Int3 o = origin16(t);
    const Int3 b{o[0] / 16, o[1] / 16, o[2] / 16};
    for (int k = std::max(b[2] - 1, 0); k <= std::min(b[2] + 1, tops_[2] - 1); ++k)
      for (int j = std::max(b[1] - 1, 0); j <= std::min(b[1] + 1, tops_[1] - 1); ++j)
        for (int i = std::max(b[0] - 1, 0); i <= std::min(b[0] + 1, tops_[0] - 1); ++i)
          for (const Site& s :
               sites_[static_cast<std::size_t>((k * tops_[1] + j) * tops_[0] + i)]) {
            float d2 = 0;
            for (std::size_t a = 0; a < 3; ++a) {
              const float lo = world_.axis[a] * static_cast<float>(o[a]);
              const float hi = lo + 16.0f * world_.axis[a];
              const float d = std::max({0.0f, s.lo[a] - hi, lo - s.hi[a]});
              d2 += d * d;
            }
            if (d2 <= kWindow * kWindow) list.add(s);
          }
  }

  const DenseField& field_;
  FastWorld& world_;
  Int3 tops_{};
  float diagonal_ = 0, overhang_ = 0;
  std::vector<std::uint64_t> mask_, wide_;  // a bit a block of 4³: has a brick; a wide one
  std::vector<std::uint8_t> near_;
  std::vector<std::vector<Site>> sites_;
  std::vector<std::uint32_t> node_, first_;
  std::unique_ptr<DepthCodes> codes_;
};

double mebibytes(std::size_t bytes) {
  return static_cast<double>(bytes) / 1048576.0;
}

}  // namespace

void FastWorldDeleter::operator()(FastWorld* world) const {
  delete world;
}

FastWorldPointer prototypeWorld(const DenseField& field) {
  FastWorldPointer world(new FastWorld);
  const auto start = std::chrono::steady_clock::now();
  Builder(field, *world).run();
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  world->buildMs = took.count();
  std::printf("prototype: %zu bricks (%zu wide), %zu nodes, words %.2f, codes %.2f MiB, %.0f ms\n",
              world->bricks, world->wideBricks, world->nodes,
              mebibytes((world->top.size() + world->words.size()) * 8),
              mebibytes(world->codes.size()), world->buildMs);
  return world;
}

}  // namespace palpate::bench
