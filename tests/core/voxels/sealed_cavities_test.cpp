#include "core/voxels/sealed_cavities.h"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

constexpr int kVoxels = 24;

LabelGrid solidGrid() {
  LabelGrid grid;
  grid.geometry.dims = {kVoxels, kVoxels, kVoxels};
  grid.labels.assign(grid.geometry.voxelCount(), 0);
  for (int k = 1; k + 1 < kVoxels; ++k) {
    for (int j = 1; j + 1 < kVoxels; ++j) {
      for (int i = 1; i + 1 < kVoxels; ++i) grid.labels[grid.geometry.index(i, j, k)] = 1;
    }
  }
  return grid;
}

void free(LabelGrid& grid, int i, int j, int k) {
  grid.labels[grid.geometry.index(i, j, k)] = 0;
}

SolidLabels one() {
  SolidLabels solid{};
  solid[1] = true;
  return solid;
}

std::vector<bool> fillable(const LabelGrid& grid, LeafModel leaf) {
  const SealedCavities found = findSealedCavities(grid, one());
  return fillableCavities(grid, one(), found, std::vector<bool>(found.cavity.size(), true), leaf);
}

TEST(SealedCavities, AreFoundWithTheirVoxelsAndBox) {
  LabelGrid grid = solidGrid();
  free(grid, 10, 10, 10);
  free(grid, 11, 11, 11);  // by a corner: the same cavity
  free(grid, 11, 12, 11);
  free(grid, 16, 10, 10);
  const SealedCavities found = findSealedCavities(grid, one());
  ASSERT_EQ(found.cavity.size(), 2U);
  EXPECT_EQ(found.cavity[0].voxels, 3U);
  EXPECT_EQ(found.cavity[0].box, (VoxelBox{{10, 10, 10}, {12, 13, 12}}));
  EXPECT_EQ(found.cavity[0].wall, 1);
  EXPECT_EQ(found.cavity[1].voxels, 1U);
  std::size_t voxels = 0;
  for (const CavityRun& run : found.runs) voxels += run.count;
  EXPECT_EQ(voxels, 4U);
}

TEST(SealedCavities, AWayInAlongCornersIsAWayIn) {
  LabelGrid grid = solidGrid();
  free(grid, 10, 10, 10);
  EXPECT_EQ(findSealedCavities(grid, one()).cavity.size(), 1U);
  for (int at = 9; at >= 1; --at) free(grid, at, at, at);
  EXPECT_EQ(findSealedCavities(grid, one()).cavity.size(), 0U);
}

TEST(SealedCavities, AreThoseOfAFloodFromOutside) {
  constexpr unsigned kSeed = 41;
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  for (const double share : {0.05, 0.1, 0.12, 0.2}) {
    LabelGrid grid = solidGrid();
    std::bernoulli_distribution isFree(share);
    for (auto& label : grid.labels) label = static_cast<std::uint8_t>(isFree(random) ? 0 : label);
    // Free voxels that the flood from the border, by 26 neighbours, does not get to.
    const GridGeometry& g = grid.geometry;
    std::vector<std::uint8_t> met(grid.labels.size());
    std::vector<std::array<int, 3>> open;
    const auto visit = [&](int i, int j, int k) {
      if (!g.contains(i, j, k) || grid.at(i, j, k) != 0 || met[g.index(i, j, k)] != 0) return;
      met[g.index(i, j, k)] = 1;
      open.push_back({i, j, k});
    };
    for (int a = 0; a < kVoxels; ++a) {
      for (int b = 0; b < kVoxels; ++b) {
        for (const int end : {0, kVoxels - 1}) {
          visit(end, a, b);
          visit(a, end, b);
          visit(a, b, end);
        }
      }
    }
    while (!open.empty()) {
      const auto v = open.back();
      open.pop_back();
      for (int n = 0; n < 27; ++n) visit(v[0] + n % 3 - 1, v[1] + n / 3 % 3 - 1, v[2] + n / 9 - 1);
    }
    for (const CavityRun& run : findSealedCavities(grid, one()).runs) {
      for (std::uint32_t i = 0; i < run.count; ++i) {
        EXPECT_EQ(grid.labels[run.first + i], 0);
        EXPECT_EQ(met[run.first + i], 0);
        met[run.first + i] = 1;
      }
    }
    std::size_t missed = 0;
    for (std::size_t i = 0; i < met.size(); ++i) missed += grid.labels[i] == 0 && met[i] == 0;
    EXPECT_EQ(missed, 0U) << share;
  }
}

TEST(SealedCavities, BehindAThinWallTheyStay) {
  // Free voxels so many solid ones below the face: a distance leaf tells from two, a voxel leaf
  // reads one voxel farther.
  struct Row {
    int wall;
    bool distance, voxel;
  };
  for (const Row& row : {Row{1, true, false}, Row{2, true, false}, Row{3, true, true}}) {
    LabelGrid grid = solidGrid();
    for (int k = 8; k < 12; ++k) {
      for (int j = 8; j < 12; ++j) free(grid, 1 + row.wall, j, k);
    }
    EXPECT_EQ(fillable(grid, LeafModel::Distance)[0], row.distance) << row.wall;
    EXPECT_EQ(fillable(grid, LeafModel::Voxel)[0], row.voxel) << row.wall;
  }
}

TEST(SealedCavities, BesideAnInnerEdgeTheyStay) {
  // The solid voxel between is as far from a free one outside as its edge is long, nearer inside.
  LabelGrid grid = solidGrid();
  free(grid, 1, 10, 10);
  free(grid, 1, 11, 10);
  free(grid, 3, 12, 10);
  ASSERT_EQ(findSealedCavities(grid, one()).cavity.size(), 1U);
  EXPECT_FALSE(fillable(grid, LeafModel::Distance)[0]);
}

TEST(SealedCavities, OnlyThoseThatAreWantedAreAnswered) {
  LabelGrid grid = solidGrid();
  free(grid, 10, 10, 10);
  free(grid, 16, 10, 10);
  const SealedCavities found = findSealedCavities(grid, one());
  EXPECT_EQ(fillableCavities(grid, one(), found, {false, true}, LeafModel::Distance),
            (std::vector<bool>{false, true}));
  EXPECT_EQ(fillableCavities(grid, one(), found, {false, false}, LeafModel::Distance),
            (std::vector<bool>{false, false}));
}

}  // namespace
}  // namespace palpate
