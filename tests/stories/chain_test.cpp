// The product's main job as a user does it, on real scans: import, segment, tree, simulate, replay.

#include <gtest/gtest.h>

#include <cstdlib>

#include "app/program_paths.h"
#include "tests/app/program_run.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Scan {
  const char* name;
  fs::path path;
  const char* preset;
  std::vector<int> dims;
  const char* sha256;  ///< First digits, where a published figure exists; else empty.
};

void PrintTo(const Scan& scan, std::ostream* stream) {
  *stream << scan.name;
}

std::vector<Scan> scans() {
  return {
      {"CtHead", demoScanFile(), "ct-bone", {256, 256, 108}, "5ab64135"},
      {"MrHead", "/usr/share/mricron/templates/ch2.nii.gz", "mr-brain", {181, 217, 181}, ""},
      {"CtHeadAsDicom",
       fs::path(PALPATE_SHARED_DATA) / "series/ct_head_cranium",
       "ct-bone",
       {256, 256, 108},
       "5ab64135"},
  };
}

class Chain : public testing::TestWithParam<Scan> {
 protected:
  void SetUp() override {
    if (GetParam().path.empty() || !fs::exists(GetParam().path)) {
      GTEST_SKIP() << "the scan " << GetParam().name << " is not on this machine";
    }
  }
  json result(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    logs += run.err;
    return run.json();
  }
  std::string at(const std::string& name) { return (folder / name).string(); }

  TempFolder folder;
  std::string logs;
};

TEST_P(Chain, FromScanToAReplayedContact) {
  const Scan& scan = GetParam();
  const json import = result({"import", scan.path.string(), "--out", at("case")});
  EXPECT_EQ(import["dims"], scan.dims);
  const std::string sha = import["voxels_sha256"];
  EXPECT_EQ(sha.substr(0, std::string(scan.sha256).size()), scan.sha256);

  const json labels = result({"segment", at("case"), "--preset", scan.preset, "--largest"});
  const std::string label = labels["labels"][0]["name"];
  EXPECT_GT(labels["labels"][0]["voxels"], 10000);

  const json tree = result({"tree", at("case"), "--label", label});
  EXPECT_GT(tree["surface_voxels"], 10000);
  EXPECT_EQ(tree["nodes_per_level"].back(), 1);

  const json run = result({"simulate", at("case"), "--headless", "--seconds", "8", "--seed", "3",
                           "--record", at("session.palpate"), "--samples", at("samples.csv")});
  EXPECT_GT(run["contacts_max"], 0) << "the hand did not find the anatomy";
  EXPECT_GT(run["force_max_N"], 0.5);
  EXPECT_LT(run["force_max_N"], 10.0);
  EXPECT_GT(run["hand_energy_J"], -20e-6) << "the device gave the hand energy";
  EXPECT_EQ(run["recorder_drops"], 0);

  const json again =
      result({"simulate", at("case"), "--headless", "--seconds", "8", "--seed", "3"});
  EXPECT_EQ(again["state_hash"], run["state_hash"]) << "same seed, other bits";

  const json replay = result({"replay", at("session.palpate")});
  EXPECT_EQ(replay["identical"], true);
  EXPECT_EQ(replay["steps"], run["steps"]);
}

INSTANTIATE_TEST_SUITE_P(RealScans, Chain, testing::ValuesIn(scans()),
                         [](const auto& info) { return info.param.name; });

TEST(HounsfieldCount, BoneAt300HasThePublishedNumberOfVoxels) {
  const fs::path scan = demoScanFile();
  if (scan.empty()) GTEST_SKIP() << "the demo scan is not installed";
  const TempFolder folder;
  const std::string place = (folder / "case").string();
  ASSERT_EQ(palpate({"import", scan.string(), "--out", place}).exitCode, 0);
  const json labels =
      palpate({"segment", place, "--threshold", "300", "32767", "--label", "bone", "--json"})
          .json();
  EXPECT_EQ(labels["labels"][0]["voxels"], 441114);
}

TEST(BothWaysIn, InvesaliusAndDicomGiveOneVolume) {
  const fs::path project = demoScanFile();
  const fs::path dicom = fs::path(PALPATE_SHARED_DATA) / "series/ct_head_cranium";
  if (project.empty() || !fs::exists(dicom)) GTEST_SKIP() << "one of the two scans is not here";
  const TempFolder folder;
  const json a =
      palpate({"import", project.string(), "--out", (folder / "a").string(), "--json"}).json();
  const json b =
      palpate({"import", dicom.string(), "--out", (folder / "b").string(), "--json"}).json();
  EXPECT_EQ(a["voxels_sha256"], b["voxels_sha256"]);
  EXPECT_EQ(a["dims"], b["dims"]);
}

}  // namespace
}  // namespace palpate::test
