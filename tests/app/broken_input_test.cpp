// The table of the issue: each broken input gives one clear sentence with what to do, the right
// exit code, the JSON error, and leaves nothing behind.

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include "tests/app/program_run.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

class BrokenInput : public testing::Test {
 protected:
  /// Runs, expects the refusal, and that the folder holds what it held.
  void refused(const std::vector<std::string>& arguments, int exitCode, const std::string& kind) {
    const std::vector<std::string> before = listing(folder.path());
    std::vector<std::string> withJson = arguments;
    withJson.emplace_back("--json");
    run = palpate(withJson);
    expectRefused(run, exitCode, kind);
    EXPECT_EQ(listing(folder.path()), before) << "something was left behind";
  }
  std::string at(const std::string& name) { return (folder / name).string(); }

  TempFolder folder;
  ProgramRun run;
};

TEST_F(BrokenInput, MissingPath) {
  refused({"import", at("nothing"), "--out", at("case")}, 3, "input-refused");
  EXPECT_EQ(run.json()["error"]["file"], at("nothing"));
  refused({"series", at("nothing")}, 3, "input-refused");
}

TEST_F(BrokenInput, MissingCase) {
  refused({"segment", at("nothing"), "--preset", "ct-bone"}, 3, "input-refused");
  refused({"tree", at("nothing"), "--label", "bone"}, 3, "input-refused");
  refused({"simulate", at("nothing"), "--headless"}, 3, "input-refused");
  refused({"tradeoff", at("nothing"), "--out", at("trade")}, 3, "input-refused");
  refused({"replay", at("nothing")}, 3, "input-refused");
}

TEST_F(BrokenInput, EmptyFolder) {
  fs::create_directory(folder / "empty");
  refused({"import", at("empty"), "--out", at("case")}, 3, "input-refused");
}

TEST_F(BrokenInput, EmptyFile) {
  for (const char* name : {"a.dcm", "a.nii.gz", "a.nrrd", "a.mha", "a.inv3", "a.zip"}) {
    writeText(folder / name, "");
    refused({"import", at(name), "--out", at("case")}, 3, "input-refused");
  }
}

TEST_F(BrokenInput, TextFileNamedDicom) {
  writeText(folder / "letter.dcm", "Dear colleague, thank you for the referral.\n");
  refused({"import", at("letter.dcm"), "--out", at("case")}, 3, "input-refused");
  EXPECT_EQ(run.err.find("colleague"), std::string::npos) << "content shown";
}

TEST_F(BrokenInput, TextFileNamedVolume) {
  for (const char* name : {"a.nii", "a.nii.gz", "a.nrrd", "a.mha", "a.inv3"}) {
    writeText(folder / name, "not a volume\n");
    refused({"import", at(name), "--out", at("case")}, 3, "input-refused");
  }
}

TEST_F(BrokenInput, CaseWithoutLabels) {
  writeBallScan(folder / "ball.mha");
  ASSERT_EQ(palpate({"import", at("ball.mha"), "--out", at("case")}).exitCode, 0);
  refused({"tree", at("case"), "--label", "bone"}, 3, "input-refused");
  EXPECT_NE(run.err.find("segment"), std::string::npos) << "no next step: " << run.err;
  refused({"simulate", at("case"), "--headless"}, 3, "input-refused");
  EXPECT_NE(run.err.find("segment"), std::string::npos) << "no next step: " << run.err;
}

TEST_F(BrokenInput, UnknownLabelIsRefusedWithTheList) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  refused({"tree", at("case"), "--label", "nerve"}, 3, "input-refused");
  EXPECT_EQ(run.json()["error"]["found"], "nerve");
  EXPECT_NE(std::string(run.json()["error"]["expected"]).find("bone"), std::string::npos);
}

