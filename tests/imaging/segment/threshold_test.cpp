/// tool::Threshold against the values, one by one, and parts found breadth first.

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

Mask maskOfRange(const Volume& volume, const ThresholdRange& range) {
  Mask mask(volume.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = inRange(volume, i, range) ? 1 : 0;
  return mask;
}

/// What selects nothing may be refused (segment() does), also where `only` would keep the label.
void expectSelected(const Sample& s, const tool::Threshold& tool, const EditLimits& limits,
                    const Mask& wanted) {
  (countOf(wanted) == 0 ? expectEditOrRefusal : expectEdit)(s, tool, limits, wanted, {}, true);
}

TEST(ThresholdTool, IsTheRangeWhateverLabelsWereThere) {
  forSamples(400, [](Random& random, Sample& s) {
    const tool::Threshold tool{.range = randomRange(random)};
    expectSelected(s, tool, randomLimits(random), maskOfRange(s.volume, tool.range));
  });
}

TEST(ThresholdTool, DropsPartsSmallerThanAskedFor) {
  forSamples(300, [](Random& random, Sample& s) {
    const int voxels = random.whole(0, 5);
    tool::Threshold tool{.range = randomRange(random)};
    // Between two counts of voxels, so that rounding decides nothing.
    tool.minMm3 = (voxels + 0.5) * voxelMm3(s.geometry());
    Mask wanted(s.size(), 0);
    for (const Part& part : partsOf(maskOfRange(s.volume, tool.range), s.geometry(), 26)) {
      if (part.size() <= static_cast<std::size_t>(voxels)) continue;
      for (const std::size_t i : part) wanted[i] = 1;
    }
    expectSelected(s, tool, randomLimits(random), wanted);
  });
}

TEST(ThresholdTool, KeepsTheLargestPart) {
  forSamples(300, [](Random& random, Sample& s) {
    tool::Threshold tool{.range = randomRange(random), .largestOnly = true};
    const std::vector<Part> parts = partsOf(maskOfRange(s.volume, tool.range), s.geometry(), 26);
    std::size_t largest = 0;
    for (const Part& part : parts) largest = std::max(largest, part.size());
    if (std::count_if(parts.begin(), parts.end(),
                      [&](const Part& part) { return part.size() == largest; }) > 1) {
      return;  // Any of them.
    }
    if (random.chance(30)) tool.minMm3 = random.whole(0, 8) * 1.01 * voxelMm3(s.geometry());
    Mask wanted(s.size(), 0);
    for (const Part& part : parts) {
      const double mm3 = static_cast<double>(part.size()) * voxelMm3(s.geometry());
      if (part.size() < largest || mm3 < tool.minMm3) continue;
      for (const std::size_t i : part) wanted[i] = 1;
    }
    expectSelected(s, tool, randomLimits(random), wanted);
  });
}

TEST(ThresholdTool, KeepsOnePartOfEqualOnes) {
  Sample s = plainSample({5, 1, 1}, {1, 1, 1});
  s.volume.int16 = {1, 1, 0, 1, 1};
  const auto after = applied(s, tool::Threshold{.range = {1, 1}, .largestOnly = true});
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(voxelsOf(after->labels, kValue), 2U);
  EXPECT_EQ(after->labels.labels[0], after->labels.labels[1]);
}

TEST(ThresholdTool, RangesBetweenAndBeyondTheStoredValues) {
  Sample s = plainSample({6, 1, 1}, {1, 2, 3});
  s.volume.int16 = {-32768, -1, 0, 2, 3, 32767};
  const auto labelled = [&](double low, double high) {
    const auto after = applied(s, tool::Threshold{.range = {low, high}});
    EXPECT_TRUE(after) << low << " to " << high;
    std::string text;
    for (std::size_t i = 0; after && i < 6; ++i) {
      text += after->labels.labels[i] == kValue ? '#' : '.';
    }
    return text;
  };
  EXPECT_EQ(labelled(-1e6, 1e6), "######");
  EXPECT_EQ(labelled(0.5, 2.5), "...#..");
  EXPECT_EQ(labelled(-0.5, 2.0), "..##..");
  EXPECT_EQ(labelled(-40000, -0.5), "##....");
  EXPECT_EQ(labelled(3, 65536), "....##");
  expectRefused(s, tool::Threshold{.range = {0.25, 0.75}}, ErrorKind::InputRefused);
}

TEST(ThresholdTool, APresetGivesTheRange) {
  Sample s = plainSample({5, 1, 1}, {1, 1, 1});
  s.volume.int16 = {225, 226, 3071, 3072, 0};
  LabelStep step;
  step.label = kLabel;
  step.tool = tool::Threshold{.range = {0, 0}};
  step.preset = "ct-bone";
  const auto after = applyStep(s.volume, s.before, step);
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(after->labels.labels, (Mask{0, kValue, kValue, 0, 0}));
  step.preset = "ct-wood";
  const auto unknown = applyStep(s.volume, s.before, step);
  ASSERT_FALSE(unknown);
  EXPECT_NE(sentence(unknown.error()).find("ct-bone"), std::string::npos);
}

TEST(ThresholdTool, AnMrPresetIsComputedFromTheVolume) {
  Sample s = plainSample({64, 4, 1}, {1, 1, 1});
  s.volume.modality = "MR";
  for (std::size_t i = 0; i < s.size(); ++i) {
    s.volume.int16[i] = static_cast<std::int16_t>((i < 100 ? 0 : 500) + static_cast<int>(i % 7));
  }
  LabelStep step;
  step.label = kLabel;
  step.preset = "mr-tissue";
  const auto after = applyStep(s.volume, s.before, step);
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(voxelsOf(after->labels, kValue), s.size() - 100);
  EXPECT_EQ(after->labels.labels[99], 0);
}

}  // namespace
}  // namespace palpate::test
