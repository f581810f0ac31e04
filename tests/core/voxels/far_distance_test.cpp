#include "core/voxels/far_distance.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/core/voxels/exhaustive_distance.h"

namespace palpate {
namespace {

using testing_volumes::assortedAndDeepGrids;
using testing_volumes::bitsOf;
using testing_volumes::makeGrid;
using testing_volumes::NamedGrid;

constexpr std::uint32_t kSeed = 4711;

std::vector<NamedGrid> grids() {
  auto all = assortedAndDeepGrids(kSeed);
  std::mt19937 rng(kSeed);
  const auto rare = [&rng](int, int, int) { return rng() % 9000 == 0; };
  all.push_back({"wide", makeGrid({193, 34, 21}, Eigen::Vector3d(1, 1, 1), rare)});
  all.push_back({"thick slices", makeGrid({65, 33, 30}, Eigen::Vector3d(0.5, 0.5, 5), rare)});
  // Corners farther apart than what is told apart.
  all.push_back({"one corner", makeGrid({170, 9, 10}, Eigen::Vector3d(1, 1.3, 1),
                                        [](int i, int, int k) { return i == 0 && k == 9; })});
  return all;
}

double nearest(const std::vector<std::array<int, 3>>& solid, const Eigen::Vector3d& scale, int i,
               int j, int k) {
  double best = HUGE_VAL;
  for (const auto& s : solid) {
    const Eigen::Vector3d d(s[0] - i, s[1] - j, s[2] - k);
    best = std::min(best, d.cwiseProduct(scale).squaredNorm());
  }
  return std::sqrt(best);
}

TEST(FarDistance, IsExactWithinTheGridAndALowerBoundBeyond) {
  for (const auto& [name, grid] : grids()) {
    SCOPED_TRACE(name + ", seed " + std::to_string(kSeed));
    const auto& dims = grid.geometry.dims;
    const Eigen::Vector3d scale = grid.geometry.spacing / grid.geometry.spacing.minCoeff();
    std::vector<std::array<int, 3>> solid;
    for (int k = 0; k < dims[2]; ++k) {
      for (int j = 0; j < dims[1]; ++j) {
        for (int i = 0; i < dims[0]; ++i) {
          // Only the surface can be nearest to what is outside.
          const bool deep =
              i > 0 && j > 0 && k > 0 && i + 1 < dims[0] && j + 1 < dims[1] && k + 1 < dims[2] &&
              grid.at(i - 1, j, k) != 0 && grid.at(i + 1, j, k) != 0 && grid.at(i, j - 1, k) != 0 &&
              grid.at(i, j + 1, k) != 0 && grid.at(i, j, k - 1) != 0 && grid.at(i, j, k + 1) != 0;
          if (grid.at(i, j, k) != 0 && !deep) solid.push_back({i, j, k});
        }
      }
    }
    const DepthPalette palette(grid.geometry.spacing);
    const VoxelBits bits = bitsOf(grid);
    const FarDistance far(bits, palette);
    for (std::size_t a = 0; a < 3; ++a) {
      // The last sample is at or past the last voxel.
      EXPECT_GE((far.count()[a] - 1) * FarDistance::kStep, dims[a] - 1);
      EXPECT_LT((far.count()[a] - 2) * FarDistance::kStep, dims[a] - 1);
    }
    for (int k = 0; k < far.count()[2] + 2; ++k) {
      for (int j = 0; j < far.count()[1] + 2; ++j) {
        for (int i = 0; i < far.count()[0] + 2; ++i) {
          const auto found = static_cast<double>(far.at(i, j, k));
          const int at[3] = {4 * i, 4 * j, 4 * k};
          const bool inGrid = grid.geometry.contains(at[0], at[1], at[2]);
          const bool inside = inGrid && grid.at(at[0], at[1], at[2]) != 0;
          const double exact = inside ? 0.0 : nearest(solid, scale, at[0], at[1], at[2]);
          // Single precision of a square, then its root.
          ASSERT_LE(found, exact * (1 + 1e-6)) << i << " " << j << " " << k;
          if (inGrid && exact < static_cast<double>(FarDistance::kReach) * (1 - 1e-6)) {
            ASSERT_NEAR(found, exact, 1e-6 * exact) << i << " " << j << " " << k;
          } else if (inGrid) {
            ASSERT_GE(found, static_cast<double>(FarDistance::kReach) * (1 - 1e-6));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace palpate
