#include <gtest/gtest.h>

#include <random>

#include "core/geometry/pose.h"
#include "core/simulation/approach.h"
#include "core/simulation/bits.h"
#include "core/simulation/histogram.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

FeltLabels one() {
  FeltLabels felt{};
  felt[1] = true;
  return felt;
}

/// Distance in mm along +y of D from its origin to the first place that is outside `grid`'s label.
bool solidAt(const LabelGrid& grid, const Eigen::Vector3d& p_P) {
  const auto v = grid.geometry.voxelAt(grid.geometry.X_PV.inverse() * p_P);
  return grid.geometry.contains(v[0], v[1], v[2]) && grid.at(v[0], v[1], v[2]) == 1;
}

void expectOnSurface(const LabelGrid& grid, const Approach& approach) {
  const auto along = [&](double y) -> Eigen::Vector3d {
    return approach.X_PD * Eigen::Vector3d(0, y, 0);
  };
  EXPECT_TRUE(solidAt(grid, along(-1.0e-3)));
  EXPECT_FALSE(solidAt(grid, along(3e-3)));
  for (double y = 5e-3; y < 60e-3; y += 1e-3) EXPECT_FALSE(solidAt(grid, along(y))) << y;
  const Eigen::Matrix3d R = approach.X_PD.linear();
  EXPECT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
}

TEST(Approach, StandsOnABallWithItsYAxisOutOfIt) {
  const auto grid = ball();
  const auto approach = planApproach(*grid, one());
  ASSERT_TRUE(approach);
  EXPECT_TRUE(approach->clear);
  expectOnSurface(*grid, *approach);
  const Eigen::Vector3d centre = grid->geometry.X_PV * grid->geometry.centre_V(31.5, 31.5, 31.5);
  const Eigen::Vector3d out = (approach->X_PD.translation() - centre).normalized();
  EXPECT_GT(approach->X_PD.linear().col(1).dot(out), 0.99);
  // From the patient's upper left, its front towards +z of D.
  EXPECT_GT(out.dot(Eigen::Vector3d(0.5, -0.2, 0.85).normalized()), 0.97);
  EXPECT_LT(approach->X_PD.linear().col(2).y(), -0.8);
}

TEST(Approach, MovesAndTurnsWithTheVolume) {
  // The same ball in a volume that lies obliquely: the place in the patient is the same one.
  const auto straight = ball();
  auto oblique = std::make_shared<LabelGrid>(*straight);
  const Eigen::Isometry3d turn =
      isometry(plain(Eigen::Vector3d(0.02, 0.01, -0.03), expMap(Eigen::Vector3d(0.5, -0.3, 1.1))));
  const Eigen::Vector3d centre_V = straight->geometry.centre_V(31.5, 31.5, 31.5);
  const Eigen::Vector3d centre_P = straight->geometry.X_PV * centre_V;
  oblique->geometry.X_PV.linear() = turn.linear();
  oblique->geometry.X_PV.translation() = centre_P - turn.linear() * centre_V;
  const auto a = planApproach(*straight, one());
  const auto b = planApproach(*oblique, one());
  ASSERT_TRUE(a && b);
  // Within the stairs of a voxel.
  EXPECT_LT((a->X_PD.translation() - b->X_PD.translation()).norm(), 2e-3);
  EXPECT_GT(a->X_PD.linear().col(1).dot(b->X_PD.linear().col(1)), 0.99);
}

TEST(Approach, GoesAroundAHole) {
  // A shell whose upper left is cut away: the first direction looks through the hole.
  const Eigen::Vector3d hole = Eigen::Vector3d(0.5, -0.2, 0.85).normalized();
  const auto grid = syntheticGrid([&hole](double x, double y, double z) {
    const Eigen::Vector3d p(x, y, z);
    const bool shell = p.norm() < 26.0 && p.norm() > 21.0;
    return shell && p.normalized().dot(hole) < 0.8;
  });
  const auto approach = planApproach(*grid, one());
  ASSERT_TRUE(approach);
  EXPECT_TRUE(approach->clear);
  expectOnSurface(*grid, *approach);
}

TEST(Approach, ThinHollowThingsStillGetAPlace) {
  // One wire, beside which every ray passes or which is too thin to be an even patch.
  const auto grid = syntheticGrid(
      [](double x, double y, double) { return std::abs(x - 20.0) < 1 && std::abs(y) < 1; });
  const auto approach = planApproach(*grid, one());
  ASSERT_TRUE(approach);
  EXPECT_FALSE(approach->clear);
  EXPECT_TRUE(approach->X_PD.matrix().allFinite());
}

TEST(Approach, NothingLabelledIsRefused) {
  const auto grid = syntheticGrid([](double, double, double) { return false; });
  const auto approach = planApproach(*grid, one());
  ASSERT_FALSE(approach);
  EXPECT_EQ(sentence(approach.error()),
            "Nothing that can be felt is labelled. "
            "Segment the scan first, for example with the preset ct-bone.");
}

std::string refusal(const Scene& scene, const std::shared_ptr<LabelGrid>& grid,
                    const LabelTable& table) {
  const auto made = prepareScene(scene, grid, table, datasetMaterials(), datasetInstrument());
  if (made) return "accepted";
  EXPECT_EQ(made.error().kind, ErrorKind::InputRefused);
  return sentence(made.error());
}

