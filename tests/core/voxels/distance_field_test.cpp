#include "core/voxels/distance_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/voxels/test_volumes.h"

namespace palpate {
namespace {

using testing_volumes::assortedGrids;
using testing_volumes::solidOf;

// The definition itself: over all voxels of the other kind.
double exhaustive(const LabelGrid& grid, int i, int j, int k) {
  const GridGeometry& g = grid.geometry;
  const bool inside = grid.at(i, j, k) != 0;
  double best = HUGE_VAL;
  for (int z = 0; z < g.dims[2]; ++z) {
    for (int y = 0; y < g.dims[1]; ++y) {
      for (int x = 0; x < g.dims[0]; ++x) {
        if ((grid.at(x, y, z) != 0) == inside) continue;
        best = std::min(best, (g.centre_V(x, y, z) - g.centre_V(i, j, k)).norm());
      }
    }
  }
  const double d = best - 0.5 * g.spacing.minCoeff();
  return inside ? -d : d;
}

TEST(DistanceField, EqualsExhaustiveSearchOnAnisotropicGrids) {
  constexpr std::uint32_t kSeed = 20081;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  for (const auto& [name, grid] : assortedGrids(kSeed)) {
    SCOPED_TRACE(name);
    const auto field = signedDistanceField(grid.geometry, solidOf(grid));
    ASSERT_TRUE(field);
    for (int k = 0; k < grid.geometry.dims[2]; ++k) {
      for (int j = 0; j < grid.geometry.dims[1]; ++j) {
        for (int i = 0; i < grid.geometry.dims[0]; ++i) {
          const double expected = exhaustive(grid, i, j, k);
          const double found = (*field)[grid.geometry.index(i, j, k)];
          if (std::isinf(expected)) {
            // No other kind: the grid's diagonal stands for "far".
            Eigen::Vector3d edges;
            for (int a = 0; a < 3; ++a) {
              edges[a] = grid.geometry.spacing[a] * grid.geometry.dims[static_cast<std::size_t>(a)];
            }
            EXPECT_NEAR(found, std::copysign(edges.norm(), expected), 1e-8);
          } else {
            // Stored as float: 2e-7 of a length of a few centimetres.
            ASSERT_NEAR(found, expected, 2e-7 * std::abs(expected) + 1e-10)
                << i << " " << j << " " << k;
          }
        }
      }
    }
  }
}

TEST(DistanceField, CancelIsReported) {
  CancelToken token;
  token.cancel();
  Progress progress;
  progress.cancel = &token;
  const auto grids = assortedGrids(1);
  const auto field = signedDistanceField(grids[0].grid.geometry, solidOf(grids[0].grid), progress);
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace palpate
