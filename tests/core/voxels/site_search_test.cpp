#include "core/voxels/site_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace palpate {
namespace {

constexpr std::uint32_t kSeed = 77;

double length(const Float3& v) {
  return std::sqrt(static_cast<double>(v[0]) * static_cast<double>(v[0]) +
                   static_cast<double>(v[1]) * static_cast<double>(v[1]) +
                   static_cast<double>(v[2]) * static_cast<double>(v[2]));
}
double distance(const Float3& a, const Float3& b) {
  return length({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

struct World {
  SiteSearch search;
  std::vector<Float3> points;  // each of them is in some site
  std::vector<SiteBounds> sites;
};

// Boxes about the size of a cell, most of them cut by a plane, and points that lie in them.
void addRandomSites(std::mt19937& rng, World& world, int groups, int perGroup, float spread) {
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int g = 0; g < groups; ++g) {
    world.search.beginGroup();
    const Float3 middle{spread * uniform(rng), spread * uniform(rng), spread * uniform(rng)};
    const int count = 1 + static_cast<int>(rng() % static_cast<std::uint32_t>(perGroup));
    for (int s = 0; s < count; ++s) {
      SiteBounds site;
      Float3 inside{};
      for (std::size_t a = 0; a < 3; ++a) {
        site.lo[a] = middle[a] + 2 * uniform(rng);
        site.hi[a] = site.lo[a] + (rng() % 5 == 0 ? 0.0f : 1.2f * std::abs(uniform(rng)));
        inside[a] = site.lo[a] + (site.hi[a] - site.lo[a]) * (0.5f + 0.4f * uniform(rng));
      }
      if (rng() % 4 != 0) {
        const float size = std::max(1e-3f, std::abs(uniform(rng)));
        site.n = {uniform(rng), uniform(rng), uniform(rng)};
        const auto norm = static_cast<float>(length(site.n));
        const float to = (rng() % 2 == 0 ? 1.0f : size) * 0.9999f / std::max(norm, 1e-3f);
        site.h = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          site.n[a] *= to;
          site.h += site.n[a] * inside[a];
        }
        site.h += 1e-5f;
      }
      world.search.add(site);
      world.sites.push_back(site);
      world.points.push_back(inside);
      for (int p = 0; p < 200; ++p) {
        Float3 q{};
        float along = 0;
        for (std::size_t a = 0; a < 3; ++a) {
          const float w = std::clamp(0.5f + 0.7f * uniform(rng), 0.0f, 1.0f);  // faces too
          q[a] = std::min(site.lo[a] + (site.hi[a] - site.lo[a]) * w, site.hi[a]);
          along += site.n[a] * q[a];
        }
        if (along <= site.h) world.points.push_back(q);
      }
    }
    world.search.endGroup();
  }
}

TEST(SiteSearch, TheBoundNeverExceedsTheDistance) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int trial = 0; trial < 600; ++trial) {
    World world;
    addRandomSites(rng, world, 1 + static_cast<int>(rng() % 5), 1 + trial % 21,
                   static_cast<float>(trial % 9));
    const Float3 c{6 * uniform(rng), 6 * uniform(rng), 6 * uniform(rng)};
    const Float3 half{2 * std::abs(uniform(rng)), 2 * std::abs(uniform(rng)),
                      2 * std::abs(uniform(rng))};
    Float3 g{uniform(rng), uniform(rng), uniform(rng)};
    const double norm = length(g);
    if (trial % 4 == 0) g = {0, 0, 0};
    if (trial % 4 != 0 && (norm > 1 || trial % 4 == 1)) {
      for (float& v : g) v = static_cast<float>(static_cast<double>(v) / norm * (1 - 1e-6));
    }
    const auto bound = static_cast<double>(world.search.bound(c, g, half));
    for (int s = 0; s < 40; ++s) {
      Float3 u{};
      double claimed = bound;
      for (std::size_t a = 0; a < 3; ++a) {
        // Corners of the box first, where an affine bound is tight.
        const float w = s < 8 ? ((s >> a & 1) != 0 ? 1.0f : -1.0f) : uniform(rng);
        u[a] = c[a] + w * half[a];
        claimed += static_cast<double>(g[a]) * static_cast<double>(u[a] - c[a]);
      }
      for (const Float3& p : world.points) {
        ASSERT_LE(claimed, distance(u, p) + 2e-5) << "trial " << trial;
      }
    }
  }
}

TEST(SiteSearch, OfABoxSeenFromAPointIsItsDistance) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (int trial = 0; trial < 500; ++trial) {
    SiteSearch search;
    std::vector<SiteBounds> boxes(1 + rng() % 40);
    for (std::size_t s = 0; s < boxes.size(); ++s) {
      if (s % 7 == 0) search.beginGroup();
      for (std::size_t a = 0; a < 3; ++a) {
        boxes[s].lo[a] = 5 * uniform(rng);
        boxes[s].hi[a] = boxes[s].lo[a] + std::abs(uniform(rng));
      }
      search.add(boxes[s]);
      if (s % 7 == 6 || s + 1 == boxes.size()) search.endGroup();
    }
    const Float3 c{9 * uniform(rng), 9 * uniform(rng), 9 * uniform(rng)};
    double expected = HUGE_VAL;
    for (const SiteBounds& box : boxes) {
      Float3 near{};
      for (std::size_t a = 0; a < 3; ++a) near[a] = std::clamp(c[a], box.lo[a], box.hi[a]);
      expected = std::min(expected, distance(c, near));
    }
    // The largest bound that is found, here the true one less what covers rounding.
    EXPECT_NEAR(static_cast<double>(search.bound(c, {0, 0, 0}, {0, 0, 0})), expected, 2e-4)
        << "trial " << trial;
  }
}

TEST(SiteSearch, WithoutASiteEverythingIsFar) {
  SiteSearch search;
  EXPECT_TRUE(search.empty());
  EXPECT_EQ(search.bound({0, 0, 0}, {0, 0, 0}, {1, 1, 1}), SiteSearch::kNothing);
  search.beginGroup();
  search.add({{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, SiteBounds::kNoPlane});
  search.endGroup();
  EXPECT_FALSE(search.empty());
  EXPECT_LT(search.bound({0, 0, 3}, {0, 0, 0}, {1, 1, 1}), 1.0001f);
  search.clear();
  EXPECT_TRUE(search.empty());
  EXPECT_EQ(search.bound({0, 0, 0}, {0, 0, 0}, {1, 1, 1}), SiteSearch::kNothing);
}

}  // namespace
}  // namespace palpate
