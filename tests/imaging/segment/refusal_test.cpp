/// What each tool refuses, and that nothing has changed then.

#include <limits>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
const Eigen::Vector3d kIn(2, 2, 2);

/// 5³ voxels of 1 mm, the middle 3³ the label; one voxel of bone.
Sample cube() {
  Sample s = plainSample({5, 5, 5}, {1, 1, 1});
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Voxel v = voxelOf(s.geometry(), i);
    const auto middle = [](int x) { return x >= 1 && x <= 3; };
    if (middle(v.i) && middle(v.j) && middle(v.k)) s.before.labels.labels[i] = kValue;
  }
  s.before.labels.labels[0] = 1;
  return s;
}

tool::Scissors scissors() {
  tool::Scissors tool;
  tool.view(0, 0) = 1.0;
  tool.view(1, 1) = 1.0;
  tool.view(2, 3) = 1.0;
  tool.outline = {{0.5, 0.5}, {1.5, 0.5}, {0.5, 1.5}};
  return tool;
}

void expectUsage(const std::vector<std::pair<std::string, LabelTool>>& rows) {
  for (const auto& [name, tool] : rows) {
    SCOPED_TRACE(name);
    expectRefused(cube(), tool, ErrorKind::Usage);
  }
}

TEST(Refusal, Lengths) {
  using Margin = tool::Margin;
  for (const double mm : {-1.0, -1e-9, kNan, kInf, -kInf}) {
    SCOPED_TRACE(mm);
    for (const auto operation : {Margin::Operation::Dilate, Margin::Operation::Erode,
                                 Margin::Operation::Open, Margin::Operation::Close}) {
      expectRefused(cube(), Margin{.operation = operation, .mm = mm}, ErrorKind::Usage);
    }
    expectRefused(cube(), tool::Smooth{.mm = mm}, ErrorKind::Usage);
    expectRefused(cube(), tool::Smooth{.mm = mm, .keepThin = false}, ErrorKind::Usage);
    expectRefused(cube(), tool::Brush{.path_mm = {kIn}, .radius_mm = mm}, ErrorKind::Usage);
    expectRefused(cube(), tool::GrowRegion{.seeds_mm = {kIn}, .range = {0, 0}, .reach_mm = mm},
                  ErrorKind::Usage);
    expectRefused(cube(), tool::Combine{.other = "bone", .grown_mm = mm}, ErrorKind::Usage);
  }
}

TEST(Refusal, LengthsBeyondTheLargest) {
  constexpr double kMost_mm = 200.0;
  EXPECT_TRUE(applied(cube(), tool::Margin{.mm = kMost_mm}));
  EXPECT_TRUE(applied(cube(), tool::Brush{.path_mm = {kIn}, .radius_mm = kMost_mm}));
  const double mm = kMost_mm + 0.01;
  expectUsage({{"margin", tool::Margin{.mm = mm}},
               {"smooth", tool::Smooth{.mm = mm}},
               {"brush", tool::Brush{.path_mm = {kIn}, .radius_mm = mm}},
               {"combine", tool::Combine{.other = "bone", .grown_mm = mm}},
               {"grow", tool::GrowRegion{.seeds_mm = {kIn}, .range = {0, 0}, .reach_mm = 10000.1}},
               {"split", tool::Split{.seeds = {{kLabel, {kIn}}}, .radius_mm = 50.01}}});
  EXPECT_TRUE(applied(cube(), tool::Split{.seeds = {{kLabel, {kIn}}}, .radius_mm = 50.0}));
}

TEST(Refusal, MorePartsThanASplitHas) {
  tool::Split tool;
  tool.seeds.assign(250, {kLabel, {kIn}});
  EXPECT_TRUE(applied(cube(), tool));
  tool.seeds.push_back(tool.seeds.back());
  expectUsage({{"split", tool}});
}