TEST(PrepareScene, WrongLabelsAreRefusedByName) {
  Scene scene;
  scene.labels = {"bone", "nerve"};
  EXPECT_EQ(refusal(scene, ball(), boneTable()),
            "The scene names a label that the case does not have. Field: labels. Found: nerve. "
            "Expected: one of: bone. Segment that label, or name another in the scene.");
  LabelTable table = boneTable();
  table.push_back({"nerve", 2, {1, 2, 3}, "nerve"});
  scene.labels = {"nerve"};
  EXPECT_EQ(refusal(scene, ball(), table),
            "None of the scene's labels has a voxel. Field: labels. Found: nerve. "
            "Segment that label, or name another in the scene.");
  const auto empty = syntheticGrid([](double, double, double) { return false; });
  EXPECT_EQ(refusal({}, empty, boneTable()),
            "Nothing in the case is labelled. "
            "Segment it first: palpate segment CASE --preset ct-bone.");
  table = boneTable();
  table[0].material = "cheese";
  EXPECT_EQ(refusal({}, ball(), table),
            "A label has a material that is not known. Field: labels.bone.material. "
            "Found: cheese. Expected: one of: bone, tooth, cartilage, soft-tissue, skin, brain, "
            "dura, nerve, vessel, metal. Correct labels.toml, or add the material to "
            "materials.toml.");
  auto short_ = ball();
  short_->labels.pop_back();
  EXPECT_EQ(refusal({}, short_, boneTable()),
            "The labels do not fill their grid. Field: labels. Found: 262143 voxels. "
            "Expected: 262144 voxels.");
}

TEST(PrepareScene, ThePlanTellsWhatIsModelledAndWhatItCosts) {
  auto grid = ball();
  grid->labels[0] = 2;
  LabelTable table = boneTable();
  table.push_back({"nerve", 2, {1, 2, 3}, "nerve"});
  Scene scene;
  scene.labels = {"bone"};
  const auto made = prepareScene(scene, grid, table, datasetMaterials(), datasetInstrument());
  ASSERT_TRUE(made);
  bool bone = false, nerve = false;
  std::size_t bytes = 0;
  for (const PlanRow& row : (*made)->plan) {
    EXPECT_FALSE(row.why.empty()) << row.what;
    if (row.what == "label bone") bone = row.modelled;
    if (row.what == "label nerve") nerve = !row.modelled && row.why == "the scene does not name it";
    bytes += row.bytes;
  }
  EXPECT_TRUE(bone);
  EXPECT_TRUE(nerve);
  EXPECT_GE(bytes, (*made)->tree->stats().topologyBytes + (*made)->tree->stats().payloadBytes);
}

TEST(PrepareScene, ThePoseOfTheSceneIsKept) {
  Scene scene;
  scene.X_WD = isometry(plain(Eigen::Vector3d(1, 2, 3), expMap(Eigen::Vector3d(0.1, 0.2, 0.3))));
  const auto made = prepared(ball(), scene);
  EXPECT_TRUE(made->X_WD.matrix() == scene.X_WD->matrix());
  EXPECT_TRUE(made->X_WV.matrix() == made->labels->geometry.X_PV.matrix());
}

TEST(PrepareScene, TheFingerprintFollowsWhatIsFeltAndNothingElse) {
  const auto base = prepared(ball())->fingerprint;
  EXPECT_EQ(prepared(ball())->fingerprint, base);
  Scene elsewhere;
  elsewhere.name = "another name";
  elsewhere.X_WD = Eigen::Isometry3d::Identity();
  EXPECT_EQ(prepared(ball(), elsewhere)->fingerprint, base);
  EXPECT_NE(prepared(ball(24.5))->fingerprint, base);
  EXPECT_NE(prepared(ball(), {}, "hook-probe")->fingerprint, base);
  Scene coarse;
  coarse.setting.shellSpacing = 1e-3;
  EXPECT_NE(prepared(ball(), coarse)->fingerprint, base);
  auto moved = ball();
  moved->geometry.X_PV.translation().x() += 1e-9;
  EXPECT_NE(prepared(moved)->fingerprint, base);
}

TEST(Histogram, PercentilesAreRightWithinHalfABin) {
  constexpr unsigned kSeed = 5;
  RecordProperty("seed", kSeed);
  std::mt19937_64 random(kSeed);
  std::lognormal_distribution<double> lognormal(9.0, 1.5);
  std::vector<std::int64_t> values;
  Histogram histogram;
  for (int i = 0; i < 100000; ++i) {
    values.push_back(static_cast<std::int64_t>(lognormal(random)));
    histogram.add(values.back());
  }
  std::sort(values.begin(), values.end());
  for (const double share : {0.001, 0.1, 0.5, 0.99, 0.999}) {
    const auto exact =
        static_cast<double>(values[static_cast<std::size_t>(std::ceil(share * 100000.0)) - 1]);
    EXPECT_NEAR(histogram.percentile(share), exact, 0.016 * exact + 0.5) << share;
  }
  EXPECT_EQ(histogram.timing().max, static_cast<double>(values.back()) * 1e-3);
}

TEST(Histogram, EdgesDoNotBreakIt) {
  Histogram histogram;
  EXPECT_EQ(histogram.percentile(0.5), 0.0);
  histogram.add(-5);
  EXPECT_EQ(histogram.percentile(1.0), 0.0);
  histogram.add(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(histogram.count(), 2U);
  EXPECT_GT(histogram.percentile(1.0), 9e18);
  for (std::int64_t v = 0; v < 31; ++v) {
    Histogram single;
    single.add(v);
    EXPECT_EQ(single.percentile(0.5), static_cast<double>(v));
  }
}

TEST(Bits, HashesSeeEveryBitAndTheChain) {
  BitRow<4> a, b;
  a.add(0.0);
  b.add(-0.0);
  EXPECT_NE(a.hash(0), b.hash(0));
  EXPECT_NE(a.hash(0), a.hash(1));
  EXPECT_EQ(a.hash(7), a.hash(7));
}

}  // namespace
}  // namespace palpate
