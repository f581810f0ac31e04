#include "core/voxels/region_site.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace palpate {
namespace {

constexpr std::uint32_t kSeed = 1201;

double valueAt(const std::array<float, 8>& corner, const double (&w)[3]) {
  double sum = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    double weight = 1;
    for (std::size_t a = 0; a < 3; ++a) weight *= (c >> a & 1) != 0 ? w[a] : 1 - w[a];
    sum += weight * static_cast<double>(corner[c]);
  }
  return sum;
}

// Corner values as voxels make them, and others: one sign hardly, flat, huge against tiny.
std::array<float, 8> randomCorners(std::mt19937& rng) {
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::array<float, 8> corner{};
  const int kind = static_cast<int>(rng() % 6);
  const auto mask = static_cast<std::uint32_t>(rng());
  const float tilt[3] = {2 * uniform(rng), 2 * uniform(rng), 2 * uniform(rng)};
  const float middle = uniform(rng);
  for (std::uint32_t c = 0; c < 8; ++c) {
    const float sign = (mask >> c & 1U) != 0 ? 1.0f : -1.0f;
    switch (kind) {
      case 0:
        corner[c] = 3 * uniform(rng);
        break;
      case 1:
        corner[c] = sign * 0.5f;
        break;  // neighbours of the other kind on all sides
      case 2:
        corner[c] = sign * (std::sqrt(static_cast<float>(1 + rng() % 4)) - 0.5f);
        break;
      case 3:
        corner[c] = sign * std::pow(10.0f, 1.7f * uniform(rng));
        break;
      case 4:  // a plane
        corner[c] = middle;
        for (std::uint32_t a = 0; a < 3; ++a) {
          corner[c] += ((c >> a & 1U) != 0 ? 0.5f : -0.5f) * tilt[a];
        }
        break;
      default:
        corner[c] = c == mask % 8 ? -0.5f : 0.5f + std::abs(uniform(rng));
        break;
    }
  }
  return corner;
}

TEST(RegionSite, BoxAndPlaneHoldEveryPointOfTheRegion) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<double> uniform(0, 1);
  int sites = 0;
  for (int trial = 0; trial < 12000; ++trial) {
    const std::array<float, 8> corner = randomCorners(rng);
    std::array<float, 3> edge{1, 1, 1};
    if (trial % 2 == 0) {
      for (float& e : edge) e = static_cast<float>(1 + 3 * uniform(rng));
      edge[static_cast<std::size_t>(trial / 2 % 3)] = 1;
    }
    const float slack = trial % 3 == 0 ? 0.0f : 1e-3f;
    RegionSite site;
    const bool reaches = siteOfCell(corner, edge, slack, site);
    sites += reaches ? 1 : 0;
    double n[3];
    for (std::size_t a = 0; a < 3; ++a) {
      n[a] = static_cast<double>(site.n[a]) / static_cast<double>(RegionSite::kNormalSteps);
    }
    if (reaches) {
      ASSERT_LE(std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), 1 + 1e-12) << trial;
    }
    const int steps = 8;  // a lattice with faces and corners, then points of no pattern
    for (int s = 0; s < (steps + 1) * (steps + 1) * (steps + 1) + 200; ++s) {
      double w[3] = {uniform(rng), uniform(rng), uniform(rng)};
      if (s < (steps + 1) * (steps + 1) * (steps + 1)) {
        w[0] = static_cast<double>(s % (steps + 1)) / steps;
        w[1] = static_cast<double>(s / (steps + 1) % (steps + 1)) / steps;
        w[2] = static_cast<double>(s / (steps + 1) / (steps + 1)) / steps;
      }
      // Within rounding of the slack either may be said.
      if (valueAt(corner, w) >= static_cast<double>(slack) - 1e-6) continue;
      ASSERT_TRUE(reaches) << "trial " << trial;
      double along = 0;
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_GE(w[a] * 255, site.lo[a] - 1e-4) << "trial " << trial << ", axis " << a;
        ASSERT_LE(w[a] * 255, site.hi[a] + 1e-4) << "trial " << trial << ", axis " << a;
        along += n[a] * w[a] * static_cast<double>(edge[a]);
      }
      ASSERT_LE(along * static_cast<double>(RegionSite::kPlaneSteps), site.h + 1e-3)
          << "trial " << trial;
    }
  }
  EXPECT_GT(sites, 9000);
}

TEST(RegionSite, OfAPlaneIsThatPlane) {
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 rng(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  int cut = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<float, 3> n{uniform(rng), uniform(rng), uniform(rng)};
    const float norm = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (norm < 0.1f) continue;
    const float offset = uniform(rng);
    std::array<float, 8> corner{};
    for (std::uint32_t c = 0; c < 8; ++c) {
      corner[c] = -offset;
      for (std::uint32_t a = 0; a < 3; ++a) {
        corner[c] += n[a] / norm * ((c >> a & 1U) != 0 ? 0.5f : -0.5f);
      }
    }
    const bool negative = std::any_of(corner.begin(), corner.end(), [](float v) { return v < 0; });
    const bool positive = std::any_of(corner.begin(), corner.end(), [](float v) { return v > 0; });
    RegionSite site;
    const bool reaches = siteOfCell(corner, {1, 1, 1}, 0.0f, site);
    EXPECT_EQ(reaches, negative);
    if (!negative || !positive || !reaches) continue;
    ++cut;
    // Not only sound: of a plane no more is lost than the steps of its numbers. Where box or plane
    // leaves space, look how far the farthest point of their intersection is above the true plane.
    float farthest = -10;
    for (int s = 0; s < 17 * 17 * 17; ++s) {
      const int at[3] = {s % 17, s / 17 % 17, s / 289};
      float along = 0;
      float value = -offset;
      bool in = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const float w = static_cast<float>(at[a]) / 16;
        in = in && w * 255 >= static_cast<float>(site.lo[a]) &&
             w * 255 <= static_cast<float>(site.hi[a]);
        along += static_cast<float>(site.n[a]) / 127 * w;
        value += n[a] / norm * (w - 0.5f);
      }
      if (in && along * 512 <= static_cast<float>(site.h)) farthest = std::max(farthest, value);
    }
    ASSERT_LT(farthest, 0.03f) << "trial " << trial;  // 1/127 a component
  }
  EXPECT_GT(cut, 1000);
}

}  // namespace
}  // namespace palpate
