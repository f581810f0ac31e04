// `palpate collide`: the files and fields of interface.md, on a ball whose contacts are known.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "app/collide_options.h"
#include "app/collide_trajectory.h"
#include "imaging/volume_files.h"
#include "tests/app/program_run.h"

namespace palpate::test {
namespace {

using nlohmann::json;

constexpr const char* kPosesHeading = "step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz\n";

std::vector<std::vector<double>> rowsOf(const std::string& csv, std::string& heading) {
  std::istringstream lines(csv);
  std::getline(lines, heading);
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');)
      rows.back().push_back(std::stod(field));
  }
  return rows;
}

// A ball of radius 8 mm, label 3, in an oblique grid of 0.5 x 0.5 x 0.8 mm centred at c.
const Eigen::Vector3d kCentre_mm(12, -30, 45);

LabelGrid obliqueBall() {
  LabelGrid grid;
  grid.geometry.dims = {50, 48, 30};
  grid.geometry.spacing = Eigen::Vector3d(0.5e-3, 0.5e-3, 0.8e-3);
  const Eigen::Vector3d middle = 0.5 * grid.geometry.centre_V(49, 47, 29);
  grid.geometry.X_PV.linear() =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 1, 2).normalized()).toRotationMatrix();
  grid.geometry.X_PV.translation() = 1e-3 * kCentre_mm - grid.geometry.X_PV.linear() * middle;
  grid.labels.resize(grid.geometry.voxelCount());
  for (int k = 0; k < 30; ++k) {
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 50; ++i) {
        const bool in = (grid.geometry.centre_V(i, j, k) - middle).norm() < 8e-3;
        grid.labels[grid.geometry.index(i, j, k)] = in ? 3 : 0;
      }
    }
  }
  return grid;
}

class Collide : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(writeLabelFile(obliqueBall(), folder / "world.nrrd"));
    // A rod along z: points every millimetre, the lowest at the tool's origin.
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 20\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n";
    for (int i = 0; i < 20; ++i) ply += "0 0 " + std::to_string(i) + " 0 0 -1\n";
    writeText(folder / "tool.ply", ply);
    // Its tip at the ball's centre, then lifted out of it, then turned to come from below.
    writeText(folder / "poses.csv",
              std::string(kPosesHeading) + "10,1,0,0,12,0,1,0,-30,0,0,1,45\n" +
                  "11,1,0,0,12,0,1,0,-30,0,0,1,54\n" + "12,1,0,0,12,0,-1,0,-30,0,0,-1,45\n");
  }
  [[nodiscard]] std::string at(const std::string& name) const { return (folder / name).string(); }
  [[nodiscard]] std::vector<std::string> arguments(std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"collide",      "--world", at("world.nrrd"), "--shell",
                                 at("tool.ply"), "--poses", at("poses.csv"),  "--out",
                                 at("out.csv"),  "--json"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  TempFolder folder;
};

