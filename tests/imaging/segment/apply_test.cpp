/// What every tool has in common: rows, cancel, progress, threads, what it leaves alone.

#include "imaging/segment/apply.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "tests/imaging/segment/samples.h"

namespace palpate::test {
namespace {

/// A head of sorts: a shell of bone, a tooth of two lobes with a hollow, a nerve, in some noise.
Sample head() {
  Sample s = plainSample({72, 68, 60}, {0.6, 0.7, 0.8});
  s.volume.geometry.X_PV.linear() =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  s.volume.geometry.X_PV.translation() = Eigen::Vector3d(-20, 10, 33) * 1e-3;
  s.before.labels.geometry = s.volume.geometry;
  Random random(11);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Voxel v = voxelOf(s.geometry(), i);
    const Eigen::Vector3d p(v.i, v.j, v.k);
    const double outer = (p - Eigen::Vector3d(36, 34, 30)).norm();
    const double lobe = std::min((p - Eigen::Vector3d(28, 34, 30)).norm(),
                                 (p - Eigen::Vector3d(46, 34, 30)).norm());
    double value = 20.0;
    auto& label = s.before.labels.labels[i];
    if (outer > 25.0 && outer < 28.0) {
      label = 1;
      value = 800.0;
    }
    if (lobe < 10.0 && lobe > 3.0) {
      label = kValue;
      value = 1500.0 - 60.0 * lobe;
    }
    if (v.j < 12 && v.i > 50) label = 9;
    if (random.chance(2)) label = label == 0 ? kValue : label;
    s.volume.int16[i] = static_cast<std::int16_t>(value + random.whole(-40, 40));
  }
  return s;
}

struct NamedStep {
  std::string name;
  LabelStep step;
};

/// One or more of every tool; none leaves the label empty.
std::vector<NamedStep> everyTool(const Sample& s) {
  const auto at = [&](double i, double j, double k) { return at_mm(s.geometry(), i, j, k); };
  std::vector<NamedStep> steps;
  const auto add = [&](const std::string& name, LabelTool tool) {
    LabelStep step;
    step.label = kLabel;
    step.tool = std::move(tool);
    steps.push_back({name, step});
  };
  add("threshold", tool::Threshold{.range = {700, 3000}});
  add("threshold, largest", tool::Threshold{.range = {700, 3000}, .largestOnly = true});
  add("threshold, parts", tool::Threshold{.range = {700, 3000}, .minMm3 = 5.0});
  add("grow", tool::GrowRegion{.seeds_mm = {at(28, 41, 30)}, .range = {0, 3000}});
  add("grow, reach",
      tool::GrowRegion{.seeds_mm = {at(28, 41, 30)}, .range = {-100, 3000}, .reach_mm = 9.0});
  add("islands, largest", tool::Islands{.count = 2});
  add("islands, at least", tool::Islands{.keep = tool::Islands::Keep::AtLeast, .minMm3 = 1.0});
  add("islands, picked",
      tool::Islands{.keep = tool::Islands::Keep::Picked, .picks_mm = {at(28, 41, 30)}});
  add("islands, not picked",
      tool::Islands{.keep = tool::Islands::Keep::NotPicked, .picks_mm = {at(28, 41, 30)}});
  add("fill holes", tool::FillHoles{});
  add("fill holes, small", tool::FillHoles{.maxMm3 = 45.0});
  for (const auto operation : {tool::Margin::Operation::Dilate, tool::Margin::Operation::Erode,
                               tool::Margin::Operation::Open, tool::Margin::Operation::Close}) {
    add("margin " + std::to_string(static_cast<int>(operation)),
        tool::Margin{.operation = operation, .mm = 1.5});
  }
  add("smooth", tool::Smooth{.mm = 1.0, .keepThin = false});
  add("smooth, thin kept", tool::Smooth{.mm = 1.0});
  add("box", tool::Box{.low_mm = at(28, 34, 30) - Eigen::Vector3d(4, 4, 4),
                       .high_mm = at(28, 34, 30) + Eigen::Vector3d(5, 6, 7),
                       .allLabels = true});
  tool::Scissors scissors;
  scissors.view.block<3, 3>(0, 0).setIdentity();
  scissors.view(2, 3) = 200.0;
  scissors.outline = {{-0.2, -0.2}, {0.1, -0.2}, {0.0, 0.3}};
  add("scissors", scissors);
  add("brush", tool::Brush{.path_mm = {at(10, 10, 10), at(60, 40, 50)}, .radius_mm = 3.0});
  add("brush, disk", tool::Brush{.path_mm = {at(10, 10, 10), at(60, 40, 10)},
                                 .radius_mm = 3.0,
                                 .normal = s.geometry().X_PV.linear().col(2)});
  add("brush, erase",
      tool::Brush{.path_mm = {at(30, 34, 30), at(33, 34, 30)}, .radius_mm = 4.0, .erase = true});
  for (const auto by : {tool::Split::By::Brightness, tool::Split::By::Edges}) {
    tool::Split split{.by = by};
    split.seeds = {{"molar", {at(46, 41, 30)}}, {kLabel, {at(28, 41, 30)}}};
    add(by == tool::Split::By::Edges ? "split by edges" : "split by brightness", split);
  }
  add("combine", tool::Combine{.other = "nerve"});
  add("combine, grown",
      tool::Combine{
          .operation = tool::Combine::Operation::Subtract, .other = "bone", .grown_mm = 2.0});
  add("remove", tool::Remove{});
  return steps;
}

TEST(ApplyStep, EveryToolIsInTheList) {
  std::set<std::size_t> kinds;
  for (const auto& [name, step] : everyTool(head())) kinds.insert(step.tool.index());
  EXPECT_EQ(kinds.size(), std::variant_size_v<LabelTool>);
}

TEST(ApplyStep, ToolsHaveDifferentTitles) {
  std::set<std::string> titles;
  for (const auto& [name, step] : everyTool(head())) titles.insert(toolTitle(step.tool));
  EXPECT_EQ(titles.size(), std::variant_size_v<LabelTool>);
  EXPECT_FALSE(titles.contains(""));
  EXPECT_EQ(toolTitle(tool::Threshold{}), "Threshold");
  EXPECT_EQ(toolTitle(tool::FillHoles{}), "Fill holes");
}

TEST(ApplyStep, OtherLabelsStayUnlessTheToolMayTakeThem) {
  const Sample s = head();
  for (const auto& [name, step] : everyTool(s)) {
    SCOPED_TRACE(name);
    const bool takes = std::holds_alternative<tool::Threshold>(step.tool) ||
                       std::holds_alternative<tool::Combine>(step.tool) || name == "box";
    const auto after = applyStep(s.volume, s.before, step);
    ASSERT_TRUE(after) << sentence(after.error());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < s.size(); ++i) {
      const std::uint8_t was = s.before.labels.labels[i];
      changed += after->labels.labels[i] != was ? 1 : 0;
      if (takes || was == 0 || was == kValue) continue;
      ASSERT_EQ(after->labels.labels[i], was) << i;
    }
    EXPECT_GT(changed, 0U) << "the step does nothing here and tests nothing";
    EXPECT_EQ(after->labels.geometry.dims, s.geometry().dims);
    EXPECT_EQ(after->labels.geometry.spacing, s.geometry().spacing);
  }
}

