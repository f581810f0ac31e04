#include "core/trade/coarse_labels.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

LabelGrid grid(std::array<std::int32_t, 3> dims, std::vector<std::uint8_t> labels) {
  LabelGrid made;
  made.geometry.dims = dims;
  made.geometry.spacing = {1e-3, 2e-3, 3e-3};
  made.geometry.X_PV = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY());
  made.labels = std::move(labels);
  return made;
}

TEST(CoarseLabels, TheCommonestOfAtLeastHalf) {
  EXPECT_EQ(coarseLabels(grid({2, 2, 2}, {1, 1, 2, 2, 2, 0, 0, 0}), 2).labels,
            (std::vector<std::uint8_t>{2}));
  EXPECT_EQ(coarseLabels(grid({2, 2, 2}, {1, 1, 2, 0, 0, 0, 0, 0}), 2).labels,
            (std::vector<std::uint8_t>{0}));
  EXPECT_EQ(coarseLabels(grid({2, 2, 2}, {3, 3, 1, 1, 0, 0, 0, 0}), 2).labels,
            (std::vector<std::uint8_t>{1}));
}

TEST(CoarseLabels, WhatIsLeftAtTheEndCountsByItself) {
  const LabelGrid coarse = coarseLabels(grid({3, 1, 1}, {0, 0, 5}), 2);
  EXPECT_EQ(coarse.geometry.dims, (std::array<std::int32_t, 3>{2, 1, 1}));
  EXPECT_EQ(coarse.labels, (std::vector<std::uint8_t>{0, 5}));
}

TEST(CoarseLabels, ACoarseVoxelIsWhereItsPartsAre) {
  const LabelGrid fine = grid({4, 4, 4}, std::vector<std::uint8_t>(64, 1));
  const LabelGrid coarse = coarseLabels(fine, 2);
  const Eigen::Vector3d parts =
      0.5 * (fine.geometry.centre_V(2, 0, 2) + fine.geometry.centre_V(3, 1, 3));
  EXPECT_LT((coarse.geometry.X_PV * coarse.geometry.centre_V(1, 0, 1) - fine.geometry.X_PV * parts)
                .norm(),
            1e-15);
}

}  // namespace
}  // namespace palpate
