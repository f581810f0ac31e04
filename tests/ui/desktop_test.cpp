/// The desktop from end to end on a case of synthetic anatomy: deterministic pictures, refusals,
/// and the chain of buttons from start to replay. Needs a display.

#include "app/desktop.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/session/replay.h"
#include "imaging/case_folder.h"
#include "imaging/exchange/label_exchange.h"
#include "imaging/segment/apply.h"
#include "imaging/segment/case_recipe.h"
#include "imaging/volume_files.h"
#include "tests/ui/synthetic_case.h"
#include "ui/picture.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class DesktopTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("DISPLAY") == nullptr) {
      GTEST_SKIP() << "There is no display; run under xvfb-run -a.";
    }
    char name[] = "/tmp/palpate_desktop_XXXXXX";
    folder_ = ::mkdtemp(name);
    ImportedScan scan;
    scan.volume = test::syntheticHead(56);
    scan.sourceFormat = "MetaImage";
    scan.description = "Synthetic head";
    scan.pseudonym = "Case-0001";
    const LabelGrid bone = test::syntheticBone(scan.volume);
    ASSERT_TRUE(writeNewCase(folder_ / "case", scan));
    ASSERT_TRUE(writeCaseLabels(folder_ / "case", bone, {LabelInfo{.name = "bone"}}));
  }
  void TearDown() override {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
  }
  DesktopOptions options() const {
    DesktopOptions o;
    o.casePath = folder_ / "case";
    o.datasets = PALPATE_DATASETS;
    o.shaders = PALPATE_SHADERS;
    o.userFolder = folder_ / "user";
    o.uiScale = 1.0F;
    return o;
  }
  void script(DesktopOptions& o, const std::string& text) const {
    o.uiScript = folder_ / "script.txt";
    std::ofstream(*o.uiScript) << text;
  }
  fs::path folder_;
};

TEST_F(DesktopTest, TheSamePictureEveryTime) {
  DesktopOptions o = options();
  o.frames = 140;
  std::vector<ui::Picture> pictures;
  for (const char* name : {"a.png", "b.png"}) {
    o.screenshot = folder_ / name;
    ASSERT_EQ(runDesktop(o), 0);
    const auto picture = ui::readPng(*o.screenshot);
    ASSERT_TRUE(picture) << sentence(picture.error());
    pictures.push_back(*picture);
  }
  EXPECT_EQ(pictures[0].width, 1280);
  EXPECT_EQ(pictures[0].height, 800);
  EXPECT_EQ(pictures[0].rgba, pictures[1].rgba);
}

TEST_F(DesktopTest, ACaseThatIsNotThereIsRefused) {
  DesktopOptions o = options();
  o.casePath = folder_ / "nothing";
  o.screenshot = folder_ / "a.png";
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(runDesktop(o), 3);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("nothing"), std::string::npos);
  EXPECT_FALSE(fs::exists(*o.screenshot));
}

TEST_F(DesktopTest, APictureThatCannotBeWrittenSaysSo) {
  DesktopOptions o = options();
  o.frames = 1;
  o.screenshot = folder_ / "no/such/folder/a.png";
  EXPECT_EQ(runDesktop(o), 4);
}

TEST_F(DesktopTest, MissingShadersAreNamed) {
  DesktopOptions o = options();
  o.shaders = folder_;
  o.screenshot = folder_ / "a.png";
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(runDesktop(o), 4);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("fullscreen.vert"), std::string::npos);
}

TEST_F(DesktopTest, ButtonsRecordASessionThatReplaysIdentically) {
  DesktopOptions o = options();
  // "Record" turns into "Stop m:ss.t": the key is the way that does not depend on the time.
  script(o,
         "wait-idle\nwait 5\nclick-item Demo hand\nclick-item Record\nwait 60\nkey r\nwait 5\n"
         "click-item Review\nwait 2\nclick-item Session 1\nwait-idle\n"
         "click-item Replay and compare\nwait-idle\nquit\n");
  ASSERT_EQ(runDesktop(o), 0);
  std::vector<fs::path> sessions;
  for (const auto& entry : fs::directory_iterator(folder_ / "case/sessions")) {
    sessions.push_back(entry.path());
  }
  ASSERT_EQ(sessions.size(), 1U);
  const auto header = readSessionHeader(sessions[0]);
  ASSERT_TRUE(header) << sentence(header.error());
  EXPECT_TRUE(header->finished);
  EXPECT_GT(header->steps, 200U);
  if (!header->exact) GTEST_SKIP() << "The recorder dropped samples: this machine is too busy.";
  const auto scene = prepareSession(sessions[0]);
  ASSERT_TRUE(scene) << sentence(scene.error());
  const auto report = replaySession(sessions[0], *scene);
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_TRUE(report->identical);
}

