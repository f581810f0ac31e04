// The JSON of every command, field by field as in interface.md, on a ball whose numbers are known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <cmath>
#include <numbers>

#include "tests/app/ball_suite.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;

std::vector<std::string> keys(const json& object) {
  std::vector<std::string> names;
  for (const auto& [name, value] : object.items()) names.push_back(name);
  return names;
}

void expectKeys(const json& object, std::vector<std::string> expected) {
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(keys(object), expected);
}

class OnABall : public BallSuite {
 protected:
  static json result(std::vector<std::string> arguments) {
    arguments.emplace_back("--json");
    const ProgramRun run = palpate(arguments);
    EXPECT_EQ(run.exitCode, 0) << run.err;
    const json value = run.json();
    EXPECT_TRUE(value.is_object()) << run.out;
    return value;
  }
};

TEST_F(OnABall, Import) {
  writeBallScan(*folder / "ball.mha");
  const json found = result({"import", at("ball.mha"), "--out", at("again")});
  expectKeys(found, {"case", "modality", "dims", "spacing_mm", "origin_mm", "direction",
                     "voxel_type", "value_range", "voxels_sha256", "repairs", "warnings"});
  EXPECT_EQ(found["case"], at("again"));
  EXPECT_EQ(found["dims"], json({40, 40, 40}));
  EXPECT_EQ(found["spacing_mm"], json({1.0, 1.0, 1.0}));
  EXPECT_EQ(found["origin_mm"], json({0.0, 0.0, 0.0}));
  EXPECT_EQ(found["direction"], json({1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(found["voxel_type"], "int16");
  EXPECT_EQ(found["value_range"], json({-1000, 1000}));
  EXPECT_EQ(std::string(found["voxels_sha256"]).size(), 64U);
  EXPECT_TRUE(found["repairs"].empty());
  for (const char* name : {"case.toml", "volume.mha", "scene.toml"}) {
    EXPECT_TRUE(fs::exists(*folder / "again" / name)) << name;
  }
}

TEST_F(OnABall, CasesArePrivate) {
  struct stat status {};
  ASSERT_EQ(::stat(at("case").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
  for (const auto& entry : fs::directory_iterator(*folder / "case")) {
    ASSERT_EQ(::stat(entry.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0077U, 0U) << entry.path();
  }
}

TEST_F(OnABall, Series) {
  writeBallScan(*folder / "ball.mha");
  const json found = result({"series", at("ball.mha")});
  expectKeys(found, {"series", "skipped_files"});
  ASSERT_EQ(found["series"].size(), 1U);
  expectKeys(found["series"][0],
             {"uid", "modality", "description", "study", "files", "bytes", "importable", "reason",
              "repair", "dims", "spacing_mm", "origin_mm", "direction"});
  EXPECT_EQ(found["series"][0]["importable"], true);
  EXPECT_TRUE(found["series"][0]["reason"].is_null());
}

TEST_F(OnABall, SegmentCountsTheBall) {
  const json found =
      result({"segment", at("case"), "--threshold", "300", "3071", "--label", "bone"});
  expectKeys(found, {"labels"});
  ASSERT_EQ(found["labels"].size(), 1U);
  const json& row = found["labels"][0];
  expectKeys(row, {"name", "value", "voxels", "mm3"});
  EXPECT_EQ(row["name"], "bone");
  // A ball of radius 12 counted in voxels is within 1 % of its volume.
  const double volume = 4.0 / 3.0 * std::numbers::pi * std::pow(12.0, 3);
  EXPECT_NEAR(row["mm3"], volume, volume * 0.01);
  EXPECT_DOUBLE_EQ(row["mm3"], row["voxels"]);
}

TEST_F(OnABall, SegmentLeavesOtherLabels) {
  const fs::path copy = *folder / "two";
  fs::copy(*folder / "case", copy, fs::copy_options::recursive);
  const json found =
      result({"segment", copy.string(), "--threshold", "-1000", "-500", "--label", "air"});
  ASSERT_EQ(found["labels"].size(), 2U);
  EXPECT_EQ(found["labels"][0]["name"], "bone");
  EXPECT_GT(found["labels"][0]["voxels"], 7000);
  EXPECT_EQ(found["labels"][1]["name"], "air");
  EXPECT_EQ(static_cast<int>(found["labels"][0]["voxels"]) +
                static_cast<int>(found["labels"][1]["voxels"]),
            40 * 40 * 40);
}

TEST_F(OnABall, ARecipeRunsItsStepsInOrder) {
  const fs::path copy = *folder / "recipe-case";
  fs::copy(*folder / "case", copy, fs::copy_options::recursive);
  writeText(*folder / "recipe.toml",
            "[[step]]\nthreshold = [-1000, 3071]\nlabel = \"all\"\n"
            "[[step]]\npreset = \"ct-bone\"\nlargest = true\nmin_mm3 = 5.0\n");
  const json found = result({"segment", copy.string(), "--recipe", at("recipe.toml")});
  ASSERT_EQ(found["labels"].size(), 2U);
  EXPECT_EQ(found["labels"][0]["name"], "bone");
  EXPECT_GT(found["labels"][0]["voxels"], 7000);
  EXPECT_EQ(static_cast<int>(found["labels"][0]["voxels"]) +
                static_cast<int>(found["labels"][1]["voxels"]),
            40 * 40 * 40);
}

TEST_F(OnABall, Tree) {
  for (const std::string branching : {"8", "64", "512"}) {
    for (const std::string leaf : {"voxel", "distance"}) {
      const json found =
          result({"tree", at("case"), "--label", "bone", "--branching", branching, "--leaf", leaf});
      expectKeys(found, {"levels", "nodes_per_level", "surface_voxels", "bytes", "build_ms"});
      expectKeys(found["bytes"], {"topology", "payload", "total"});
      EXPECT_EQ(found["bytes"]["total"], static_cast<int>(found["bytes"]["topology"]) +
                                             static_cast<int>(found["bytes"]["payload"]));
      EXPECT_EQ(found["nodes_per_level"].size(), found["levels"]);
      EXPECT_EQ(found["nodes_per_level"].back(), 1) << "one root";
      EXPECT_GT(found["surface_voxels"], 1000);
    }
  }
}

TEST_F(OnABall, SimulateTouchesTheBall) {
  const json found =
      result({"simulate", at("case"), "--headless", "--seconds", "4", "--seed", "7"});
  expectKeys(found, {"clock",
                     "seed",
                     "steps",
                     "ticks",
                     "step_us",
                     "tick_us",
                     "lateness_us",
                     "ticks_late",
                     "ticks_missed",
                     "contacts_max",
                     "force_max_N",
                     "torque_max_Nm",
                     "penetration_max_mm",
                     "hand_energy_J",
                     "hand_energy_min_J",
                     "governor",
                     "recorder_drops",
                     "step_histogram",
                     "tick_histogram",
                     "lateness_histogram",
                     "real_time",
                     "servo_cpu",
                     "state_hash",
                     "setting"});
  std::uint64_t counted = 0;
  for (const json& bin : found["step_histogram"]) {
    expectKeys(bin, {"from_us", "to_us", "count"});
    counted += static_cast<std::uint64_t>(bin["count"]);
  }
  EXPECT_EQ(counted, found["steps"]);
  EXPECT_LE(found["hand_energy_min_J"], found["hand_energy_J"]);
  EXPECT_GE(found["hand_energy_min_J"], -20e-6);
  for (const char* name : {"step_us", "tick_us", "lateness_us"}) {
    expectKeys(found[name], {"p50", "p99", "p999", "max"});
  }
  EXPECT_EQ(found["clock"], "virtual");
  EXPECT_EQ(found["seed"], 7);
  EXPECT_EQ(found["ticks"], 4000);
  EXPECT_THAT(std::string(found["state_hash"]), testing::MatchesRegex("[0-9a-f]{16}"));
  EXPECT_GT(found["contacts_max"], 0);
  EXPECT_GT(found["force_max_N"], 0.3);
  EXPECT_LT(found["penetration_max_mm"], 1.0);
  EXPECT_EQ(found["recorder_drops"], 0);
}

TEST_F(OnABall, ExplainSaysWhatIsModelled) {
  const json found = result({"simulate", at("case"), "--seconds", "0.01", "--explain"});
  ASSERT_TRUE(found["plan"].is_array());
  ASSERT_FALSE(found["plan"].empty());
  for (const json& row : found["plan"]) expectKeys(row, {"what", "modelled", "why", "us", "bytes"});
}

TEST_F(OnABall, StepsHaveTheirColumnsAndARowAStep) {
  result({"simulate", at("case"), "--seconds", "0.5", "--steps", at("steps.csv"), "--bodies",
          at("bodies.csv")});
  std::istringstream csv(contentOf(*folder / "steps.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "step,step_ms,parts,contacts,body_contacts,depth_mm,tests,impulses,time_us,"
            "stiffness_N_per_m");
  int rows = 0;
  while (std::getline(csv, line)) ++rows;
  EXPECT_EQ(rows, 500);
  EXPECT_EQ(contentOf(*folder / "bodies.csv"), "step,body,x_mm,y_mm,z_mm,qw,qx,qy,qz\n");
}

TEST_F(OnABall, TheHandOfASessionDoesItAgain) {
  result({"simulate", at("case"), "--seconds", "3", "--record", at("hand.palpate")});
  const json again =
      result({"simulate", at("case"), "--seconds", "3", "--hand", at("hand.palpate")});
  EXPECT_GT(again["contacts_max"], 0);
  EXPECT_GT(again["force_max_N"], 0.3);
}

TEST_F(OnABall, SamplesHaveTheirColumnsAndARowATick) {
  result({"simulate", at("case"), "--seconds", "0.5", "--samples", at("samples.csv")});
  std::istringstream csv(contentOf(*folder / "samples.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line,
            "t_s,x_m,y_m,z_m,qw,qx,qy,qz,vx,vy,vz,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,contacts,"
            "depth_m,step");
  int rows = 0;
  while (std::getline(csv, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 19) << line;
    EXPECT_NEAR(std::stod(line), rows * 1e-3, 1e-9);
    ++rows;
  }
  EXPECT_EQ(rows, 500);
}

TEST_F(OnABall, SameSeedSameHashAnotherSeedAnother) {
  const auto hash = [&](const char* seed) {
    return result({"simulate", at("case"), "--seconds", "3", "--seed", seed})["state_hash"];
  };
  const json first = hash("5");
  EXPECT_EQ(first, hash("5"));
  EXPECT_NE(first, hash("6"));
}

TEST_F(OnABall, EveryDeviceAndInstrumentRuns) {
  for (const char* device : {"touch", "touch-x", "premium-6dof"}) {
    const json found = result({"simulate", at("case"), "--seconds", "0.2", "--device", device});
    EXPECT_EQ(found["setting"]["device"], device);
  }
  for (const auto& entry : fs::directory_iterator(fs::path(PALPATE_DATASETS) / "instruments")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string name = entry.path().stem();
    const json found = result({"simulate", at("case"), "--seconds", "0.2", "--instrument", name});
    EXPECT_EQ(found["setting"]["instrument"], name);
  }
}

TEST_F(OnABall, ASceneFileIsAsGoodAsItsCase) {
  const json byCase = result({"simulate", at("case"), "--seconds", "0.5"});
  const json byScene = result({"simulate", at("case/scene.toml"), "--seconds", "0.5"});
  EXPECT_EQ(byCase["state_hash"], byScene["state_hash"]);
}

TEST_F(OnABall, ReplayIsIdentical) {
  const json run = result({"simulate", at("case"), "--seconds", "3", "--record", at("a.palpate")});
  const json found = result({"replay", at("a.palpate")});
  expectKeys(found, {"identical", "steps", "first_difference", "level_changes"});
  EXPECT_EQ(found["identical"], true);
  EXPECT_EQ(found["steps"], run["steps"]);
  EXPECT_TRUE(found["first_difference"].is_null());
}

TEST_F(OnABall, ReplayAtHigherAccuracySaysHowFarOff) {
  result({"simulate", at("case"), "--seconds", "2", "--record", at("b.palpate")});
  const json found = result({"replay", at("b.palpate"), "--accuracy", "reference"});
  EXPECT_TRUE(found.contains("force_error_max_N"));
  EXPECT_TRUE(found.contains("depth_error_max_mm"));
}

TEST_F(OnABall, RealClockRunsItsTime) {
  const json found = result({"simulate", at("case"), "--seconds", "0.5", "--clock", "real"});
  EXPECT_EQ(found["clock"], "real");
  // A busy machine may miss ticks; then they are counted.
  EXPECT_GT(static_cast<int>(found["ticks"]) + static_cast<int>(found["ticks_missed"]), 400);
}

TEST_F(OnABall, TradeoffWritesItsFilesAndChooses) {
  const json found = result({"tradeoff", at("case"), "--quick", "--out", at("trade"), "--choose",
                             "--deadline", "1s", "--headroom", "0.5"});
  ASSERT_FALSE(found["front"].empty());
  ASSERT_TRUE(found["chosen"].is_object());
  for (const char* name : {"name", "force_error_p95_N", "step_us", "setting", "checked"}) {
    EXPECT_TRUE(found["chosen"].contains(name)) << name;
  }
  EXPECT_EQ(found["chosen"]["checked"]["seed"], 2);
  EXPECT_THAT(listing(*folder / "trade"),
              ElementsAre("front.png", "front.svg", "options.png", "options.svg", "tradeoff.csv",
                          "tradeoff.json"));
  EXPECT_EQ(json::parse(contentOf(*folder / "trade/tradeoff.json"))["front"], found["front"]);
}

TEST_F(OnABall, TradeoffTakesARecordedMotion) {
  result({"simulate", at("case"), "--seconds", "1", "--record", at("motion.palpate")});
  const json found = result({"tradeoff", at("case"), "--quick", "--session", at("motion.palpate"),
                             "--out", at("trade-session")});
  EXPECT_EQ(found["trajectories"].back(), "motion");
}

TEST_F(OnABall, AKnownShapeIsMeasuredAgainstItsClosedForm) {
  const json found = result(
      {"tradeoff", "--shape", "plane", "--voxel", "2", "--quick", "--choose", "--deadline", "1s"});
  EXPECT_EQ(found["reference"],
            "the closed form of the plane, in double precision, with a shell of half the spacing");
}

TEST_F(OnABall, AChoiceUnderAnImpossibleDeadlineFailsItsCheck) {
  const ProgramRun run =
      palpate({"tradeoff", at("case"), "--quick", "--choose", "--deadline", "0.001us", "--json"});
  expectRefused(run, 1, "check-failed");
}

TEST_F(OnABall, InterruptedLeavesNothing) {
  const std::vector<std::string> before = listing(folder->path());
  const ProgramRun run =
      palpateInterrupted({"simulate", at("case"), "--clock", "real", "--seconds", "60", "--record",
                          at("cut.palpate"), "--samples", at("cut.csv"), "--json"},
                         SIGTERM, 2.0);
  expectRefused(run, 5, "cancelled");
  EXPECT_EQ(listing(folder->path()), before);
}

TEST_F(OnABall, TheTimeLimitStopsTheCommand) {
  const ProgramRun run = palpate({"simulate", at("case"), "--clock", "real", "--seconds", "60",
                                  "--limit-seconds", "1", "--json"});
  expectRefused(run, 4, "machine");
  EXPECT_NE(run.err.find("limit"), std::string::npos);
}

TEST_F(OnABall, TheMemoryLimitStopsTheCommand) {
  writeBallScan(*folder / "large.mha", 20000);  // 64 MB of voxels
  const ProgramRun run = palpate(
      {"import", at("large.mha"), "--out", at("large"), "--limit-memory-mib", "128", "--json"});
  expectRefused(run, 4, "machine");
  EXPECT_FALSE(fs::exists(*folder / "large"));
}

TEST_F(OnABall, ProgressLinesAreForAPipe) {
  writeBallScan(*folder / "ball.mha");
  const ProgramRun run = palpate({"import", at("ball.mha"), "--out", at("progress"), "--json"});
  EXPECT_THAT(run.err, testing::ContainsRegex("progress [01]\\.[0-9]+ "));
}

TEST(Devices, ListsTheSimulatedModelsAndWhyOthersAreNot) {
  const json found = palpate({"devices", "--json"}).json();
  std::vector<std::string> models;
  for (const json& device : found["devices"]) {
    if (device["available"] == true) models.push_back(device["model"]);
    EXPECT_EQ(device["reason"].is_null(), device["available"] == true);
  }
  EXPECT_THAT(models, testing::IsSupersetOf({"touch", "touch-x", "premium-6dof"}));
  // Without the vendor's library no Phantom can be listed: then this says what was tried.
  EXPECT_FALSE(std::string(found["library_note"]).empty());
  ASSERT_FALSE(found["tried"].empty());
  for (const json& attempt : found["tried"]) expectKeys(attempt, {"library", "problem", "advice"});
}

TEST(Doctor, CountsEveryWakeUpInItsHistogram) {
  const ProgramRun run = palpate({"doctor", "--seconds", "0.3", "--json"});
  ASSERT_EQ(run.exitCode, 0) << run.err;
  const json found = run.json();
  int counted = 0;
  for (const json& bin : found["histogram"]) counted += static_cast<int>(bin["count"]);
  EXPECT_EQ(counted, found["wakeups"]);
  EXPECT_EQ(counted, 300);
  for (const char* name : {"lateness_us", "priority", "memlock", "machine", "verdict"}) {
    EXPECT_TRUE(found.contains(name)) << name;
  }
}

}  // namespace
}  // namespace palpate::test
