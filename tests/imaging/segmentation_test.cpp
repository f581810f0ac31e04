#include "imaging/segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <queue>
#include <random>

#include "imaging/archive.h"
#include "imaging/components.h"
#include "imaging/import.h"
#include "imaging/volume_files.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/volume_samples.h"

namespace palpate {
namespace {

Volume valuesVolume(std::array<std::int32_t, 3> dims, std::vector<std::int16_t> values) {
  Volume v;
  v.geometry.dims = dims;
  v.geometry.spacing = Eigen::Vector3d(1, 2, 3) * 1e-3;
  v.int16 = std::move(values);
  return v;
}

TEST(Segment, BothEndsAreInside) {
  const Volume v = valuesVolume({5, 1, 1}, {9, 10, 15, 20, 21});
  const auto labels = segment(v, nullptr, 3, {.range = {10, 20}});
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels->labels, (std::vector<std::uint8_t>{0, 3, 3, 3, 0}));
}

TEST(Segment, ReplacesItsLabelTakesOverOthersAndLeavesTheRest) {
  const Volume v = valuesVolume({4, 1, 1}, {0, 50, 50, 0});
  LabelGrid before;
  before.geometry = v.geometry;
  before.labels = {1, 2, 0, 2};
  const auto labels = segment(v, &before, 1, {.range = {40, 60}});
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels->labels, (std::vector<std::uint8_t>{0, 1, 1, 2}));
}

TEST(Segment, NothingSelectedSaysTheRange) {
  const Volume v = valuesVolume({3, 1, 1}, {-5, 0, 100});
  const auto labels = segment(v, nullptr, 1, {.range = {226, 3071}});
  ASSERT_FALSE(labels);
  EXPECT_EQ(
      sentence(labels.error()),
      "The threshold selects nothing. Field: threshold. Found: 226 to 3071. Expected: a range "
      "that overlaps the volume's values, -5 to 100. Choose a range within the volume's "
      "values.");
  EXPECT_EQ(exitCode(labels.error().kind), 3);
}

TEST(Segment, SwappedThresholdIsAUsageError) {
  const Volume v = valuesVolume({1, 1, 1}, {0});
  const auto labels = segment(v, nullptr, 1, {.range = {5, 1}});
  ASSERT_FALSE(labels);
  EXPECT_EQ(labels.error().kind, ErrorKind::Usage);
}

TEST(Segment, LargestTouchesByCorners) {
  // Two voxels that touch at an edge are one part; the third stands alone.
  const Volume v = valuesVolume({3, 3, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 0});
  Volume far = v;
  far.geometry.dims = {5, 3, 1};
  far.int16 = {1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0};
  const auto labels = segment(far, nullptr, 1, {.range = {1, 1}, .largestOnly = true});
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels->labels,
            (std::vector<std::uint8_t>{1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Segment, SmallPartsAreDroppedByVolume) {
  // A voxel is 6 mm³: parts of one (6 mm³) go at 7, parts of two (12 mm³) stay.
  const Volume v = valuesVolume({7, 1, 1}, {1, 0, 0, 1, 1, 0, 0});
  const auto labels = segment(v, nullptr, 1, {.range = {1, 1}, .minMm3 = 7.0});
  ASSERT_TRUE(labels);
  EXPECT_EQ(labels->labels, (std::vector<std::uint8_t>{0, 0, 0, 1, 1, 0, 0}));
  const auto none = segment(v, nullptr, 1, {.range = {1, 1}, .minMm3 = 100.0});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message,
            "Every part in the range is smaller than the smallest part to keep.");
}

TEST(Segment, StopsWhenCancelled) {
  CancelToken token;
  token.cancel();
  Progress progress;
  progress.cancel = &token;
  const auto labels =
      segment(valuesVolume({1, 1, 1}, {0}), nullptr, 1, {.range = {0, 1}}, progress);
  ASSERT_FALSE(labels);
  EXPECT_EQ(labels.error().kind, ErrorKind::Cancelled);
}

/// Oracle: flood fill, voxel by voxel.
std::vector<std::uint64_t> floodSizes(std::vector<std::uint8_t> mask,
                                      const std::array<std::int32_t, 3>& d) {
  GridGeometry g;
  g.dims = d;
  std::vector<std::uint64_t> sizes;
  for (std::int32_t z = 0; z < d[2]; ++z)
    for (std::int32_t y = 0; y < d[1]; ++y)
      for (std::int32_t x = 0; x < d[0]; ++x) {
        if (mask[g.index(x, y, z)] == 0) continue;
        sizes.push_back(0);
        std::queue<std::array<std::int32_t, 3>> todo;
        todo.push({x, y, z});
        mask[g.index(x, y, z)] = 0;
        while (!todo.empty()) {
          const auto p = todo.front();
          todo.pop();
          ++sizes.back();
          for (int n = 0; n < 27; ++n) {
            const std::int32_t i = p[0] + n % 3 - 1;
            const std::int32_t j = p[1] + n / 3 % 3 - 1;
            const std::int32_t k = p[2] + n / 9 - 1;
            if (!g.contains(i, j, k) || mask[g.index(i, j, k)] == 0) continue;
            mask[g.index(i, j, k)] = 0;
            todo.push({i, j, k});
          }
        }
      }
  return sizes;
}

TEST(Components, EqualFloodFillOnRandomMasks) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    const std::array<std::int32_t, 3> d{static_cast<std::int32_t>(1 + random() % 12),
                                        static_cast<std::int32_t>(1 + random() % 12),
                                        static_cast<std::int32_t>(1 + random() % 12)};
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(d[0] * d[1] * d[2]));
    const auto share = 3 + random() % 30;  // per cent set: from dust to one lump
    for (auto& m : mask) m = random() % 100 < share ? 1 : 0;
    const MaskParts parts = findParts(mask, d);
    EXPECT_EQ(parts.voxels, floodSizes(mask, d));
    std::size_t inRuns = 0;
    for (const MaskRun& run : parts.runs) {
      inRuns += static_cast<std::size_t>(run.last - run.first + 1);
    }
    EXPECT_EQ(inRuns, static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1)));
  }
}

