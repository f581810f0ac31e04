// `palpate compare`: agreement with references of every kind, its exit codes, broken input.

#include <gtest/gtest.h>

#include "app/program_paths.h"
#include "core/voxels/label_grid.h"
#include "imaging/case_folder.h"
#include "imaging/volume_files.h"
#include "tests/app/ball_suite.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Compare : public BallSuite {
 protected:
  void SetUp() override {
    ASSERT_TRUE(made);
    auto read = readCaseLabels(*folder / "case");
    ASSERT_TRUE(read) << sentence(read.error());
    labels = std::move(*read);
  }

  static ProgramRun compare(const std::string& reference, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"compare",     at("case"), "--label", "bone",
                                       "--reference", reference,  "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return palpate(arguments);
  }
  static json result(const std::string& reference, std::vector<std::string> more = {}) {
    const ProgramRun run = compare(reference, std::move(more));
    EXPECT_EQ(run.exitCode, 0) << run.err;
    return run.json();
  }
  static void refused(const ProgramRun& run, const std::string& file) {
    expectRefused(run, 3, "input-refused");
    EXPECT_EQ(run.json()["error"]["file"], file) << run.out;
  }
  /// The ball moved by `x` voxels, with that value.
  LabelGrid moved(std::int32_t x, std::uint8_t value) const {
    LabelGrid grid = labels;
    std::fill(grid.labels.begin(), grid.labels.end(), std::uint8_t{0});
    for (std::int32_t k = 0; k < 40; ++k)
      for (std::int32_t j = 0; j < 40; ++j)
        for (std::int32_t i = 0; i + x < 40; ++i) {
          if (labels.at(i, j, k) != 0) grid.labels[grid.geometry.index(i + x, j, k)] = value;
        }
    return grid;
  }
  static void write(const LabelGrid& grid, const std::string& name) {
    const auto written = writeLabelFile(grid, *folder / name);
    ASSERT_TRUE(written) << sentence(written.error());
  }

  LabelGrid labels;
};

TEST_F(Compare, WithItselfIsWholeAndHasEveryField) {
  const json found = result(at("case"));
  std::vector<std::string> keys;
  for (const auto& [name, value] : found.items()) keys.push_back(name);
  EXPECT_EQ(keys, (std::vector<std::string>{"dice", "jaccard", "label", "mm3", "reference",
                                            "surface_mm", "voxels"}));
  EXPECT_EQ(found["label"], "bone");
  EXPECT_EQ(found["reference"], "bone");
  EXPECT_EQ(found["voxels"][0], found["voxels"][1]);
  EXPECT_GT(found["voxels"][0], 7000);
  EXPECT_DOUBLE_EQ(found["mm3"][0], found["voxels"][0]);  // voxels of 1 mm
  EXPECT_EQ(found["dice"], 1.0);
  EXPECT_EQ(found["jaccard"], 1.0);
  const json& surface = found["surface_mm"];
  EXPECT_EQ(surface.size(), 6U);
  for (const json& way : {surface, surface["to_reference"], surface["from_reference"]}) {
    for (const char* field : {"mean", "median", "p95", "worst"}) EXPECT_EQ(way[field], 0.0);
  }
}

TEST_F(Compare, MeasuresAMovedBall) {
  write(moved(2, 7), "moved.nrrd");
  const LabelGrid reference = moved(2, 7);
  std::size_t common = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < labels.labels.size(); ++i) {
    common += labels.labels[i] != 0 && reference.labels[i] != 0 ? 1 : 0;
    all += labels.labels[i] != 0 ? 1 : 0;
  }
  const json found = result(at("moved.nrrd"));
  EXPECT_EQ(found["reference"], "non-zero");
  EXPECT_EQ(found["voxels"], json({all, all}));
  EXPECT_DOUBLE_EQ(found["dice"], static_cast<double>(common) / static_cast<double>(all));
  EXPECT_EQ(found["surface_mm"]["worst"], 2.0);  // at the poles of the axis
  EXPECT_EQ(result(at("moved.nrrd"), {"--reference-label", "7"}), [&] {
    json same = found;
    same["reference"] = "7";
    return same;
  }());
}

TEST_F(Compare, OneValueOfManyIsTheReference) {
  LabelGrid grid = labels;
  const auto value = grid.labels[grid.geometry.index(20, 20, 20)];
  for (auto& label : grid.labels) label = label == value ? 9 : 4;  // bone and all around it
  write(grid, "two.mha");
  EXPECT_EQ(result(at("two.mha"), {"--reference-label", "9"})["dice"], 1.0);
  EXPECT_EQ(result(at("two.mha"), {"--reference-label", "4"})["dice"], 0.0);
  EXPECT_EQ(result(at("two.mha"))["voxels"][1], 40 * 40 * 40);
}

TEST_F(Compare, ExitsWithOneBelowTheTolerance) {
  write(moved(3, 1), "three.mha");
  const double dice = result(at("three.mha"))["dice"];
  EXPECT_EQ(compare(at("three.mha"), {"--tolerance-dice", std::to_string(dice - 1e-4)}).exitCode,
            0);
  const ProgramRun below =
      compare(at("three.mha"), {"--tolerance-dice", std::to_string(dice + 1e-4)});
  EXPECT_EQ(below.exitCode, 1);
  EXPECT_EQ(below.json()["dice"], dice);
  EXPECT_NE(below.err.find("below the tolerance"), std::string::npos) << below.err;
  EXPECT_EQ(compare(at("case"), {"--tolerance-dice", "1"}).exitCode, 0);
  expectRefused(compare(at("case"), {"--tolerance-dice", "1.5"}), 2, "usage");
}