TEST(Refusal, Volumes) {
  for (const double mm3 : {-1.0, -1e-9, kNan}) {
    SCOPED_TRACE(mm3);
    expectRefused(cube(), tool::FillHoles{.maxMm3 = mm3}, ErrorKind::Usage);
    expectRefused(cube(), tool::Islands{.keep = tool::Islands::Keep::AtLeast, .minMm3 = mm3},
                  ErrorKind::Usage);
    expectRefused(cube(), tool::Threshold{.range = {0, 0}, .minMm3 = mm3}, ErrorKind::Usage);
  }
}

TEST(Refusal, Ranges) {
  for (const ThresholdRange& range :
       {ThresholdRange{1, 0}, ThresholdRange{kNan, 3}, ThresholdRange{0, kNan}}) {
    SCOPED_TRACE(std::to_string(range.low) + " to " + std::to_string(range.high));
    expectUsage({{"threshold", tool::Threshold{.range = range}},
                 {"grow", tool::GrowRegion{.seeds_mm = {kIn}, .range = range}}});
    EditLimits limits;
    limits.only = range;
    expectRefused(cube(), tool::Margin{}, ErrorKind::Usage, limits);
    expectRefused(cube(), tool::Threshold{.range = {0, 0}}, ErrorKind::Usage, limits);
  }
}

TEST(Refusal, WhatIsMissing) {
  tool::Scissors two = scissors();
  two.outline.pop_back();
  tool::Scissors none = scissors();
  none.outline.clear();
  expectUsage({{"no seeds", tool::GrowRegion{.range = {0, 0}}},
               {"no path", tool::Brush{}},
               {"an outline of two points", two},
               {"no outline", none},
               {"nothing to split by", tool::Split{}},
               {"a label without seeds", tool::Split{.seeds = {{kLabel, {kIn}}, {"bone", {}}}}}});
  // Whether this is a wrong call or an empty label is not said.
  EXPECT_FALSE(applied(cube(), tool::Islands{.keep = tool::Islands::Keep::Picked}));
  EXPECT_FALSE(applied(cube(), tool::Islands{.count = 0}));
}

TEST(Refusal, NumbersThatAreNone) {
  std::vector<std::pair<std::string, LabelTool>> rows;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d bad = kIn;
    bad[axis] = kNan;
    rows.emplace_back("box low", tool::Box{.low_mm = bad, .high_mm = kIn});
    rows.emplace_back("box high", tool::Box{.low_mm = kIn, .high_mm = bad});
    rows.emplace_back("normal", tool::Brush{.path_mm = {kIn}, .normal = bad});
  }
  rows.emplace_back("no direction",
                    tool::Brush{.path_mm = {kIn}, .normal = Eigen::Vector3d::Zero()});
  tool::Scissors view = scissors();
  view.view(1, 2) = kNan;
  rows.emplace_back("view", view);
  tool::Scissors outline = scissors();
  outline.outline[1].y() = kNan;
  rows.emplace_back("outline", outline);
  tool::Scissors plane = scissors();
  plane.plane_mm = Eigen::Vector4d(0, 0, kNan, 1);
  rows.emplace_back("plane", plane);
  for (const double depth : {-1.0, kNan}) {
    tool::Scissors deep = scissors();
    deep.plane_mm = Eigen::Vector4d(0, 0, 1, 0);
    deep.depth_mm = depth;
    rows.emplace_back("depth", deep);
  }
  expectUsage(rows);
}

TEST(Refusal, ABoxUpsideDown) {
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d high = kIn - Eigen::Vector3d::Unit(axis);
    expectUsage({{"box", tool::Box{.low_mm = kIn, .high_mm = high}}});
  }
}

