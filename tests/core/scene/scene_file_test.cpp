#include <gtest/gtest.h>

#include <random>

#include "core/geometry/pose.h"
#include "core/scene/scene.h"
#include "core/scene/scene_text.h"
#include "tests/core/scene/temporary_folder.h"

namespace palpate {
namespace {

std::string refusal(const std::string& text) {
  const auto scene = sceneFromText(text, "case/scene.toml");
  if (scene) return "accepted";
  EXPECT_EQ(scene.error().kind, ErrorKind::InputRefused);
  return sentence(scene.error());
}

Scene unusualScene() {
  Scene scene;
  scene.name = "a \"quoted\" name\nover two lines, with \\ and é";
  scene.labels = {"bone", "soft-tissue"};
  scene.instrument = "hook-probe";
  scene.device = "touch";
  scene.setting.tree = {Branching::Children512, LeafModel::Voxel, true};
  scene.setting.query = {QueryMethod::Paper, false, false, true, 2, 777};
  scene.setting.query.perceptualBound = 0.43e-3;
  scene.setting.shellSpacing = 0.37e-3;
  scene.setting.stepPeriod = 3e-3;
  scene.setting.contactCapacity = 1234;
  scene.setting.solverIterations = 99;
  scene.setting.friction = false;
  scene.setting.couplingShare = 0.37;
  scene.bodies = {{"fragment", false, 0.1}, {"stone", true, 12.5}};
  scene.surroundings.gravity = {0.1, 9.81, -0.3};
  scene.surroundings.drag = 3.3;
  scene.region = SceneBox{{-10.1, 0.2, 1e-7}, {20.3, 1.0 / 3.0, 5.7}};
  scene.reach = Reach::Device;
  scene.workspace = SceneBox{{-190.5, -133.5, -95.5}, {190.5, 133.5, 95.5}};
  return scene;
}

TEST(SceneFile, EveryFieldSurvivesARoundTripToTheBit) {
  const Scene scene = unusualScene();
  TemporaryFolder folder;
  ASSERT_TRUE(writeScene(scene, folder / "scene.toml"));
  const auto back = readScene(folder / "scene.toml");
  ASSERT_TRUE(back) << sentence(back.error());
  EXPECT_EQ(back->name, scene.name);
  EXPECT_EQ(back->labels, scene.labels);
  EXPECT_EQ(back->instrument, scene.instrument);
  EXPECT_EQ(back->device, scene.device);
  EXPECT_FALSE(back->X_WD);
  const SimulationSetting& a = scene.setting;
  const SimulationSetting& b = back->setting;
  EXPECT_EQ(b.tree.branching, a.tree.branching);
  EXPECT_EQ(b.tree.leaf, a.tree.leaf);
  EXPECT_EQ(b.tree.surfaceOnly, a.tree.surfaceOnly);
  EXPECT_EQ(b.query.method, a.query.method);
  EXPECT_EQ(b.query.tightSpheres, a.query.tightSpheres);
  EXPECT_EQ(b.query.oneChildSkip, a.query.oneChildSkip);
  EXPECT_EQ(b.query.sideOffset, a.query.sideOffset);
  EXPECT_EQ(b.query.stopLevel, a.query.stopLevel);
  EXPECT_EQ(b.query.contactBudget, a.query.contactBudget);
  EXPECT_EQ(b.query.perceptualBound, a.query.perceptualBound);
  EXPECT_EQ(b.shellSpacing, a.shellSpacing);
  EXPECT_EQ(b.stepPeriod, a.stepPeriod);
  EXPECT_EQ(b.contactCapacity, a.contactCapacity);
  EXPECT_EQ(b.solverIterations, a.solverIterations);
  EXPECT_EQ(b.friction, a.friction);
  EXPECT_EQ(b.couplingShare, a.couplingShare);
  ASSERT_EQ(back->bodies.size(), scene.bodies.size());
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    EXPECT_EQ(back->bodies[i].label, scene.bodies[i].label);
    EXPECT_EQ(back->bodies[i].separate, scene.bodies[i].separate);
    EXPECT_EQ(back->bodies[i].leastVolume_mm3, scene.bodies[i].leastVolume_mm3);
  }
  EXPECT_EQ(back->surroundings.gravity, scene.surroundings.gravity);
  EXPECT_EQ(back->surroundings.drag, scene.surroundings.drag);
  EXPECT_EQ(back->reach, scene.reach);
  ASSERT_TRUE(back->region && back->workspace);
  EXPECT_EQ(back->region->least_mm, scene.region->least_mm);
  EXPECT_EQ(back->region->most_mm, scene.region->most_mm);
  EXPECT_EQ(back->workspace->least_mm, scene.workspace->least_mm);
  EXPECT_EQ(back->workspace->most_mm, scene.workspace->most_mm);
}

TEST(SceneFile, DevicePoseSurvivesWithinRounding) {
  constexpr unsigned kSeed = 11;
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 100; ++i) {
    Scene scene;
    const Eigen::Vector3d p(uniform(random), uniform(random), uniform(random));
    const Eigen::Vector3d turn(uniform(random), uniform(random), uniform(random));
    scene.X_WD = isometry(plain(p, expMap(3.0 * turn)));
    const auto back = sceneFromText(sceneText(scene), "x");
    ASSERT_TRUE(back) << sentence(back.error());
    ASSERT_TRUE(back->X_WD);
    // The rotation passes through a quaternion twice: a few units in the last place.
    EXPECT_LT((back->X_WD->matrix() - scene.X_WD->matrix()).cwiseAbs().maxCoeff(), 2e-15);
  }
}