TEST_F(Collide, WritesTheFilesAndFieldsOfTheInterface) {
  const ProgramRun run = palpate(arguments({"--contacts", at("contacts.csv"), "--repeats", "3"}));
  ASSERT_EQ(run.exitCode, 0) << run.err;
  const json result = run.json();
  std::vector<std::string> keys;
  for (const auto& [key, value] : result.items()) keys.push_back(key);
  EXPECT_THAT(keys, testing::UnorderedElementsAre("surface_voxels", "bytes", "build_ms", "step_us",
                                                  "method", "options"));
  EXPECT_EQ(result["method"], "hierarchy");
  EXPECT_EQ(result["bytes"]["total"].get<std::size_t>(),
            result["bytes"]["topology"].get<std::size_t>() +
                result["bytes"]["payload"].get<std::size_t>());
  EXPECT_LE(result["step_us"]["p50"].get<double>(), result["step_us"]["max"].get<double>());

  std::string heading;
  const auto steps = rowsOf(contentOf(folder / "out.csv"), heading);
  EXPECT_EQ(heading, "step,contacts,sum_depth_mm,tests,time_us");
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0][0], 10);
  EXPECT_NEAR(steps[0][1], 8, 1);  // points at 0 .. 7 mm are inside, that at 8 is on the surface
  EXPECT_EQ(steps[1][1], 0);
  EXPECT_EQ(steps[1][2], 0);
  EXPECT_NEAR(steps[2][1], 8, 1);

  const auto contacts = rowsOf(contentOf(folder / "contacts.csv"), heading);
  EXPECT_EQ(heading, "step,index,x,y,z,nx,ny,nz,depth_mm,label,flags");
  EXPECT_EQ(contacts.size(), static_cast<std::size_t>(steps[0][1] + steps[2][1]));
  double sum = 0;
  for (const auto& c : contacts) {
    ASSERT_EQ(c.size(), 11U);
    const double side = c[0] == 10 ? 1 : -1;
    EXPECT_NEAR(c[2], 12, 1e-9);
    EXPECT_NEAR(c[3], -30, 1e-9);
    EXPECT_NEAR(c[4], 45 + side * c[1], 1e-9);
    if (c[1] >= 2 && c[1] <= 7) {
      EXPECT_GT(side * c[7], 0.7) << "the normal points out of the ball";
      EXPECT_NEAR(c[8], 8 - c[1], 0.8);
    }
    EXPECT_EQ(c[9], 3);
    EXPECT_EQ(c[10], 0);
    if (c[0] == 10) sum += c[8];
  }
  EXPECT_NEAR(sum, steps[0][2], 1e-9);
}

TEST_F(Collide, EveryMethodAndBranchingGivesTheSameContacts) {
  const auto contactsOf = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--contacts", at("contacts.csv")});
    const ProgramRun run = palpate(arguments(more));
    EXPECT_EQ(run.exitCode, 0) << run.err;
    return contentOf(folder / "contacts.csv");
  };
  for (const char* leaf : {"voxel", "distance"}) {
    const std::string expected = contactsOf({"--leaf", leaf, "--method", "brute"});
    EXPECT_GT(expected.size(), 300U);
    EXPECT_EQ(contactsOf({"--leaf", leaf, "--method", "paper", "--branching", "8"}), expected);
    EXPECT_EQ(contactsOf({"--leaf", leaf, "--method", "paper", "--option", "tight_spheres=off",
                          "--option", "one_child_skip=off", "--option", "side_offset=on"}),
              expected);
    EXPECT_EQ(contactsOf({"--leaf", leaf, "--branching", "512", "--threads", "2"}), expected);
  }
}

TEST_F(Collide, AVoxelBodyIsItsSurfaceVoxels) {
  const ProgramRun run =
      palpate({"collide", "--world", at("world.nrrd"), "--body", at("world.nrrd"), "--poses",
               at("poses.csv"), "--out", at("out.csv"), "--leaf", "voxel", "--json"});
  ASSERT_EQ(run.exitCode, 0) << run.err;
  // A pose that leaves the body where it is puts every surface voxel into itself.
  writeText(folder / "poses.csv", std::string(kPosesHeading) + "0,1,0,0,0,0,1,0,0,0,0,1,0\n");
  const ProgramRun self =
      palpate({"collide", "--world", at("world.nrrd"), "--body", at("world.nrrd"), "--poses",
               at("poses.csv"), "--out", at("out.csv"), "--leaf", "voxel", "--json"});
  ASSERT_EQ(self.exitCode, 0) << self.err;
  std::string heading;
  EXPECT_EQ(rowsOf(contentOf(folder / "out.csv"), heading)[0][1],
            self.json()["surface_voxels"].get<double>());
}