TEST_F(DesktopTest, RemovingALabelCanBeUndone) {
  const auto before = readCaseLabels(folder_ / "case");
  ASSERT_TRUE(before);
  DesktopOptions o = options();
  o.task = "segment";
  const std::string remove =
      "wait-idle\nwait 3\nclick-item Name, colour, material of bone\nwait 2\n"
      "click-item Remove bone\nwait-idle\nwait 3\n";
  script(o, remove + "quit\n");
  ASSERT_EQ(runDesktop(o), 0);
  EXPECT_FALSE(caseHasLabels(folder_ / "case"));

  ASSERT_TRUE(writeCaseLabels(folder_ / "case", *before, {LabelInfo{.name = "bone"}}));
  script(o, remove + "click-item Undo\nwait-idle\nquit\n");
  ASSERT_EQ(runDesktop(o), 0);
  const auto after = readCaseLabels(folder_ / "case");
  ASSERT_TRUE(after) << sentence(after.error());
  EXPECT_EQ(after->labels, before->labels);
}

TEST_F(DesktopTest, SegmentingInTheWindowGivesTheLabelOfTheCommand) {
  const auto before = readCaseLabels(folder_ / "case");
  ASSERT_TRUE(before);
  std::error_code ignored;
  fs::remove(folder_ / "case/labels.mha", ignored);
  fs::remove(folder_ / "case/labels.toml", ignored);
  DesktopOptions o = options();
  script(o,
         "wait-idle\nwait 3\nclick-item Segment\nwait 2\nclick-item Segment "
         "tissue\nwait-idle\nquit\n");
  ASSERT_EQ(runDesktop(o), 0);
  const auto volume = readCaseVolume(folder_ / "case");
  const auto after = readCaseLabels(folder_ / "case");
  ASSERT_TRUE(volume && after);
  for (std::size_t i = 0; i < after->labels.size(); ++i) {
    const double hu = volume->value(i);
    ASSERT_EQ(after->labels[i] != 0, hu >= 226 && hu <= 3071) << hu;
  }
}

/// A chain of tools, undo, redo, a new name: what is on disk is what the kept recipe makes again.
TEST_F(DesktopTest, WhatTheWindowDidIsRebuiltFromItsRecipe) {
  std::error_code ignored;
  fs::remove(folder_ / "case/labels.mha", ignored);
  fs::remove(folder_ / "case/labels.toml", ignored);
  DesktopOptions o = options();
  o.task = "segment";
  script(o,
         "wait-idle\nwait 3\nclick-item Segment tissue\nwait-idle\nwait 3\n"
         "click-item Margin\nwait 10\nwait-idle\nclick-item Apply Margin\nwait-idle\nwait 3\n"
         "hold ctrl\nkey z\nlet ctrl\nwait-idle\nwait 3\n"
         "hold ctrl\nkey y\nlet ctrl\nwait-idle\nwait 3\n"
         "click-item Scissors\nwait 2\nmove 600 200\npress left\nmove 700 200\nwait 1\n"
         "move 700 330\nwait 1\nmove 600 330\nwait 1\nrelease left\nwait-idle\nwait 3\n"
         "click-item Paint\nwait 2\ndrag 1130 150 1160 170\nwait-idle\nwait 3\n"
         "click-item Name, colour, material of bone\nwait 2\nclick-item Colour 5\nwait-idle\n"
         "wait 3\nquit\n");
  ASSERT_EQ(runDesktop(o), 0);
  const auto volume = readCaseVolume(folder_ / "case");
  const auto labels = readCaseLabels(folder_ / "case");
  const auto table = readCaseLabelTable(folder_ / "case");
  const CaseRecipe recipe = readCaseRecipe(folder_ / "case");
  ASSERT_TRUE(volume && labels && table);
  EXPECT_TRUE(recipe.whole);
  std::vector<std::string> tools;
  LabelState rebuilt;
  for (const LabelStep& step : recipe.steps) {
    tools.push_back(toolTitle(step.tool));
    auto next = applyStep(*volume, rebuilt, step);
    ASSERT_TRUE(next) << sentence(next.error());
    // A millimetre and a half is less than a voxel of this head: the margin changes nothing.
    if (tools.back() != "Margin") {
      EXPECT_NE(next->labels.labels, rebuilt.labels.labels) << tools.back();
    }
    rebuilt = std::move(*next);
  }
  EXPECT_EQ(tools, (std::vector<std::string>{"Threshold", "Margin", "Scissors", "Brush"}));
  EXPECT_EQ(rebuilt.labels.labels, labels->labels);
  ASSERT_EQ(table->size(), 1U);
  EXPECT_EQ((*table)[0].colour, (std::array<std::uint8_t, 3>{0, 158, 115}));
}