TEST_F(Compare, PrintsTablesWithoutJson) {
  const ProgramRun run =
      palpate({"compare", at("case"), "--label", "bone", "--reference", at("case")});
  EXPECT_EQ(run.exitCode, 0);
  EXPECT_NE(run.out.find("Dice       1.0000\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("symmetric             0.000  0.000   0.000  0.000\n"), std::string::npos)
      << run.out;
}

TEST_F(Compare, AnInVesaliusMaskEqualsOurThreshold) {
  const fs::path scan = demoScanFile();
  if (scan.empty()) GTEST_SKIP() << "Needs Debian's invesalius-examples, which is not here.";
  ASSERT_EQ(palpate({"import", scan.string(), "--out", at("head")}).exitCode, 0);
  ASSERT_EQ(palpate({"segment", at("head"), "--preset", "ct-bone"}).exitCode, 0);
  const auto against = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"compare",     at("head"),    "--label", "bone",
                                       "--reference", scan.string(), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return palpate(arguments);
  };
  const ProgramRun first = against({"--tolerance-dice", "1"});
  EXPECT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(first.json()["reference"], "mask 1");
  EXPECT_EQ(first.json()["voxels"], json({475759, 475759}));
  EXPECT_EQ(against({"--reference-label", "Máscara 1"}).json()["dice"], 1.0);
  EXPECT_LT(against({"--reference-label", "2"}).json()["dice"], 0.5);
  const ProgramRun missing = against({"--reference-label", "3"});
  refused(missing, scan.string());
  EXPECT_EQ(missing.json()["error"]["expected"], "a mask's name, or 1 to 2");
}

TEST_F(Compare, AnInVesaliusProjectStatesNoPosition) {
  const fs::path scan = demoScanFile();
  if (scan.empty()) GTEST_SKIP() << "Needs Debian's invesalius-examples, which is not here.";
  ASSERT_EQ(palpate({"import", scan.string(), "--out", at("centred")}).exitCode, 0);
  auto volume = readCaseVolume(*folder / "centred");
  ASSERT_TRUE(volume) << sentence(volume.error());
  volume->geometry.X_PV.translation().x() += 0.05;
  ASSERT_TRUE(writeVolumeFile(*volume, *folder / "elsewhere.mha"));
  ASSERT_EQ(palpate({"import", at("elsewhere.mha"), "--out", at("elsewhere")}).exitCode, 0);
  ASSERT_EQ(palpate({"segment", at("elsewhere"), "--preset", "ct-bone"}).exitCode, 0);
  const ProgramRun run = palpate(
      {"compare", at("elsewhere"), "--label", "bone", "--reference", scan.string(), "--json"});
  EXPECT_EQ(run.json()["dice"], 1.0) << run.err;
  EXPECT_NE(run.err.find("The project stores no position in the patient"), std::string::npos);
  expectRefused(
      palpate({"compare", at("case"), "--label", "bone", "--reference", scan.string(), "--json"}),
      3, "input-refused");
}

TEST_F(Compare, AnotherGridIsRefused) {
  LabelGrid grid = moved(0, 1);
  grid.geometry.X_PV.translation().z() += 1e-3;
  write(grid, "other-place.mha");
  const ProgramRun run = compare(at("other-place.mha"));
  refused(run, at("other-place.mha"));
  EXPECT_EQ(run.json()["error"]["found"], "40 x 40 x 40 voxels, corners up to 1.000000 mm away");
  EXPECT_EQ(run.json()["error"]["expected"], "40 x 40 x 40 voxels at the same place");
}

TEST_F(Compare, UnknownLabelsAreRefused) {
  const ProgramRun label =
      palpate({"compare", at("case"), "--label", "nerve", "--reference", at("case"), "--json"});
  expectRefused(label, 3, "input-refused");
  EXPECT_EQ(label.json()["error"]["found"], "nerve");
  const ProgramRun ofCase = compare(at("case"), {"--reference-label", "nerve"});
  refused(ofCase, at("case"));
  EXPECT_EQ(ofCase.json()["error"]["field"], "--reference-label");
  write(moved(0, 5), "five.mha");
  for (const char* value : {"6", "0", "256", "-1", "bone", "5.0"}) {
    const ProgramRun run = compare(at("five.mha"), {"--reference-label", value});
    refused(run, at("five.mha"));
    EXPECT_EQ(run.json()["error"]["found"], value);
  }
  EXPECT_EQ(compare(at("five.mha"), {"--reference-label", "6"}).json()["error"]["expected"],
            "one of 5");
}

TEST_F(Compare, BrokenReferencesAreRefused) {
  refused(compare(at("nothing")), at("nothing"));
  fs::create_directory(*folder / "empty");
  refused(compare(at("empty")), at("empty"));
  writeText(*folder / "letter.mha", "Dear colleague\n");
  refused(compare(at("letter.mha")), at("letter.mha"));
  writeText(*folder / "letter.inv3", "Dear colleague\n");
  refused(compare(at("letter.inv3")), at("letter.inv3"));
  LabelGrid none = moved(0, 1);
  std::fill(none.labels.begin(), none.labels.end(), std::uint8_t{0});
  write(none, "none.mha");
  refused(compare(at("none.mha")), at("none.mha"));
  write(moved(0, 1), "half.nrrd");
  fs::resize_file(*folder / "half.nrrd", fs::file_size(*folder / "half.nrrd") / 2);
  refused(compare(at("half.nrrd")), at("half.nrrd"));
}

TEST_F(Compare, LeavesTheCaseAsItIs) {
  const std::vector<std::string> before = listing(*folder / "case");
  const std::string labelBytes = contentOf(*folder / "case/labels.mha");
  result(at("case"));
  EXPECT_EQ(listing(*folder / "case"), before);
  EXPECT_EQ(contentOf(*folder / "case/labels.mha"), labelBytes);
}

}  // namespace
}  // namespace palpate::test