TEST_F(BrokenInput, ThresholdThatSelectsNothing) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  const std::string labels = contentOf(folder / "case/labels.mha");
  refused({"segment", at("case"), "--threshold", "2000", "3000", "--label", "bone"}, 3,
          "input-refused");
  EXPECT_EQ(contentOf(folder / "case/labels.mha"), labels) << "labels touched";
}

TEST_F(BrokenInput, UnknownPresetIsRefusedWithTheList) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  refused({"segment", at("case"), "--preset", "ct-wood"}, 2, "usage");
  EXPECT_NE(run.err.find("ct-bone"), std::string::npos);
}

TEST_F(BrokenInput, OneSliceIsImportedWithAWarningAndMakesNoTree) {
  writeBallScan(folder / "slice.mha", 1);
  const ProgramRun import = palpate({"import", at("slice.mha"), "--out", at("case"), "--json"});
  ASSERT_EQ(import.exitCode, 0) << import.err;
  EXPECT_EQ(import.json()["warnings"].size(), 1U) << import.out;
  EXPECT_NE(import.err.find("warning"), std::string::npos);
  ASSERT_EQ(
      palpate({"segment", at("case"), "--threshold", "300", "3071", "--label", "bone"}).exitCode,
      0);
  refused({"tree", at("case"), "--label", "bone"}, 3, "input-refused");
  refused({"simulate", at("case"), "--headless", "--seconds", "0.1"}, 3, "input-refused");
}

TEST_F(BrokenInput, OutputBelowAFile) {
  writeBallScan(folder / "ball.mha");
  writeText(folder / "file", "in the way");
  refused({"import", at("ball.mha"), "--out", at("file/case")}, 4, "machine");
  ASSERT_TRUE(makeBallCase(folder / "case"));
  refused({"simulate", at("case"), "--seconds", "0.1", "--samples", at("file/s.csv")}, 4,
          "machine");
  refused({"simulate", at("case"), "--seconds", "0.1", "--record", at("file/s.palpate")}, 4,
          "machine");
  refused({"tradeoff", at("case"), "--out", at("file/trade")}, 4, "machine");
}

TEST_F(BrokenInput, OutputInProc) {
  writeBallScan(folder / "ball.mha");
  refused({"import", at("ball.mha"), "--out", "/proc/palpate-case"}, 4, "machine");
}

TEST_F(BrokenInput, OutFolderThatIsNoCaseIsNotTouched) {
  writeBallScan(folder / "ball.mha");
  fs::create_directory(folder / "photos");
  writeText(folder / "photos/holiday.jpg", "keep me");
  const ProgramRun run = palpate({"import", at("ball.mha"), "--out", at("photos"), "--json"});
  EXPECT_TRUE(run.exitCode == 3 || run.exitCode == 4) << run.exitCode;
  EXPECT_EQ(contentOf(folder / "photos/holiday.jpg"), "keep me");
}

TEST_F(BrokenInput, FullDevice) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  refused({"simulate", at("case"), "--seconds", "0.1", "--samples", "/dev/full"}, 4, "machine");
  struct stat full {};
  ASSERT_EQ(::stat("/dev/full", &full), 0);
  EXPECT_TRUE(S_ISCHR(full.st_mode)) << "the device was replaced by a file";
  refused({"simulate", at("case"), "--seconds", "0.1", "--record", "/dev/full"}, 4, "machine");
}

TEST_F(BrokenInput, FullDisk) {
  fs::create_directory(folder / "disk");
  if (::mount("tmpfs", at("disk").c_str(), "tmpfs", 0, "size=16k") != 0) {
    GTEST_SKIP() << "mounting a small disk is not allowed here";
  }
  // Noise does not compress, so that the volume cannot fit.
  writeBallScan(folder / "ball.mha");
  std::vector<std::string> left;
  const ProgramRun import = palpate({"import", at("ball.mha"), "--out", at("disk/case"), "--json"});
  ASSERT_TRUE(makeBallCase(folder / "case"));
  const ProgramRun samples =
      palpate({"simulate", at("case"), "--seconds", "1", "--samples", at("disk/s.csv"), "--json"});
  const ProgramRun record = palpate(
      {"simulate", at("case"), "--seconds", "1", "--record", at("disk/s.palpate"), "--json"});
  left = listing(folder / "disk");
  ::umount(at("disk").c_str());
  expectRefused(samples, 4, "machine");
  expectRefused(record, 4, "machine");
  if (import.exitCode != 0) expectRefused(import, 4, "machine");
  for (const std::string& name : left) {
    EXPECT_TRUE(name.rfind("case", 0) == 0 && import.exitCode == 0) << "left behind: " << name;
  }
}