TEST_F(DesktopTest, AScriptsFramesAreReportedByItsPhases) {
  DesktopOptions o = options();
  o.task = "segment";
  o.frameReport = folder_ / "frames.json";
  script(o, "phase open\nwait-idle\nphase step\nclick-item Segment tissue\nwait-idle\nquit\n");
  ASSERT_EQ(runDesktop(o), 0);
  const auto phases = nlohmann::json::parse(std::ifstream(*o.frameReport))["phases"];
  ASSERT_EQ(phases.size(), 2U);
  EXPECT_EQ(phases[0]["name"], "open");
  EXPECT_EQ(phases[1]["name"], "step");
  for (const auto& phase : phases) {
    EXPECT_GT(phase["frames"], 3);
    EXPECT_GT(phase["frame_ms"], 0.0);
    EXPECT_GE(phase["seconds"], phase["busy_s"]);
    EXPECT_GE(phase["peak_MiB"], phase["end_MiB"]);
  }
  EXPECT_GT(phases[1]["busy_s"], 0.0);
}

/// The home is where an export goes unless another place is chosen.
class ExchangeInWindow : public DesktopTest {
 protected:
  void SetUp() override {
    DesktopTest::SetUp();
    if (IsSkipped()) return;
    fs::create_directory(folder_ / "home");
    ::setenv("HOME", (folder_ / "home").c_str(), 1);
    const auto state = readCaseLabelState(folder_ / "case");
    ASSERT_TRUE(state);
    before_ = *state;
  }
  int run(const std::string& text) {
    DesktopOptions o = options();
    o.task = "segment";
    script(o, "wait-idle\nwait 3\n" + text + "quit\n");
    return runDesktop(o);
  }
  std::vector<std::uint8_t> labelsOf(const fs::path& file) const {
    const auto found = importLabels(file, before_.labels.geometry, "");
    EXPECT_TRUE(found) << sentence(found.error());
    return found ? found->grid.labels : std::vector<std::uint8_t>{};
  }
  /// Through the dialog into a file of that path.
  static std::string exporting(const std::string& format, const std::string& answer = "") {
    return "click-item Export\xe2\x80\xa6\nwait 3\nclick-item " + format +
           "\nwait 2\nclick-item Export\nwait 3\nwait-idle\nwait 3\n" +
           (answer.empty() ? "" : "click-item " + answer + "\nwait 3\nwait-idle\nwait 3\n");
  }
  static std::string taking(const std::string& file) {
    return "click-item From file\xe2\x80\xa6\nwait 3\nclick-item Path of the file\nwait 2\n"
           "text " +
           file + "\nwait 2\nclick-item Take the labels\nwait 3\nwait-idle\nwait 3\n";
  }
  LabelState before_;
};

TEST_F(ExchangeInWindow, EveryFormatIsWrittenUnderThePseudonym) {
  std::string all;
  for (const char* format : {"DICOM SEG", "NRRD", "MetaImage", "STL", "PLY", "OBJ"}) {
    all += exporting(format);
  }
  ASSERT_EQ(run(all), 0);
  for (const char* name :
       {"labels.dcm", "labels.seg.nrrd", "labels.mha", "bone.stl", "bone.ply", "bone.obj"}) {
    const fs::path file = folder_ / "home" / (std::string("Case-0001-") + name);
    ASSERT_TRUE(fs::exists(file)) << file;
    const auto back = labelsOf(file);
    if (std::string(name).find("labels") == 0) {
      EXPECT_EQ(back, before_.labels.labels) << name;
    }
  }
  EXPECT_EQ(readCaseLabels(folder_ / "case")->labels, before_.labels.labels);
}