TEST(SceneFile, DefaultsAreThoseOfTheHeader) {
  const auto scene = sceneFromText("format = 1\n", "x");
  ASSERT_TRUE(scene) << sentence(scene.error());
  EXPECT_EQ(scene->instrument, Scene{}.instrument);
  EXPECT_EQ(scene->setting.query.contactBudget, QueryOptions{}.contactBudget);
  EXPECT_EQ(sceneText(*scene), sceneText(Scene{}));
}

TEST(SceneFile, UnknownKeysAreRefusedWithTheListOfKnownOnes) {
  EXPECT_EQ(refusal("format = 1\nregions = 3\n"),
            "The file has a key that is not known. File: case/scene.toml. Field: regions. "
            "Found: regions. Expected: one of: format, name, labels, instrument, device, reach, "
            "region, workspace, device_pose, body, surroundings, setting. "
            "Remove it or correct its spelling.");
  EXPECT_EQ(refusal("format = 1\n[region]\nmin = [0, 0, 0]\n"),
            "The file has a key that is not known. File: case/scene.toml. Field: region.min. "
            "Found: min. Expected: one of: min_mm, max_mm. Remove it or correct its spelling.");
  EXPECT_EQ(refusal("format = 1\n[device_pose]\norigin = [0, 0, 0]\n"),
            "The file has a key that is not known. File: case/scene.toml. Field: "
            "device_pose.origin. Found: origin. Expected: one of: origin_mm, rotation_wxyz. "
            "Remove it or correct its spelling.");
}

