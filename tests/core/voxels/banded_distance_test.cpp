#include "core/voxels/banded_distance.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/core/voxels/exhaustive_distance.h"

namespace palpate {
namespace {

using testing_volumes::assortedAndDeepGrids;
using testing_volumes::bitsOf;
using testing_volumes::kNoOther;
using testing_volumes::makeGrid;
using testing_volumes::NamedGrid;
using testing_volumes::signedSquares;

constexpr std::uint32_t kSeed = 515;

std::vector<NamedGrid> grids() {
  auto all = assortedAndDeepGrids(kSeed);
  std::mt19937 rng(kSeed);
  // Rows around whole vectors and words; slices that hold one kind only.
  for (const std::int32_t x : {15, 16, 17, 63, 64, 65, 130}) {
    all.push_back({"row of " + std::to_string(x),
                   makeGrid({x, 5, 7}, Eigen::Vector3d(1, 1.7, 1.2),
                            [&rng](int, int, int k) { return k == 3 ? 1 : rng() % 60 == 0; })});
  }
  return all;
}

// All slices in slabs of this height.
std::vector<float> inSlabs(BandedDistance& distance, std::int32_t slices, std::int32_t height,
                           std::size_t slice) {
  std::vector<float> all;
  std::vector<float> slab;
  for (std::int32_t z = 0; z < slices; z += height) {
    const std::int32_t last = std::min(z + height, slices);
    distance.slab(z, last, slab);
    EXPECT_GE(slab.size(), slice * static_cast<std::size_t>(last - z));
    all.insert(all.end(), slab.begin(),
               slab.begin() + static_cast<std::ptrdiff_t>(slice) * (last - z));
  }
  return all;
}

TEST(BandedDistance, InTheBandIsTheExhaustiveOneToTheBit) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    const DepthPalette palette(grid.geometry.spacing);
    const VoxelBits solid = bitsOf(grid);
    const auto exact = signedSquares(grid, palette.weight());
    const double diagonal = (grid.geometry.spacing / grid.geometry.spacing.minCoeff()).norm();
    const std::size_t slice = exact.size() / static_cast<std::size_t>(grid.geometry.dims[2]);
    for (const float outside : {0.0f, 5.0f, 9.0f, 12.5f}) {
      BandedDistance distance(solid, palette, outside);
      const auto found = inSlabs(distance, grid.geometry.dims[2], 16, slice);
      ASSERT_EQ(found.size(), exact.size());
      const double reach = std::max(static_cast<double>(outside), diagonal * (1 - 1e-6));
      for (std::size_t v = 0; v < exact.size(); ++v) {
        ASSERT_EQ(found[v] > 0, grid.labels[v] == 0) << v;
        if (exact[v] > 0 && std::sqrt(static_cast<double>(exact[v])) > reach) {
          // Only says so: not nearer than the band reaches.
          ASSERT_GE(std::sqrt(static_cast<double>(found[v])), reach) << v;
        } else if (exact[v] < -palette.deepSquare()) {
          ASSERT_LE(found[v], -palette.deepSquare()) << v;
          ASSERT_EQ(palette.codeOf(found[v]), palette.deepestCode()) << v;
        } else {
          ASSERT_EQ(found[v], exact[v]) << v << ", outside " << outside;
        }
      }
    }
  }
}

// "Inside: the palette's saturation and a diagonal."
TEST(BandedDistance, TheBandReachesADiagonalBeyondSaturation) {
  for (const auto& [name, grid] : assortedAndDeepGrids(kSeed)) {
    SCOPED_TRACE(name);
    const DepthPalette palette(grid.geometry.spacing);
    const double diagonal = (grid.geometry.spacing / grid.geometry.spacing.minCoeff()).norm();
    EXPECT_GE(std::sqrt(static_cast<double>(palette.deepSquare())), 16.5 + diagonal - 1e-3);
  }
}

TEST(BandedDistance, SlabsOfAnyHeightGiveTheSameValues) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    const DepthPalette palette(grid.geometry.spacing);
    const VoxelBits solid = bitsOf(grid);
    const std::int32_t slices = grid.geometry.dims[2];
    const std::size_t slice =
        grid.geometry.voxelCount() / static_cast<std::size_t>(grid.geometry.dims[2]);
    BandedDistance whole(solid, palette, 9.0f);
    const auto expected = inSlabs(whole, slices, slices, slice);
    for (const std::int32_t height : {1, 2, 3, 5, 16, 17}) {
      BandedDistance distance(solid, palette, 9.0f);
      EXPECT_EQ(inSlabs(distance, slices, height, slice), expected) << height;
    }
    // With gaps between, and overlapping as the builder's blocks do.
    BandedDistance distance(solid, palette, 9.0f);
    std::vector<float> slab;
    for (std::int32_t z = 0; z < slices; z += 4) {
      const std::int32_t last = std::min(z + 7, slices);
      distance.slab(z, last, slab);
      for (std::size_t v = 0; v < slice * static_cast<std::size_t>(last - z); ++v) {
        ASSERT_EQ(slab[v], expected[v + slice * static_cast<std::size_t>(z)]);
      }
      z += z % 3 == 0 ? 11 : 0;
    }
  }
}

TEST(BandedDistance, AGridOfOneKindIsBeyondTheBandEverywhere) {
  for (const Eigen::Vector3d& spacing : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 2.2, 1.4)}) {
    const DepthPalette palette(spacing);
    for (const bool inside : {false, true}) {
      const auto grid = makeGrid({67, 12, 29}, spacing, [&](int, int, int) { return inside; });
      const VoxelBits solid = bitsOf(grid);
      BandedDistance distance(solid, palette, 9.0f);
      std::vector<float> out;
      distance.slab(0, 29, out);
      for (const float v : out) {
        if (inside) {
          ASSERT_EQ(palette.codeOf(v), palette.deepestCode());
        } else {
          ASSERT_GE(v, 81.0f);
        }
      }
    }
  }
}

}  // namespace
}  // namespace palpate