TEST(Presets, UnknownNameIsRefusedWithTheList) {
  const auto range = presetRange("bone", valuesVolume({1, 1, 1}, {0}));
  ASSERT_FALSE(range);
  EXPECT_EQ(sentence(range.error()),
            "There is no such preset. Field: preset. Found: bone. Expected: ct-bone, "
            "ct-soft-tissue, ct-skin, ct-air, mr-brain, mr-tissue. Choose one of these, or give a "
            "threshold.");
  EXPECT_EQ(range.error().kind, ErrorKind::Usage);
}

TEST(Presets, BoneOfTheDemoCtEqualsInVesaliusMask) {
  PALPATE_NEEDS(test::demoCt(), "Debian package invesalius-examples");
  const auto scan = importScan({.path = test::demoCt()});
  ASSERT_TRUE(scan);
  const auto labels =
      segment(scan->volume, nullptr, 1, {.range = *presetRange("ct-bone", scan->volume)});
  ASSERT_TRUE(labels);
  // InVesalius keeps its masks with a border of one voxel at the low end of each axis, rows flipped
  // like the matrix; 253 to 255 are inside, 0 to 2 outside.
  const auto mask = readArchiveMember(test::demoCt(), "mask_0.dat", 109 * 257 * 257);
  ASSERT_TRUE(mask) << sentence(mask.error());
  std::size_t both = 0;
  std::size_t ours = 0;
  std::size_t theirs = 0;
  for (int z = 0; z < 108; ++z)
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const auto m = static_cast<std::uint8_t>(
            (*mask)[static_cast<std::size_t>((z + 1) * 257 * 257 + (255 - y + 1) * 257 + x + 1)]);
        const bool a = labels->at(x, y, z) == 1;
        const bool b = m > 127;
        ours += a ? 1 : 0;
        theirs += b ? 1 : 0;
        both += a && b ? 1 : 0;
      }
  const double dice = 2.0 * static_cast<double>(both) / static_cast<double>(ours + theirs);
  std::cout << "bone: " << ours << " voxels, InVesalius " << theirs << ", Dice " << dice << "\n";
  EXPECT_GT(dice, 0.999);
}

TEST(Presets, MrOfTheDemoHeadGivesAHead) {
  PALPATE_NEEDS(test::demoMr(), "Debian package mricron-data");
  const auto v = readVolumeFile(test::demoMr());
  ASSERT_TRUE(v);
  const double total = static_cast<double>(v->size()) * v->geometry.spacing.prod() * 1e9;
  for (const char* preset : {"mr-brain", "mr-tissue"}) {
    const auto range = presetRange(preset, *v);
    ASSERT_TRUE(range);
    const auto labels = segment(*v, nullptr, 1, {.range = *range, .largestOnly = true});
    ASSERT_TRUE(labels);
    const auto counts = countLabels(*labels, {LabelInfo{.name = "x"}});
    // ch2bet is the same head with everything but the brain set to zero.
    const auto brain = readVolumeFile(test::demoMr().parent_path() / "ch2bet.nii.gz");
    ASSERT_TRUE(brain);
    std::size_t inBrain = 0;
    for (std::size_t i = 0; i < brain->size(); ++i) {
      inBrain += labels->labels[i] != 0 && brain->int16[i] > 0 ? 1 : 0;
    }
    std::cout << static_cast<double>(inBrain) / static_cast<double>(counts[0].voxels)
              << " of it in the brain; ";
    std::cout << preset << ": " << range->low << " to " << range->high << ", "
              << counts[0].mm3 / 1000.0 << " ml of " << total / 1000.0 << "\n";
    EXPECT_GT(counts[0].mm3, 0.5e6) << preset;  // half a litre
    EXPECT_LT(counts[0].mm3, 0.7 * total) << preset;
  }
}

TEST(CountLabels, GivesVoxelsAndVolume) {
  LabelGrid grid;
  grid.geometry.dims = {4, 1, 1};
  grid.geometry.spacing = Eigen::Vector3d(1, 2, 3) * 1e-3;
  grid.labels = {0, 5, 5, 1};
  const auto counts =
      countLabels(grid, {LabelInfo{.name = "a", .value = 5}, LabelInfo{.name = "b", .value = 9}});
  ASSERT_EQ(counts.size(), 2U);
  EXPECT_EQ(counts[0].voxels, 2U);
  EXPECT_NEAR(counts[0].mm3, 12.0, 1e-9);
  EXPECT_EQ(counts[1].voxels, 0U);
}

}  // namespace
}  // namespace palpate