TEST(SceneFile, WrongValuesAreRefusedByKeyFoundAndExpected) {
  EXPECT_EQ(refusal("name = \"x\"\n"),
            "The file lacks a key that it must have. File: case/scene.toml. Field: format. "
            "Found: nothing. Expected: format.");
  EXPECT_EQ(refusal("format = 2\n"),
            "The scene was written by a later version of this program. File: case/scene.toml. "
            "Field: format. Found: 2. Expected: at most 1. Update the program.");
  EXPECT_EQ(refusal("format = 1\n[setting]\nbranching = 16\n"),
            "A tree has 8, 64 or 512 children a node. File: case/scene.toml. Field: "
            "setting.branching. Found: 16. Expected: 8, 64 or 512.");
  EXPECT_EQ(refusal("format = 1\n[setting]\nshell_spacing_mm = 0\n"),
            "A number is out of range. File: case/scene.toml. Field: setting.shell_spacing_mm. "
            "Found: 0. Expected: 0.05 to 20.");
  EXPECT_EQ(refusal("format = 1\n[setting]\nshell_spacing_mm = nan\n"),
            "A number is out of range. File: case/scene.toml. Field: setting.shell_spacing_mm. "
            "Found: nan. Expected: 0.05 to 20.");
  EXPECT_EQ(refusal("format = 1\n[setting]\nstep_period_ms = 1.5\n"),
            "A step must last a whole number of servo periods of 1 ms. File: case/scene.toml. "
            "Field: setting.step_period_ms. Found: 1.5. Expected: a whole number of ms.");
  EXPECT_EQ(refusal("format = 1\n[setting]\ncoupling_share = 1.5\n"),
            "A number is out of range. File: case/scene.toml. Field: setting.coupling_share. "
            "Found: 1.5. Expected: 0.1 to 1.");
  EXPECT_EQ(refusal("format = 1\n[[body]]\nseparate = true\n"),
            "The file lacks a key that it must have. File: case/scene.toml. Field: "
            "body[0].label. Found: nothing. Expected: label.");
  EXPECT_EQ(refusal("format = 1\n[[body]]\nlabel = \"a\"\n[[body]]\nlabel = \"a\"\n"),
            "Two bodies are of one label. File: case/scene.toml. Field: body. Found: a. "
            "Expected: a label each; parts of a label are told apart with separate = true.");
  EXPECT_EQ(refusal("format = 1\nlabels = [\"bone\", 3]\n"),
            "A value has the wrong type. File: case/scene.toml. Field: labels. "
            "Found: a whole number. Expected: an array of texts.");
  EXPECT_EQ(refusal("format = 1\n[device_pose]\norigin_mm = [0, 0, 0]\n"
                    "rotation_wxyz = [1, 1, 0, 0]\n"),
            "A rotation is not a unit quaternion. File: case/scene.toml. Field: "
            "device_pose.rotation_wxyz. Found: length 1.4142135623730951. "
            "Expected: length 1 within 0.001.");
  EXPECT_EQ(refusal("format = 1\nname = \n"),
            "The file is not valid TOML. File: case/scene.toml. Field: line 2. "
            "Found: Error while parsing key-value pair: expected value, saw '\\n'. "
            "Correct that line.");
}

TEST(SceneFile, ARegionThatIsNoBoxIsRefused) {
  const std::string start = "format = 1\n[region]\nmin_mm = [0, 0, 0]\n";
  EXPECT_EQ(refusal("format = 1\nregion = 3\n"),
            "A value has the wrong type. File: case/scene.toml. Field: region. "
            "Found: a whole number. Expected: a table.");
  EXPECT_EQ(refusal(start),
            "The file lacks a key that it must have. File: case/scene.toml. Field: "
            "region.max_mm. Found: nothing. Expected: max_mm.");
  EXPECT_EQ(refusal(start + "max_mm = [1, 2]\n"),
            "An array has the wrong length. File: case/scene.toml. Field: region.max_mm. "
            "Found: 2. Expected: an array of 3 numbers.");
  EXPECT_EQ(refusal(start + "max_mm = [1, 0, 1]\n"),
            "A box has no inside. File: case/scene.toml. Field: region.max_mm. "
            "Found: 0 along y. Expected: more than min_mm, 0.");
  EXPECT_EQ(refusal(start + "max_mm = [1, 1, nan]\n"),
            "A number is out of range. File: case/scene.toml. Field: region.max_mm[2]. "
            "Found: nan. Expected: -1e+05 to 1e+05.");
  EXPECT_EQ(refusal("format = 1\n[workspace]\nmin_mm = [0, 0, 5]\nmax_mm = [1, 1, -5]\n"),
            "A box has no inside. File: case/scene.toml. Field: workspace.max_mm. "
            "Found: -5 along z. Expected: more than min_mm, 5.");
  EXPECT_EQ(refusal("format = 1\nreach = \"far\"\n"),
            "There is no such reach. File: case/scene.toml. Field: reach. Found: far. "
            "Expected: all, sealed or device.");
}

TEST(SceneFile, AKeyThatIsAbsentIsTakenFromWhatTheCallerSays) {
  Scene absent;
  absent.reach = Reach::All;
  EXPECT_EQ(sceneFromText("format = 1\n", "x")->reach, Reach::Sealed);
  EXPECT_EQ(sceneFromText("format = 1\n", "x", absent)->reach, Reach::All);
  EXPECT_EQ(sceneFromText("format = 1\nreach = \"sealed\"\n", "x", absent)->reach, Reach::Sealed);
}

TEST(SceneFile, MissingFileIsRefusedByName) {
  const auto scene = readScene("no/such/scene.toml");
  ASSERT_FALSE(scene);
  EXPECT_EQ(sentence(scene.error()),
            "There is no such file. File: no/such/scene.toml. Check the path.");
}

}  // namespace
}  // namespace palpate