/// A point that is no number is refused, as a wrong call or as a point outside the scan.
TEST(Refusal, PointsThatAreNone) {
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::Vector3d point = kIn;
      point[axis] = bad;
      EXPECT_FALSE(applied(cube(), tool::GrowRegion{.seeds_mm = {kIn, point}, .range = {0, 0}}));
      EXPECT_FALSE(applied(cube(), tool::Brush{.path_mm = {kIn, point}}));
      for (const auto keep : {tool::Islands::Keep::Picked, tool::Islands::Keep::NotPicked}) {
        EXPECT_FALSE(applied(cube(), tool::Islands{.keep = keep, .picks_mm = {kIn, point}}));
      }
      EXPECT_FALSE(applied(cube(), tool::Split{.seeds = {{kLabel, {kIn}}, {"bone", {point}}}}));
    }
  }
}

TEST(Refusal, ALabelThatIsNotThere) {
  const std::vector<LabelTool> tools{
      tool::Islands{},
      tool::FillHoles{},
      tool::Margin{},
      tool::Smooth{},
      tool::Box{.low_mm = kIn, .high_mm = kIn},
      scissors(),
      tool::Brush{.path_mm = {kIn}, .erase = true},
      tool::Split{.seeds = {{"bone", {kIn}}, {"molar", {kIn}}}},
      tool::Combine{.operation = tool::Combine::Operation::Subtract, .other = "bone"},
      tool::Remove{}};
  for (const LabelTool& tool : tools) {
    SCOPED_TRACE(toolTitle(tool));
    expectRefused(cube(), tool, ErrorKind::InputRefused, {}, "molar");
    Sample empty = cube();
    empty.before = {};
    expectRefused(empty, tool, ErrorKind::InputRefused, {}, "molar");
  }
}

TEST(Refusal, AStepThatWouldLeaveTheLabelEmpty) {
  tool::Scissors all = scissors();
  all.outline = {{-9, -9}, {30, -9}, {-9, 30}};
  tool::Scissors none = all;
  none.outline = {{50, 50}, {60, 50}, {50, 60}};
  none.keepInside = true;
  const Eigen::Vector3d far(9, 9, 9);
  const std::vector<LabelTool> tools{
      tool::Threshold{.range = {5, 6}},
      tool::Threshold{.range = {0, 0}, .minMm3 = 1000.0},
      tool::Islands{.keep = tool::Islands::Keep::AtLeast, .minMm3 = 27.5},
      tool::Islands{.keep = tool::Islands::Keep::NotPicked, .picks_mm = {kIn}},
      tool::Margin{.operation = tool::Margin::Operation::Erode, .mm = 2.0},
      tool::Margin{.operation = tool::Margin::Operation::Open, .mm = 2.0},
      tool::Smooth{.mm = 3.0, .keepThin = false},
      tool::Box{.low_mm = -far, .high_mm = far},
      tool::Box{.low_mm = far, .high_mm = far, .keepInside = true},
      all,
      none,
      tool::Brush{.path_mm = {kIn}, .radius_mm = 9.0, .erase = true},
      tool::Split{.seeds = {{"bone", {kIn}}}},
      tool::Combine{.operation = tool::Combine::Operation::Intersect, .other = "bone"},
      tool::Combine{
          .operation = tool::Combine::Operation::Subtract, .other = "bone", .grown_mm = 9.0}};
  for (std::size_t n = 0; n < tools.size(); ++n) {
    SCOPED_TRACE(std::to_string(n) + ": " + toolTitle(tools[n]));
    expectRefused(cube(), tools[n], ErrorKind::InputRefused);
  }
}

TEST(Refusal, SaysWhatToDo) {
  for (const LabelTool& tool :
       std::vector<LabelTool>{tool::Margin{.mm = -1.0},
                              tool::Islands{.keep = tool::Islands::Keep::AtLeast, .minMm3 = 1e6},
                              tool::GrowRegion{.seeds_mm = {{99, 0, 0}}, .range = {0, 0}},
                              tool::Combine{.other = "x"}}) {
    const auto after = applied(cube(), tool);
    ASSERT_FALSE(after);
    const Error& error = after.error();
    EXPECT_TRUE(error.expected.has_value() || error.advice.has_value()) << sentence(error);
  }
}

}  // namespace
}  // namespace palpate::test