// The distance from p to the nearest voxel box of a label, mm; by trying them all.
double distanceTo(const LabelGrid& grid, int label, const Eigen::Vector3d& p_mm) {
  const GridGeometry& g = grid.geometry;
  const Eigen::Vector3d p = g.X_PV.inverse() * (1e-3 * p_mm);
  double nearest = HUGE_VAL;
  for (int k = 0; k < g.dims[2]; ++k) {
    for (int j = 0; j < g.dims[1]; ++j) {
      for (int i = 0; i < g.dims[0]; ++i) {
        if (grid.at(i, j, k) != label) continue;
        const Eigen::Vector3d out = (p - g.centre_V(i, j, k)).cwiseAbs() - 0.5 * g.spacing;
        nearest = std::min(nearest, out.cwiseMax(0.0).norm());
      }
    }
  }
  return 1e3 * nearest;
}

TEST_F(Collide, TheClearanceIsTheDistanceToTheChosenLabels) {
  LabelGrid grid = obliqueBall();
  for (int k = 0; k < 4; ++k) grid.labels[grid.geometry.index(2, 3, k)] = 7;  // a nerve
  ASSERT_TRUE(writeLabelFile(grid, folder / "world.nrrd"));
  for (const int label : {3, 7}) {
    const ProgramRun run = palpate(arguments(
        {"--clearance", at("clearance.csv"), "--clearance-labels", std::to_string(label)}));
    ASSERT_EQ(run.exitCode, 0) << run.err;
    std::string heading;
    const auto rows = rowsOf(contentOf(folder / "clearance.csv"), heading);
    EXPECT_EQ(heading, "step,clearance_mm,index,tool_x,tool_y,tool_z,x,y,z,label,time_us");
    ASSERT_EQ(rows.size(), 3U);
    double smallest = HUGE_VAL;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto& row = rows[i];
      ASSERT_EQ(row.size(), 11U);
      EXPECT_EQ(row[0], 10.0 + static_cast<double>(i));
      // The rod: points every millimetre from its tip on, upwards, upwards, downwards.
      const double tip = i == 1 ? 54 : 45;
      const double side = i == 2 ? -1 : 1;
      double nearest = HUGE_VAL;
      for (int n = 0; n < 20; ++n) {
        nearest = std::min(nearest, distanceTo(grid, label, {12, -30, tip + side * n}));
      }
      EXPECT_NEAR(row[1], nearest, 1e-6);
      EXPECT_NEAR(
          (Eigen::Vector3d(row[3], row[4], row[5]) - Eigen::Vector3d(12, -30, tip + side * row[2]))
              .norm(),
          0, 1e-6);
      const Eigen::Vector3d anatomy(row[6], row[7], row[8]);
      EXPECT_NEAR((anatomy - Eigen::Vector3d(row[3], row[4], row[5])).norm(), row[1], 1e-6);
      EXPECT_NEAR(distanceTo(grid, label, anatomy), 0, 1e-6);
      EXPECT_EQ(row[9], label);
      smallest = std::min(smallest, row[1]);
    }
    EXPECT_EQ(smallest == 0, label == 3) << "the rod is in the ball and beside the nerve";
    const json result = run.json()["clearance"];
    EXPECT_EQ(result["labels"], json::array({label}));
    EXPECT_EQ(result["min_mm"].get<double>(), smallest);
    EXPECT_EQ(result["beyond_reach"], 0);
  }
  // Of all labels the nearer.
  const ProgramRun all = palpate(arguments({"--clearance", at("clearance.csv")}));
  ASSERT_EQ(all.exitCode, 0) << all.err;
  std::string heading;
  for (const auto& row : rowsOf(contentOf(folder / "clearance.csv"), heading)) {
    EXPECT_EQ(row[9], 3);
  }
}

TEST_F(Collide, WhatIsOutOfReachSaysSo) {
  const ProgramRun run =
      palpate(arguments({"--clearance", at("clearance.csv"), "--clearance-reach", "0.5"}));
  ASSERT_EQ(run.exitCode, 0) << run.err;
  const std::string csv = contentOf(folder / "clearance.csv");
  EXPECT_THAT(csv, testing::HasSubstr("\n11,inf,,,,,,,,,"));
  EXPECT_THAT(csv, testing::HasSubstr("\n10,0,0,"));
  EXPECT_EQ(run.json()["clearance"]["beyond_reach"], 1);
  EXPECT_EQ(run.json()["clearance"]["min_step"], 10);
}

