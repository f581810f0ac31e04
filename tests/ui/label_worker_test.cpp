/// Segmentation beside the window: previews change nothing, steps do, all comes back. No display.

#include "app/label_worker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include "imaging/exchange/label_volume.h"

namespace palpate {
namespace {

using Kind = LabelWorker::Kind;

/// A cube of 226 in air, 40 voxels wide, and a small one.
std::shared_ptr<const Volume> cubes() {
  auto volume = std::make_shared<Volume>();
  volume->geometry.dims = {48, 48, 48};
  volume->modality = "CT";
  volume->int16.assign(volume->geometry.voxelCount(), -1000);
  for (int k = 4; k < 44; ++k) {
    for (int j = 4; j < 44; ++j) {
      for (int i = 4; i < 44; ++i) volume->int16[volume->geometry.index(i, j, k)] = 600;
    }
  }
  volume->int16[volume->geometry.index(46, 46, 46)] = 600;
  return volume;
}

LabelStep bone() {
  return {"bone", tool::Threshold{{226, 3071}}, {}, {}};
}

LabelStep margin(tool::Margin::Operation operation, double mm) {
  return {"bone", tool::Margin{operation, mm}, {}, {}};
}

struct Worker : testing::Test {
  Worker() { worker.open(cubes(), nullptr, 1); }
  std::vector<LabelWorker::Outcome> all() {
    worker.finish();
    std::vector<LabelWorker::Outcome> outcomes;
    while (auto outcome = worker.poll()) outcomes.push_back(std::move(*outcome));
    return outcomes;
  }
  static std::int64_t count(const SharedLabels& labels) {
    return std::count(labels->grid->labels.begin(), labels->grid->labels.end(), 1);
  }
  LabelWorker worker;
};

TEST_F(Worker, AStepGivesItsLabelsThenTheirSurfaces) {
  worker.commit(bone());
  const auto outcomes = all();
  ASSERT_EQ(outcomes.size(), 2U);
  EXPECT_EQ(outcomes[0].kind, Kind::Step);
  EXPECT_EQ(count(outcomes[0].labels), 64001);
  EXPECT_EQ(outcomes[1].kind, Kind::Surfaces);
  ASSERT_EQ(outcomes[1].surfaces.size(), 1U);
  EXPECT_FALSE(outcomes[1].surfaces[0].chunks->empty());
  EXPECT_FALSE(worker.busy());
}

TEST_F(Worker, APreviewChangesNothing) {
  worker.commit(bone());
  (void)all();
  worker.preview(margin(tool::Margin::Operation::Erode, 1.0));
  const auto outcomes = all();
  ASSERT_FALSE(outcomes.empty());
  EXPECT_EQ(outcomes[0].kind, Kind::Preview);
  EXPECT_EQ(count(outcomes[0].labels), 38 * 38 * 38);
  worker.dropPreview();
  worker.commit(margin(tool::Margin::Operation::Dilate, 0.0));
  EXPECT_EQ(count(all()[0].labels), 64001);
}

TEST_F(Worker, ApplyingWhatWasPreviewedTakesThePreviewsLabels) {
  worker.commit(bone());
  (void)all();
  const LabelStep step = margin(tool::Margin::Operation::Erode, 1.0);
  worker.preview(step);
  const auto previewed = all();
  worker.commit(step);
  const auto applied = all();
  ASSERT_FALSE(previewed.empty());
  ASSERT_FALSE(applied.empty());
  EXPECT_EQ(applied[0].kind, Kind::Step);
  EXPECT_EQ(applied[0].labels.get(), previewed[0].labels.get());  // not computed again
}

TEST_F(Worker, OfManyPreviewsTheNewestIsShownLast) {
  worker.commit(bone());
  (void)all();
  for (int i = 1; i <= 10; ++i) worker.preview(margin(tool::Margin::Operation::Erode, 1.0 * i));
  const auto outcomes = all();
  ASSERT_FALSE(outcomes.empty());
  const auto last = std::find_if(outcomes.rbegin(), outcomes.rend(),
                                 [](const auto& o) { return o.kind == Kind::Preview; });
  ASSERT_NE(last, outcomes.rend());
  EXPECT_EQ(count(last->labels), 20 * 20 * 20);
  EXPECT_LT(outcomes.size(), 20U);
}

TEST_F(Worker, StepsBuildOnEachOtherAndComeBackOneByOne) {
  worker.commit(bone());
  worker.commit({"bone", tool::Islands{}, {}, {}});
  worker.commit(margin(tool::Margin::Operation::Erode, 1.0));
  std::vector<LabelWorker::Outcome> steps;
  for (auto& outcome : all()) {
    if (outcome.kind == Kind::Step) steps.push_back(std::move(outcome));
  }
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(count(steps[1].labels), 64000);
  EXPECT_EQ(count(steps[2].labels), 38 * 38 * 38);
  for (std::size_t i = 3; i-- > 1;) {
    worker.restore(steps[i].before);
    const auto outcomes = all();
    ASSERT_FALSE(outcomes.empty());
    EXPECT_EQ(outcomes[0].kind, Kind::Restored);
    EXPECT_EQ(outcomes[0].labels->grid->labels, steps[i - 1].labels->grid->labels);
  }
}

TEST_F(Worker, ARefusedStepLeavesTheLabelsAsTheyWere) {
  worker.commit(bone());
  worker.commit(margin(tool::Margin::Operation::Erode, 150.0));
  worker.commit(margin(tool::Margin::Operation::Erode, 1.0));
  std::vector<std::int64_t> counts;
  for (const auto& outcome : all()) {
    if (outcome.kind == Kind::Step) counts.push_back(outcome.labels ? count(outcome.labels) : -1);
  }
  EXPECT_EQ(counts, (std::vector<std::int64_t>{64001, -1, 38 * 38 * 38}));
}

/// A preview that is being made while the table changes is of the old table: it is not taken.
TEST_F(Worker, ANewTableOutlivesThePreviewThatRan) {
  worker.commit(bone());
  (void)all();
  const LabelStep step = margin(tool::Margin::Operation::Erode, 1.0);
  for (int i = 0; i < 60; ++i) {
    worker.preview(step);
    std::this_thread::sleep_for(std::chrono::microseconds(200 * (i % 20)));
    const std::string material = "material-" + std::to_string(i);
    const SharedLabels set = worker.setTable({LabelInfo{.name = "bone", .material = material}});
    EXPECT_EQ(set->table[0].material, material);
    worker.commit(step);
    SharedLabels stepped;
    std::shared_ptr<const PackedState> before;
    for (const auto& outcome : all()) {
      if (outcome.kind != Kind::Step) continue;
      stepped = outcome.labels;
      before = outcome.before;
    }
    ASSERT_TRUE(stepped);
    EXPECT_EQ(stepped->table[0].material, material) << i;
    worker.restore(before);
    (void)all();
  }
}

/// On a large scan the voxels are hundreds of megabytes: a name does not copy them.
TEST_F(Worker, ATableEditSharesTheVoxelsAndTheirCounts) {
  worker.commit(bone());
  const SharedLabels made = all()[0].labels;
  const SharedLabels set = worker.setTable({LabelInfo{.name = "skull"}});
  EXPECT_EQ(set->grid, made->grid);
  EXPECT_EQ(set->table[0].name, "skull");
  EXPECT_EQ(labelRows(*set)[0].voxels, 64001U);
  EXPECT_EQ(made->table[0].name, "bone");
}

/// What is applied while it is being previewed is shown, and can be cancelled, like any step.
TEST_F(Worker, AStepThatWaitsForItsPreviewShowsItsProgress) {
  worker.commit(bone());
  (void)all();
  const LabelStep slow{"bone", tool::Smooth{20.0, true}, {}, {}};
  worker.preview(slow);
  std::this_thread::sleep_for(std::chrono::milliseconds(2));  // it runs
  worker.commit(slow);
  const ui::JobModel model = worker.model();
  EXPECT_TRUE(model.active);
  EXPECT_EQ(model.title, "Smooth");
  EXPECT_TRUE(model.cancellable);
  worker.cancel();
  for (const auto& outcome : all()) EXPECT_NE(outcome.kind, Kind::Step);
  EXPECT_FALSE(worker.model().active);
}

/// The undo comes back to the labels of the step; what Cancel stopped can be asked for again.
TEST_F(Worker, ARestoreCanBeCancelled) {
  worker.commit(bone());
  const auto before = all()[0].before;
  worker.restore(before);
  worker.cancel();
  std::size_t restored = 0;
  for (const auto& outcome : all()) restored += outcome.labels && outcome.kind == Kind::Restored;
  EXPECT_LE(restored, 1U);
  worker.restore(before);
  EXPECT_EQ(count(all()[0].labels), 0);
}

/// Strokes come faster than surfaces: those in between are left out, none is forgotten.
TEST_F(Worker, AfterManyStepsTheSurfacesAreThoseOfTheLast) {
  for (int i = 0; i < 12; ++i) {
    const double at = 10.0 + 2.0 * i;
    worker.commit(
        {i % 2 == 0 ? "even" : "odd", tool::Brush{{{at, at, at}}, 2.0, {}, false}, {}, {}});
  }
  worker.commit({"even", tool::Margin{tool::Margin::Operation::Erode, 100.0}, {}, {}});  // refused
  std::map<std::uint8_t, ui::SharedChunks> drawn;
  SharedLabels last;
  for (auto& outcome : all()) {
    if (outcome.kind == Kind::Step && outcome.labels) last = outcome.labels;
    for (auto& surface : outcome.surfaces) drawn[surface.value] = std::move(surface.chunks);
  }
  ASSERT_TRUE(last);
  ASSERT_EQ(drawn.size(), 2U);
  for (const auto& [value, chunks] : drawn) {
    const auto expected = meshLabel(*last->grid, value, 1);
    ASSERT_TRUE(expected);
    ASSERT_EQ(chunks->size(), expected->size());
    for (std::size_t i = 0; i < chunks->size(); ++i) {
      EXPECT_EQ((*chunks)[i].vertices_mm, (*expected)[i].vertices_mm) << int(value);
    }
  }
}

/// A file's labels come in between the steps, and go back as one.
TEST_F(Worker, LabelsOfAFileAreAStepLikeAnyOther) {
  char name[] = "/tmp/palpate_join_XXXXXX";
  const std::filesystem::path folder = ::mkdtemp(name);
  LabelGrid plate{cubes()->geometry, {}};
  plate.labels.assign(plate.geometry.voxelCount(), 0);
  for (int i = 0; i < 48; ++i) plate.labels[plate.geometry.index(i, 2, 2)] = 4;
  ASSERT_TRUE(writeLabelVolume(plate, {LabelInfo{.name = "plate", .value = 4}}, folder / "a.nrrd"));
  worker.commit(bone());
  worker.join(folder / "a.nrrd", "");
  worker.commit(margin(tool::Margin::Operation::Erode, 1.0));
  worker.join(folder / "nothing.nrrd", "");
  std::vector<LabelWorker::Outcome> steps;
  for (auto& outcome : all()) {
    if (outcome.kind != Kind::Surfaces) steps.push_back(std::move(outcome));
  }
  std::filesystem::remove_all(folder);
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps[1].kind, Kind::Joined);
  EXPECT_EQ(steps[1].added, std::vector<std::string>{"plate"});
  EXPECT_EQ(count(steps[1].labels), 64001);
  const auto& after = steps[2].labels->grid->labels;
  EXPECT_EQ(std::count(after.begin(), after.end(), 4), 48);
  EXPECT_EQ(steps[3].labels, nullptr);
  EXPECT_EQ(steps[3].error.message, "There is no such file.");
  worker.restore(steps[1].before);
  const auto outcomes = all();
  ASSERT_FALSE(outcomes.empty());
  EXPECT_EQ(outcomes[0].labels->table.size(), 1U);
  EXPECT_EQ(outcomes[0].labels->grid->labels, steps[0].labels->grid->labels);
}

TEST_F(Worker, AnotherCaseHearsNothingOfTheLast) {
  worker.commit(bone());
  worker.open(cubes(), nullptr, 1);
  for (const auto& outcome : all()) EXPECT_EQ(outcome.labels, nullptr);
  worker.close();
  worker.commit(bone());
  EXPECT_TRUE(all().empty());
}

/// Under the thread sanitizer this shows what open() shares with a surface that is being made.
TEST_F(Worker, ACaseIsOpenedWhileAnotherIsDrawn) {
  for (int i = 0; i < 60; ++i) {
    worker.commit(bone());
    std::this_thread::sleep_for(std::chrono::microseconds(400 * i));
    worker.open(cubes(), nullptr, 1 + i % 2);
    EXPECT_FALSE(worker.poll());
  }
  EXPECT_TRUE(all().empty());
}

TEST_F(Worker, CancelStopsWhatRunsAndForgetsWhatWaits) {
  for (int i = 0; i < 20; ++i) worker.commit(bone());
  worker.cancel();
  std::size_t steps = 0;
  for (const auto& outcome : all()) steps += outcome.kind == Kind::Step && outcome.labels ? 1 : 0;
  EXPECT_LT(steps, 20U);
  EXPECT_FALSE(worker.busy());
}

/// Nine pieces and some; half of it noise, which does not get smaller.
TEST(PackedLabels, ComeBackEqualAndCanBeCancelledBetweenPieces) {
  LabelGrid labels;
  labels.geometry.dims = {512, 256, 300};
  labels.labels.resize(labels.geometry.voxelCount());
  std::uint32_t noise = 1;
  for (std::size_t i = 0; i < labels.labels.size(); ++i) {
    noise = noise * 1664525U + 1013904223U;
    labels.labels[i] =
        i < labels.labels.size() / 2 ? std::uint8_t{3} : static_cast<std::uint8_t>(noise >> 24U);
  }
  const auto packed = PackedLabels::pack(labels);
  ASSERT_TRUE(packed);
  const auto back = packed->unpack();
  ASSERT_TRUE(back);
  EXPECT_EQ(back->labels, labels.labels);
  EXPECT_EQ(back->geometry.dims, labels.geometry.dims);

  const auto stopsAtThird = [](const auto& work) {
    CancelToken token;
    int heard = 0;
    const Progress progress{[&](double fraction, const std::string&) {
                              EXPECT_GE(fraction, 0.0);
                              EXPECT_LT(fraction, 1.0);
                              if (++heard == 3) token.cancel();
                            },
                            &token};
    return !work(progress) && heard == 3;
  };
  EXPECT_TRUE(stopsAtThird([&](const Progress& p) { return bool(PackedLabels::pack(labels, p)); }));
  EXPECT_TRUE(stopsAtThird([&](const Progress& p) { return bool(packed->unpack(p)); }));
}

TEST(ChangedLabels, AreThoseWhoseVoxelsOrRowsDiffer) {
  LabelState was, is;
  was.labels.labels = {0, 1, 1, 2, 3};
  is.labels.labels = {0, 1, 4, 2, 3};
  was.table = {{"x", 1}, {"y", 2}, {"z", 3}, {"gone", 5}};
  is.table = {{"x", 1}, {"y", 2}, {"z", 3}, {"new", 4}};
  const auto a = countedLabels(std::move(was));
  const auto b = countedLabels(std::move(is));
  EXPECT_EQ(changedLabels(*a, *b), (std::vector<std::uint8_t>{1, 4, 5}));
  EXPECT_TRUE(changedLabels(*a, *a).empty());
}

}  // namespace
}  // namespace palpate