TEST(ApplyStep, OnlyVoxelsOfTheRangeChange) {
  const Sample s = head();
  for (auto [name, step] : everyTool(s)) {
    if (std::holds_alternative<tool::Remove>(step.tool)) continue;
    SCOPED_TRACE(name);
    step.limits.only = ThresholdRange{0, 30};
    step.limits.overOthers = true;
    const auto free = applyStep(s.volume, s.before, step);
    ASSERT_TRUE(free) << sentence(free.error());
    step.limits.only.reset();
    const auto all = applyStep(s.volume, s.before, step);
    ASSERT_TRUE(all) << sentence(all.error());
    for (std::size_t i = 0; i < s.size(); ++i) {
      const bool in = s.volume.int16[i] >= 0 && s.volume.int16[i] <= 30;
      ASSERT_EQ(free->labels.labels[i], in ? all->labels.labels[i] : s.before.labels.labels[i])
          << i << " of value " << s.volume.int16[i];
    }
  }
}

TEST(ApplyStep, ACancelledStepIsCancelled) {
  const Sample s = head();
  for (const auto& [name, step] : everyTool(s)) {
    SCOPED_TRACE(name);
    CancelToken token;
    token.cancel();
    const LabelState before = s.before;
    const auto after = applyStep(s.volume, s.before, step, {.cancel = &token});
    ASSERT_FALSE(after);
    EXPECT_EQ(after.error().kind, ErrorKind::Cancelled);
    EXPECT_TRUE(sameState(before, s.before));
  }
}

