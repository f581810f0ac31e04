// palpate export, and segment --from: JSON, exit codes, and that nothing is left behind or
// replaced.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/app/program_run.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Exchange : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(makeBallCase(folder / "case"));
    ball = result({"segment", at("case"), "--threshold", "-1000", "-500", "--label", "air"});
  }
  std::string at(const std::string& name) { return (folder / name).string(); }
  static json result(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    return run.json();
  }
  void refused(std::vector<std::string> arguments, int exitCode, const std::string& kind) {
    const std::vector<std::string> before = listing(folder.path());
    arguments.emplace_back("--json");
    run = palpate(arguments);
    expectRefused(run, exitCode, kind);
    EXPECT_EQ(listing(folder.path()), before) << "something was left behind";
  }

  TempFolder folder;
  json ball;  ///< What segment says of the case: bone and air.
  ProgramRun run;
};

TEST_F(Exchange, EveryFormatComesBackIntoANewCase) {
  const std::map<std::string, std::string> formats{
      {"a.dcm", "DICOM SEG"}, {"a.mha", "MetaImage"}, {"a.nrrd", "NRRD"}, {"a.seg.nrrd", "NRRD"}};
  for (const auto& [name, format] : formats) {
    const json out = result({"export", at("case"), "--out", at(name)});
    EXPECT_EQ(out["file"], at(name));
    EXPECT_EQ(out["format"], format);
    ASSERT_EQ(out["labels"].size(), 2U);
    EXPECT_EQ(out.size(), 3U);
    for (std::size_t row = 0; row < 2; ++row) {
      EXPECT_EQ(out["labels"][row]["name"], ball["labels"][row]["name"]);
      EXPECT_EQ(out["labels"][row]["value"], ball["labels"][row]["value"]);
      EXPECT_EQ(out["labels"][row]["voxels"], ball["labels"][row]["voxels"]);
      EXPECT_EQ(out["labels"][row].size(), 3U);
    }
    // Into a case without labels: names come from the file, where it has any.
    writeBallScan(folder / "ball.mha");
    result({"import", at("ball.mha"), "--out", at(name + "-case")});
    json back = result({"segment", at(name + "-case"), "--from", at(name)});
    if (name == "a.mha") {
      EXPECT_EQ(back["labels"][0]["name"], "label-1");
      back["labels"][0]["name"] = "bone";
      back["labels"][1]["name"] = "air";
    }
    EXPECT_EQ(back, ball) << name;
    if (name == "a.mha") continue;
    EXPECT_EQ(result({"segment", at("case"), "--from", at(name)}), ball);
  }
}

/// What the case's recipe says of itself in its first line.
TEST_F(Exchange, LabelsOfAFileAreNotClaimedByTheRecipe) {
  const auto first = [this](const char* name) {
    std::ifstream file(folder / name / "segment.toml");
    std::string line;
    std::getline(file, line);
    return line;
  };
  writeBallScan(folder / "ball.mha");
  result({"import", at("ball.mha"), "--out", at("own")});
  result({"segment", at("own"), "--threshold", "300", "3000", "--label", "bone"});
  EXPECT_EQ(first("own"), "# All that made the labels of this case, in order.");
  result({"export", at("case"), "--out", at("a.nrrd")});
  result({"segment", at("own"), "--from", at("a.nrrd")});
  EXPECT_NE(first("own").find("their beginning is not here"), std::string::npos) << first("own");
}

TEST_F(Exchange, SurfaceOfTheBall) {
  for (const char* name : {"a.stl", "a.ply", "a.obj"}) {
    const json out = result({"export", at("case"), "--label", "bone", "--out", at(name)});
    EXPECT_GT(out["triangles"], 1000);
    struct stat status {};
    ASSERT_EQ(::stat(at(name).c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0077U, 0U) << "others may read it";
    const json back = result({"segment", at("case"), "--from", at(name), "--label", "bone"});
    // The smoothing rounds single voxels off: under one in a hundred of a ball of 24.
    EXPECT_NEAR(static_cast<double>(back["labels"][0]["voxels"]),
                static_cast<double>(ball["labels"][0]["voxels"]),
                0.01 * static_cast<double>(ball["labels"][0]["voxels"]));
  }
}

TEST_F(Exchange, OneLabelOfSeveralIsTaken) {
  result({"export", at("case"), "--out", at("a.dcm")});
  writeBallScan(folder / "ball.mha");
  result({"import", at("ball.mha"), "--out", at("other")});
  const json taken = result({"segment", at("other"), "--from", at("a.dcm"), "--label", "air"});
  ASSERT_EQ(taken["labels"].size(), 1U);
  EXPECT_EQ(taken["labels"][0]["voxels"], ball["labels"][1]["voxels"]);
  refused({"segment", at("other"), "--from", at("a.dcm"), "--label", "liver"}, 3, "input-refused");
  EXPECT_EQ(run.json()["error"]["expected"], "one of bone, air");
}

TEST_F(Exchange, AGuessedMaterialIsSaid) {
  result({"export", at("case"), "--label", "bone", "--out", at("a.stl")});
  const ProgramRun guessed = palpate({"segment", at("case"), "--from", at("a.stl")});
  EXPECT_EQ(guessed.exitCode, 0);
  EXPECT_NE(guessed.err.find("The material of label-1 is a guess (bone)"), std::string::npos);
}

TEST_F(Exchange, NothingIsReplacedUnasked) {
  writeText(folder / "there.nrrd", "mine");
  refused({"export", at("case"), "--out", at("there.nrrd")}, 3, "input-refused");
  EXPECT_EQ(run.json()["error"]["message"], "The output exists.");
  EXPECT_EQ(contentOf(folder / "there.nrrd"), "mine");
  result({"export", at("case"), "--out", at("there.nrrd"), "--force"});
  EXPECT_NE(contentOf(folder / "there.nrrd"), "mine");
  refused({"export", at("case"), "--out", at("case/labels.mha"), "--force"}, 3, "input-refused");
}

TEST_F(Exchange, WrongUse) {
  refused({"export", at("case"), "--out", at("a.vtk")}, 2, "usage");
  refused({"export", at("case"), "--out", at("a.stl")}, 2, "usage");
  refused({"export", at("case"), "--out", at("a.dcm"), "--label", "liver"}, 3, "input-refused");
  refused({"export", at("nothing"), "--out", at("a.dcm")}, 3, "input-refused");
  refused({"export", at("case"), "--out", "/proc/a.dcm"}, 4, "machine");
  refused({"segment", at("case"), "--from", at("nothing.dcm")}, 3, "input-refused");
  refused({"segment", at("case"), "--from", at("a.dcm"), "--largest"}, 2, "usage");
  refused({"segment", at("case"), "--from", at("a.dcm"), "--preset", "ct-bone"}, 2, "usage");
}

TEST_F(Exchange, LabelsOfAnotherScanAreRefused) {
  writeBallScan(folder / "short.mha", 30);
  result({"import", at("short.mha"), "--out", at("short")});
  result({"export", at("case"), "--out", at("a.nrrd")});
  refused({"segment", at("short"), "--from", at("a.nrrd")}, 3, "input-refused");
  EXPECT_EQ(run.json()["error"]["message"], "The labels reach out of the case's volume.");
  EXPECT_EQ(run.json()["error"]["found"], "voxels from (0, 0, 0) to (39, 39, 39)");
}

}  // namespace
}  // namespace palpate::test