TEST_F(BrokenInput, HandFiles) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  writeText(folder / "words.csv", "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons\none,two\n");
  for (const char* name : {"words.csv", "missing.csv"}) {
    refused({"simulate", at("case"), "--seconds", "0.1", "--hand", at(name)}, 3, "input-refused");
  }
}

TEST_F(BrokenInput, UnknownInstrumentAndDevice) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  refused({"simulate", at("case"), "--instrument", "axe"}, 3, "input-refused");
  EXPECT_NE(run.err.find("ball-burr"), std::string::npos) << "the list is missing";
  refused({"simulate", at("case"), "--instrument", "../materials"}, 3, "input-refused");
  std::vector<std::string> arguments{"simulate", at("case"), "--device", "joystick", "--json"};
  const ProgramRun device = palpate(arguments);
  EXPECT_TRUE(device.exitCode == 2 || device.exitCode == 3) << device.err;
  EXPECT_NE(device.err.find("touch-x"), std::string::npos) << "the list is missing";
}

TEST_F(BrokenInput, SceneWithUnknownKey) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  writeText(folder / "case/scene.toml", "name = \"x\"\nwibble = 3\n");
  refused({"simulate", at("case"), "--seconds", "0.1"}, 3, "input-refused");
  EXPECT_NE(run.err.find("wibble"), std::string::npos) << run.err;
}

TEST_F(BrokenInput, Recipes) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  const std::vector<std::pair<const char*, const char*>> rows{
      {"[[step]]\nthreshold = [300, 3000]\n", "label"},
      {"[[step]]\nlabel = \"x\"\n", "preset or a threshold"},
      {"[[step]]\npreset = \"ct-bone\"\nthreshold = [1, 2]\n", "preset or a threshold"},
      {"[[step]]\npreset = \"ct-bone\"\ncolour = 3\n", "colour"},
      {"[[step]]\nthreshold = [3, 2]\nlabel = \"x\"\n", "range"},
      {"[[step]]\npreset = 7\n", "wrong type"},
      {"[[step]]\npreset = \"ct-wood\"\n", "ct-bone"},
      {"", "no steps"},
      {"[[step]\n", "not TOML"}};
  for (const auto& [text, words] : rows) {
    writeText(folder / "recipe.toml", text);
    refused({"segment", at("case"), "--recipe", at("recipe.toml")}, 3, "input-refused");
    EXPECT_NE(run.err.find(words), std::string::npos) << text << "\n" << run.err;
  }
  refused({"segment", at("case"), "--recipe", at("missing.toml")}, 3, "input-refused");
}

TEST_F(BrokenInput, ReplayOfWhatIsNoSession) {
  writeText(folder / "letter.palpate", "Dear colleague\n");
  refused({"replay", at("letter.palpate")}, 3, "input-refused");
  refused({"replay", folder.path().string()}, 3, "input-refused");
}

TEST_F(BrokenInput, RecordingDoesNotReplaceAnotherFile) {
  ASSERT_TRUE(makeBallCase(folder / "case"));
  writeText(folder / "thesis.txt", "years of work");
  refused({"simulate", at("case"), "--seconds", "0.1", "--record", at("thesis.txt")}, 4, "machine");
  EXPECT_EQ(contentOf(folder / "thesis.txt"), "years of work");
}

}  // namespace
}  // namespace palpate::test