TEST(ApplyStep, CancelsInTheMiddle) {
  const Sample s = head();
  for (const auto& [name, step] : everyTool(s)) {
    // At the first word, at half of the words, at the last one before the end.
    std::vector<double> fractions;
    Progress listen;
    listen.report = [&](double fraction, const std::string&) { fractions.push_back(fraction); };
    ASSERT_TRUE(applyStep(s.volume, s.before, step, listen)) << name;
    const auto words = static_cast<std::size_t>(
        std::count_if(fractions.begin(), fractions.end(), [](double f) { return f < 1.0; }));
    for (const std::size_t at : {std::size_t{1}, words / 2}) {
      if (at == 0 || at > words) continue;
      SCOPED_TRACE(name + ", word " + std::to_string(at) + " of " + std::to_string(words));
      CancelToken token;
      std::size_t heard = 0;
      Progress progress;
      progress.cancel = &token;
      progress.report = [&](double, const std::string&) {
        if (++heard == at) token.cancel();
      };
      const LabelState before = s.before;
      const auto after = applyStep(s.volume, s.before, step, progress);
      EXPECT_TRUE(sameState(before, s.before));
      ASSERT_FALSE(after) << "went on after the cancel";
      EXPECT_EQ(after.error().kind, ErrorKind::Cancelled);
    }
  }
}

TEST(ApplyStep, ProgressOnlyGrows) {
  const Sample s = head();
  for (const auto& [name, step] : everyTool(s)) {
    SCOPED_TRACE(name);
    std::mutex mutex;
    double last = 0.0;
    std::size_t words = 0;
    Progress progress;
    progress.report = [&](double fraction, const std::string& what) {
      const std::scoped_lock lock(mutex);
      EXPECT_GE(fraction, last) << what;
      EXPECT_LE(fraction, 1.0) << what;
      EXPECT_FALSE(what.empty());
      last = fraction;
      ++words;
    };
    ASSERT_TRUE(applyStep(s.volume, s.before, step, progress));
    EXPECT_GT(words, 0U) << "no word of progress";
  }
}

TEST(ApplyStep, TheNumberOfThreadsChangesNoVoxel) {
  const Sample s = head();
  for (const auto& [name, step] : everyTool(s)) {
    SCOPED_TRACE(name);
    Result<LabelState> one = applyStep(s.volume, s.before, step);
    ASSERT_TRUE(one);
    const LabelState usual = *one;
    {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
      one = applyStep(s.volume, s.before, step);
    }
    ASSERT_TRUE(one);
    EXPECT_TRUE(sameState(usual, *one)) << "one thread";
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 7);
    tbb::task_arena arena(7);
    for (int times = 0; times < 3; ++times) {
      arena.execute([&] { one = applyStep(s.volume, s.before, step); });
      ASSERT_TRUE(one);
      EXPECT_TRUE(sameState(usual, *one)) << "seven threads";
    }
  }
}

TEST(ApplyStep, AFloat32ScanOfTheSameValuesGivesTheSame) {
  Sample s = head();
  Sample f = s;
  f.volume.type = VoxelType::Float32;
  f.volume.float32.assign(s.volume.int16.begin(), s.volume.int16.end());
  f.volume.int16.clear();
  for (const auto& [name, step] : everyTool(s)) {
    SCOPED_TRACE(name);
    const auto whole = applyStep(s.volume, s.before, step);
    const auto real = applyStep(f.volume, f.before, step);
    ASSERT_TRUE(whole && real);
    EXPECT_TRUE(sameState(*whole, *real));
  }
}

/// The same anatomy in another place of the room: positions move along, voxels stay.
TEST(ApplyStep, TheScansPoseChangesNothing) {
  const Sample s = head();
  Sample moved = s;
  moved.volume.geometry.X_PV = Eigen::Translation3d(0.3, -0.2, 0.1) *
                               Eigen::AngleAxisd(1.9, Eigen::Vector3d(3, -1, 2).normalized()) *
                               s.geometry().X_PV;
  moved.before.labels.geometry = moved.volume.geometry;
  const std::vector<NamedStep> here = everyTool(s);
  const std::vector<NamedStep> there = everyTool(moved);
  for (std::size_t n = 0; n < here.size(); ++n) {
    if (here[n].name == "box" || here[n].name == "scissors") continue;  // axes of P
    SCOPED_TRACE(here[n].name);
    const auto a = applyStep(s.volume, s.before, here[n].step);
    const auto b = applyStep(moved.volume, moved.before, there[n].step);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->labels.labels, b->labels.labels);
  }
}