TEST_F(ExchangeInWindow, AFileThatIsThereIsReplacedOnlyWhenSaid) {
  const fs::path file = folder_ / "home/Case-0001-labels.mha";
  const auto mine = [&file] {
    std::ifstream in(file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  std::ofstream(file) << "mine";
  ASSERT_EQ(run(exporting("MetaImage", "Another name") + "click-item Cancel\nwait 3\n"), 0);
  EXPECT_EQ(mine(), "mine");
  ASSERT_EQ(run(exporting("MetaImage") + "key escape\nwait 3\n"), 0);
  EXPECT_EQ(mine(), "mine");
  ASSERT_EQ(run(exporting("MetaImage", "Replace it")), 0);
  EXPECT_EQ(labelsOf(file), before_.labels.labels);
}

TEST_F(ExchangeInWindow, LabelsOfAFileComeInAndGoBack) {
  LabelGrid half = before_.labels;
  for (std::size_t i = 0; i < half.labels.size(); i += 2) half.labels[i] = 0;
  ASSERT_TRUE(writeLabelFile(half, folder_ / "half.mha"));
  const std::string take = taking((folder_ / "half.mha").string());
  ASSERT_EQ(run(take), 0);
  auto after = readCaseLabelState(folder_ / "case");
  ASSERT_TRUE(after);
  ASSERT_EQ(after->table.size(), 2U) << "the file names its label otherwise: it is new";
  EXPECT_EQ(after->table[1].name, "label-1");
  EXPECT_TRUE(readCaseRecipe(folder_ / "case").steps.empty()) << "no step makes them";
  for (std::size_t i = 0; i < half.labels.size(); ++i) {
    const std::uint8_t was = before_.labels.labels[i];
    ASSERT_EQ(after->labels.labels[i], half.labels[i] != 0 ? after->table[1].value : was) << i;
  }
  ASSERT_TRUE(writeCaseLabels(folder_ / "case", before_.labels, before_.table));
  ASSERT_EQ(run(take + "click-item Undo\nwait-idle\nwait 3\n"), 0);
  after = readCaseLabelState(folder_ / "case");
  ASSERT_TRUE(after);
  EXPECT_EQ(after->table.size(), 1U);
  EXPECT_EQ(after->labels.labels, before_.labels.labels);
}

TEST_F(ExchangeInWindow, LabelsOfAnotherScanChangeNothing) {
  const Volume other = test::syntheticHead(40);
  ASSERT_TRUE(writeLabelFile(test::syntheticBone(other), folder_ / "other.mha"));
  // Only a Problem stays until it is dismissed.
  ASSERT_EQ(run(taking((folder_ / "other.mha").string()) + "wait 300\nclick-item Dismiss\n"), 0);
  const auto after = readCaseLabelState(folder_ / "case");
  ASSERT_TRUE(after);
  EXPECT_EQ(after->labels.labels, before_.labels.labels);
  EXPECT_EQ(after->table.size(), 1U);
}

/// "Stop" is on the screen only while the simulation runs; the script fails where it is not.
TEST_F(DesktopTest, AnEditGoesIntoTheRunningSimulation) {
  DesktopOptions o = options();
  o.task = "segment";
  script(o,
         "wait-idle\nwait 3\nclick-item Touch it\nwait-idle\nwait 30\nmove-item Stop\n"
         "key 2\nwait 3\nclick-item Margin\nwait 10\nwait-idle\nclick-item Apply Margin\n"
         "wait-idle\nwait 30\nkey 3\nwait 3\nclick-item Stop\nwait 3\nmove-item Start\nquit\n");
  ASSERT_EQ(runDesktop(o), 0);
  const auto labels = readCaseLabels(folder_ / "case");
  ASSERT_TRUE(labels);
  EXPECT_EQ(readCaseRecipe(folder_ / "case").steps.size(), 1U);
  EXPECT_FALSE(readCaseRecipe(folder_ / "case").whole);
}

}  // namespace
}  // namespace palpate