TEST_F(Collide, AClearanceToALabelThatIsNotThereIsRefused) {
  const ProgramRun run =
      palpate(arguments({"--clearance", at("clearance.csv"), "--clearance-labels", "3,9"}));
  expectRefused(run, 3, "input-refused");
  EXPECT_THAT(run.err, testing::HasSubstr("Field: --clearance-labels. Found: 9. Expected: some of "
                                          "3."));
  expectRefused(palpate(arguments({"--clearance-labels", "3"})), 2, "usage");
  expectRefused(palpate(arguments({"--clearance", at("c.csv"), "--clearance-labels", "0"})), 2,
                "usage");
  EXPECT_FALSE(std::filesystem::exists(folder / "clearance.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));
}

TEST_F(Collide, WrongInputIsRefusedAndNothingIsWritten) {
  writeText(folder / "poses.csv", std::string(kPosesHeading) + "0,2,0,0,0,0,1,0,0,0,0,1,0\n");
  const ProgramRun skewed = palpate(arguments());
  expectRefused(skewed, 3, "input-refused");
  EXPECT_THAT(skewed.err, testing::HasSubstr("Line 2 of the poses"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));

  writeText(folder / "tool.ply", "ply\nformat ascii 2.0\n");
  writeText(folder / "poses.csv", std::string(kPosesHeading) + "0,1,0,0,0,0,1,0,0,0,0,1,0\n");
  const ProgramRun badShell = palpate(arguments());
  expectRefused(badShell, 3, "input-refused");
  EXPECT_THAT(badShell.err, testing::HasSubstr("Line 2 of the PLY file"));

  expectRefused(palpate(arguments({"--option", "speed=9"})), 2, "usage");
  EXPECT_FALSE(std::filesystem::exists(folder / "out.csv"));
}

TEST(CollideOptions, AreSetByNameAndRefusedWithTheList) {
  TreeOptions tree;
  QueryOptions query;
  ASSERT_TRUE(
      applyCollideOptions({"surface_only=on", "tight_spheres=0", "side_offset=yes", "stop_level=2",
                           "contact_budget=500", "perceptual_mm=0.5", "coherence=on"},
                          tree, query));
  EXPECT_TRUE(tree.surfaceOnly);
  EXPECT_FALSE(query.tightSpheres);
  EXPECT_TRUE(query.oneChildSkip);
  EXPECT_TRUE(query.sideOffset);
  EXPECT_EQ(query.stopLevel, 2);
  EXPECT_EQ(query.contactBudget, 500U);
  EXPECT_DOUBLE_EQ(query.perceptualBound, 0.5e-3);
  EXPECT_TRUE(query.coherence);
  for (const char* bad :
       {"stop_level", "stop_level=", "stop_level=-1", "side_offset=perhaps", "contact_budget=1e3",
        "nothing=1", "perceptual_mm=-1", "perceptual_mm=nan", "perceptual_mm=0.5mm"}) {
    const auto refused = applyCollideOptions({bad}, tree, query);
    ASSERT_FALSE(refused) << bad;
    EXPECT_EQ(refused.error().kind, ErrorKind::Usage);
    EXPECT_EQ(refused.error().found, bad);
  }
}

TEST(CollideQuantiles, AreTheSmallestTimesThatCoverTheShare) {
  std::vector<CollideStep> steps(1000);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].time_us = static_cast<double>((i * 7) % 1000 + 1);
  }
  const CollideQuantiles q = quantilesOf(steps);
  EXPECT_EQ(q.p50, 500);
  EXPECT_EQ(q.p99, 990);
  EXPECT_EQ(q.p999, 999);
  EXPECT_EQ(q.max, 1000);
  EXPECT_EQ(quantilesOf({}).max, 0);
}

}  // namespace
}  // namespace palpate::test