TEST(ApplyStep, MakesTheFirstLabelOfACase) {
  Sample s = plainSample({3, 3, 1}, {1, 1, 1});
  s.before = {};
  std::vector<NamedStep> steps;
  const std::vector<LabelTool> tools{tool::Threshold{.range = {0, 0}},
                                     tool::GrowRegion{.seeds_mm = {{1, 1, 0}}, .range = {0, 0}},
                                     tool::Brush{.path_mm = {{1, 1, 0}}, .radius_mm = 10.0}};
  for (const LabelTool& tool : tools) {
    SCOPED_TRACE(toolTitle(tool));
    const auto after = applied(s, tool, {}, "brain");
    ASSERT_TRUE(after) << sentence(after.error());
    EXPECT_EQ(after->labels.labels, Mask(9, 1));
    EXPECT_EQ(after->labels.geometry.dims, s.geometry().dims);
    EXPECT_EQ(after->labels.geometry.spacing, s.geometry().spacing);
    ASSERT_EQ(after->table.size(), 1U);
    EXPECT_EQ(after->table[0].name, "brain");
    EXPECT_EQ(after->table[0].material, "brain") << "as the preset of this name says";
    EXPECT_EQ(after->table[0].colour, (std::array<std::uint8_t, 3>{214, 170, 168}));
  }
}

const std::set<std::array<std::uint8_t, 3>> kOkabeIto{{230, 159, 0},  {86, 180, 233}, {0, 158, 115},
                                                      {240, 228, 66}, {0, 114, 178},  {213, 94, 0},
                                                      {204, 121, 167}};

TEST(RowFor, ANewLabelGetsTheLowestFreeValue) {
  LabelTable table{{.name = "a", .value = 1}, {.name = "c", .value = 3}, {.name = "b", .value = 9}};
  const LabelTable before = table;
  const auto row = rowFor("d", table);
  ASSERT_TRUE(row) << sentence(row.error());
  EXPECT_EQ(row->value, 2);
  ASSERT_EQ(table.size(), 4U);
  EXPECT_TRUE(sameRow(table[3], *row));
  EXPECT_TRUE(std::equal(before.begin(), before.end(), table.begin(), sameRow));
  EXPECT_EQ(row->material, "bone");
  EXPECT_TRUE(kOkabeIto.contains(row->colour));
  const auto next = rowFor("e", table);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->value, 4);
  EXPECT_NE(next->colour, row->colour);
}

TEST(RowFor, AKnownLabelKeepsItsRow) {
  LabelTable table{{.name = "bone", .value = 7, .colour = {1, 2, 3}, .material = "tooth"}};
  const LabelTable before = table;
  const auto row = rowFor("bone", table);
  ASSERT_TRUE(row);
  EXPECT_TRUE(sameRow(*row, before[0]));
  EXPECT_TRUE(sameTable(table, before));
}

TEST(RowFor, APresetLendsColourAndMaterial) {
  for (const Preset& preset : segmentationPresets()) {
    LabelTable table;
    const auto row = rowFor(preset.label, table);
    ASSERT_TRUE(row);
    EXPECT_EQ(row->colour, preset.colour) << preset.label;
    EXPECT_EQ(row->material, preset.material.empty() ? "bone" : preset.material) << preset.label;
  }
}

TEST(RowFor, TheFirstSevenColoursDiffer) {
  LabelTable table;
  std::set<std::array<std::uint8_t, 3>> colours;
  for (int n = 0; n < 7; ++n) {
    const auto row = rowFor("part " + std::to_string(n), table);
    ASSERT_TRUE(row);
    colours.insert(row->colour);
  }
  EXPECT_EQ(colours, kOkabeIto);
}

TEST(RowFor, ThereIsRoomForJust255Labels) {
  LabelTable table;
  for (int n = 1; n <= 255; ++n) {
    const auto row = rowFor("part " + std::to_string(n), table);
    ASSERT_TRUE(row);
    EXPECT_EQ(row->value, n);
  }
  const LabelTable full = table;
  const auto row = rowFor("one more", table);
  ASSERT_FALSE(row);
  EXPECT_EQ(row.error().kind, ErrorKind::InputRefused);
  EXPECT_TRUE(sameTable(table, full));
  EXPECT_TRUE(rowFor("part 200", table));
}

}  // namespace
}  // namespace palpate::test
