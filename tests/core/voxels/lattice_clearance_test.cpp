#include "core/voxels/lattice_clearance.h"

#include <gtest/gtest.h>

#include <string>

#include "core/voxels/banded_distance.h"
#include "tests/core/voxels/contact_region.h"

namespace palpate {
namespace {

using testing_volumes::assortedAndDeepGrids;
using testing_volumes::bitsOf;
using testing_volumes::ContactRegion;
using testing_volumes::makeGrid;
using testing_volumes::placeIn;

constexpr std::uint32_t kSeed = 2718;

void expectBelow(const LatticeBound& bound, const ContactRegion& region,
                 const std::array<int, 3>& low, int cells, std::mt19937& rng, int places) {
  for (int n = 0; n < places; ++n) {
    const Eigen::Vector3d u = placeIn(rng, low, cells);
    double sloped = static_cast<double>(bound.sloped);
    double slope2 = 0;
    for (int a = 0; a < 3; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      const double g = bound.slopes[axis] / 63.0;
      slope2 += g * g;
      sloped += g * (u[a] - low[axis] - 0.5 * cells) * region.edge()[a];
    }
    EXPECT_LE(slope2, 1 + 1e-9);
    if (static_cast<double>(bound.level) <= 0 && sloped <= 0) continue;
    const double distance = region.distance(u);
    ASSERT_LE(static_cast<double>(bound.level), distance + 1e-4)
        << "block at " << low[0] << " " << low[1] << " " << low[2] << ", u " << u.transpose();
    ASSERT_LE(sloped, distance + 1e-4)
        << "block at " << low[0] << " " << low[1] << " " << low[2] << ", u " << u.transpose();
  }
}

TEST(LatticeClearance, BoundsNeverExceedTheDistanceToTheContactRegion) {
  auto grids = assortedAndDeepGrids(kSeed);
  std::mt19937 rng(kSeed);
  grids.push_back({"thick slices", makeGrid({34, 33, 19}, Eigen::Vector3d(0.5, 0.5, 4),
                                            [&rng](int, int, int) { return rng() % 1500 == 0; })});
  // Blocks with nothing in them, at all distances from the region, straight and slanting.
  grids.push_back({"a corner", makeGrid({85, 50, 37}, Eigen::Vector3d::Ones(),
                                        [](int i, int j, int k) { return i + j + k < 3; })});
  grids.push_back(
      {"a slope", makeGrid({50, 66, 50}, Eigen::Vector3d(1, 1.2, 1),
                           [](int i, int j, int k) { return i + 2 * j + 3 * k < 70; })});
  for (const auto& [name, grid] : grids) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    const ContactRegion region(grid);
    const DepthPalette palette(grid.geometry.spacing);
    const VoxelBits solid = bitsOf(grid);
    const FarDistance far(solid, palette);
    BandedDistance distance(solid, palette, kLatticeReach);
    std::vector<float> square;
    const auto& dims = grid.geometry.dims;
    distance.slab(0, dims[2], square);
    const SquareView view{square.data(), {0, 0, 0}, dims};
    LatticeClearance lattice(palette, dims, far);
    int useful = 0;
    for (int z = 0; 16 * z + 1 < dims[2]; ++z) {
      for (int y = 0; 16 * y + 1 < dims[1]; ++y) {
        for (int x = 0; 16 * x + 1 < dims[0]; ++x) {
          const std::array<int, 3> low{16 * x, 16 * y, 16 * z};
          expectBelow(lattice.coarseBound({x, y, z}), region, low, 16, rng, 24);
          if (!lattice.read(view, {x, y, z}, kLatticeReach)) continue;
          for (int child = 0; child < 64; ++child) {
            if (rng() % 3 != 0) continue;
            const std::array<int, 3> at{low[0] + 4 * (child & 3), low[1] + 4 * (child >> 2 & 3),
                                        low[2] + 4 * (child >> 4)};
            if (at[0] + 1 >= dims[0] || at[1] + 1 >= dims[1] || at[2] + 1 >= dims[2]) continue;
            const LatticeBound bound = lattice.bound(child);
            useful += bound.best() > 0 ? 1 : 0;
            expectBelow(bound, region, at, 4, rng, 4);
            if (HasFatalFailure()) return;
          }
        }
      }
    }
    if (name == "dust") {
      EXPECT_GT(useful, 20);
    }
  }
}

TEST(LatticeClearance, ABlockIsNearWhereAVoxelInsideIs) {
  const auto grid = makeGrid({80, 20, 20}, Eigen::Vector3d::Ones(),
                             [](int i, int j, int k) { return i == 2 && j == 3 && k == 4; });
  const DepthPalette palette(grid.geometry.spacing);
  const VoxelBits solid = bitsOf(grid);
  const FarDistance far(solid, palette);
  BandedDistance distance(solid, palette, kLatticeReach);
  std::vector<float> square;
  distance.slab(0, 20, square);
  const SquareView view{square.data(), {0, 0, 0}, grid.geometry.dims};
  LatticeClearance lattice(palette, grid.geometry.dims, far);
  EXPECT_TRUE(lattice.read(view, {0, 0, 0}, 4.0f));
  EXPECT_FALSE(lattice.read(view, {1, 0, 0}, 4.0f));  // 14 away
  EXPECT_FALSE(lattice.read(view, {4, 0, 0}, 4.0f));
  // Ten voxels and more from 16 .. 32: half a voxel's worth of region is nearer than its centre.
  EXPECT_GT(lattice.coarseBound({4, 0, 0}).best(), 20.0f);
}

}  // namespace
}  // namespace palpate
