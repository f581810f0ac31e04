/// tool::Combine and tool::Remove against sets of voxels.

#include <algorithm>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

using Operation = tool::Combine::Operation;
constexpr std::array<Operation, 3> kOperations{Operation::Add, Operation::Subtract,
                                               Operation::Intersect};

/// Every voxel within `mm` of one of the other label, by all pairs.
Mask grownOther(const Sample& s, std::uint8_t value, double mm) {
  Mask out(s.size(), 0);
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (s.before.labels.labels[i] != value) continue;
    out[i] = 1;
    for (std::size_t j = 0; j < s.size() && mm > 0.0; ++j) {
      if ((centre_mm(s.geometry(), i) - centre_mm(s.geometry(), j)).norm() <= mm) out[j] = 1;
    }
  }
  return out;
}

TEST(Combine, IsArithmeticOfSets) {
  forSamples(400, [](Random& random, Sample& s) {
    for (const Operation operation : kOperations) {
      const bool bone = random.chance(50);
      tool::Combine tool{.operation = operation, .other = bone ? "bone" : "nerve"};
      const std::uint8_t value = bone ? 1 : 9;
      if (random.chance(60)) tool.grown_mm = random.real(0.3, 5.0);
      SCOPED_TRACE("operation " + std::to_string(static_cast<int>(operation)) + " with " +
                   tool.other + " grown by " + std::to_string(tool.grown_mm));
      const Mask other = grownOther(s, value, tool.grown_mm);
      Mask wanted = s.label();
      for (std::size_t i = 0; i < s.size(); ++i) {
        if (operation == Operation::Add && other[i] != 0) wanted[i] = 1;
        if (operation == Operation::Subtract && other[i] != 0) wanted[i] = 0;
        if (operation == Operation::Intersect && other[i] == 0) wanted[i] = 0;
      }
      const EditLimits limits = randomLimits(random);
      // The other's voxels are taken whatever the limits say of labels; a third label's are not.
      LabelGrid expected = edited(s, limits, wanted);
      for (std::size_t i = 0; i < s.size(); ++i) {
        const bool may = !limits.only || inRange(s.volume, i, *limits.only);
        if (operation == Operation::Add && may && s.before.labels.labels[i] == value) {
          expected.labels[i] = kValue;
        }
      }
      const auto after = applied(s, tool, limits);
      if (voxelsOf(expected, kValue) == 0) {
        ASSERT_FALSE(after);
        EXPECT_EQ(after.error().kind, ErrorKind::InputRefused);
        continue;
      }
      ASSERT_TRUE(after) << sentence(after.error()) << "\n" << describe(s);
      EXPECT_TRUE(sameLabels(expected, after->labels)) << describe(s);
      EXPECT_TRUE(sameTable(after->table, s.before.table)) << "the other's row stays";
    }
  });
}

TEST(Combine, AnotherLabelWithoutVoxelsIsTheEmptySet) {
  Sample s = plainSample({3, 1, 1}, {1, 1, 1});
  s.before.labels.labels = {kValue, 0, 1};
  for (const double mm : {0.0, 2.0}) {
    for (const Operation operation : {Operation::Add, Operation::Subtract}) {
      const auto after =
          applied(s, tool::Combine{.operation = operation, .other = "nerve", .grown_mm = mm});
      ASSERT_TRUE(after) << sentence(after.error());
      EXPECT_TRUE(sameLabels(s.before.labels, after->labels));
    }
    expectRefused(s, tool::Combine{.operation = Operation::Intersect, .other = "nerve"},
                  ErrorKind::InputRefused);
  }
}

TEST(Combine, AWholeNumberOfVoxelsOfGrowthIsReached) {
  for (const int mm : {1, 2, 9, 13, 18}) {
    Sample s = plainSample({60, 1, 1}, {1, 1, 1});
    for (auto& label : s.before.labels.labels) label = kValue;
    s.before.labels.labels[30] = 9;
    const auto after = applied(s, tool::Combine{.operation = Operation::Subtract,
                                                .other = "nerve",
                                                .grown_mm = static_cast<double>(mm)});
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_EQ(voxelsOf(after->labels, kValue), static_cast<std::size_t>(60 - 2 * mm - 1)) << mm;
  }
}

TEST(Combine, ALabelWithItselfIsRefused) {
  Sample s = plainSample({3, 1, 1}, {1, 1, 1});
  s.before.labels.labels = {0, kValue, kValue};
  for (const auto operation : {tool::Combine::Operation::Add, tool::Combine::Operation::Subtract,
                               tool::Combine::Operation::Intersect}) {
    for (const double mm : {0.0, 1.0}) {
      expectRefused(s, tool::Combine{.operation = operation, .other = kLabel, .grown_mm = mm},
                    ErrorKind::InputRefused);
    }
  }
}

TEST(Combine, ALabelThatIsNotThereIsRefused) {
  Sample s = plainSample({3, 1, 1}, {1, 1, 1});
  s.before.labels.labels = {kValue, 9, 1};
  for (const Operation operation : kOperations) {
    expectRefused(s, tool::Combine{.operation = operation, .other = "Bone"},
                  ErrorKind::InputRefused);
  }
}

TEST(Remove, TakesTheLabelAndItsRow) {
  forSamples(200, [](Random& random, Sample& s) {
    LabelGrid expected = s.before.labels;
    for (auto& label : expected.labels) label = label == kValue ? std::uint8_t{0} : label;
    LabelTable table = s.before.table;
    table.erase(table.begin() + 1);
    EditLimits limits;
    limits.overOthers = random.chance(50);
    const auto after = applied(s, tool::Remove{}, limits);
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_TRUE(sameLabels(expected, after->labels));
    EXPECT_TRUE(sameTable(table, after->table));
  });
  const Sample s = plainSample({3, 1, 1}, {1, 1, 1});
  expectRefused(s, tool::Remove{}, ErrorKind::InputRefused, {}, "molar");
}

/// Whatever Remove makes of limits, no voxel of a value without a row may be left.
TEST(Remove, LeavesNoVoxelWithoutARow) {
  Sample s = plainSample({4, 1, 1}, {1, 1, 1});
  s.volume.int16 = {1, 2, 3, 4};
  s.before.labels.labels = {kValue, kValue, 9, 1};
  EditLimits limits;
  limits.only = ThresholdRange{2, 4};
  const auto after = applied(s, tool::Remove{}, limits);
  if (!after) return;
  for (const std::uint8_t label : after->labels.labels) {
    EXPECT_TRUE(label == 0 || std::any_of(after->table.begin(), after->table.end(),
                                          [&](const LabelInfo& row) { return row.value == label; }))
        << static_cast<int>(label);
  }
}

}  // namespace
}  // namespace palpate::test
