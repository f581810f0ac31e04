/// The whole sweep on anatomy of known shape, and faults that it has to see.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/geometry/pose.h"
#include "core/trade/bench.h"
#include "core/trade/felt.h"
#include "core/trade/tradeoff.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

TradeRequest quick(std::uint64_t seed = 1) {
  TradeRequest request;
  request.seed = seed;
  request.effort = TradeEffort::Quick;
  return request;
}

const TradePoint& named(const std::vector<TradePoint>& points, const std::string& name) {
  const auto found = std::find_if(points.begin(), points.end(),
                                  [&name](const TradePoint& p) { return p.name == name; });
  if (found == points.end()) {
    ADD_FAILURE() << "no setting " << name;
    return points.front();
  }
  return *found;
}

class Sweep : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = prepared(ball());
    const auto swept = sweepTrade(*scene_, quick());
    ASSERT_TRUE(swept) << sentence(swept.error());
    sweep_ = *swept;
  }
  static void TearDownTestSuite() { scene_.reset(); }
  static std::shared_ptr<const PreparedScene> scene_;
  static TradeSweep sweep_;
};
std::shared_ptr<const PreparedScene> Sweep::scene_;
TradeSweep Sweep::sweep_;

TEST_F(Sweep, BeginsWithTheReferenceWhichHasNoErrorAndIsNotOffered) {
  const TradePoint& reference = sweep_.points.front();
  EXPECT_EQ(reference.name, "reference");
  EXPECT_EQ(reference.errors.force_N.worst, 0.0);
  EXPECT_FALSE(reference.offered);
  EXPECT_FALSE(reference.onFront);
  EXPECT_EQ(sweep_.points[1].name, "default");
  EXPECT_EQ(sweep_.trajectories.size(), 81U);
}

TEST_F(Sweep, TheLoopsAgreeWhereThePointsAreTheSame) {
  // Same shell, same leaves: what is left is the two loops' own ways of solving.
  const TradePoint& same = named(sweep_.points, "shell=0.25mm");
  EXPECT_LT(same.errors.force_N.median, 0.04);
  EXPECT_LT(same.errors.depth_mm.worst, 0.005);
  EXPECT_LT(same.errors.normal_deg.p95, 0.05);
  // Points on the wall between two cells have the gradient of either, and the tool stands straight.
  EXPECT_LT(same.errors.normal_deg.worst, 5.0);
  EXPECT_EQ(same.errors.missed, 0U);
  EXPECT_EQ(same.errors.extra, 0U);
  EXPECT_GT(same.errors.reference, 1000U);  // else the zeros above would mean nothing
  EXPECT_LE(same.errors.onset_ms.worst, 3.0);
}

TEST_F(Sweep, CoarserShellsErrMoreAndHoldFewerBytes) {
  const TradePoint& own = named(sweep_.points, "default");
  const TradePoint& four = named(sweep_.points, "shell=2.00mm");
  EXPECT_GT(own.errors.depth_mm.p95, 0.0);
  EXPECT_GT(four.errors.depth_mm.p95, own.errors.depth_mm.p95);
  EXPECT_LT(four.cost.bytes, own.cost.bytes);
  EXPECT_LT(four.cost.testsP99, own.cost.testsP99);
}

TEST_F(Sweep, WhatIsCutShowsAsMissed) {
  const TradePoint& own = named(sweep_.points, "default");
  EXPECT_EQ(own.errors.missed, 0U);
  EXPECT_GT(named(sweep_.points, "perceptual=1.00mm").errors.missed, 0U);
}

TEST_F(Sweep, APromiseIsNoBetterThanWhatWasMeasured) {
  for (const TradePoint& point : sweep_.points) {
    if (!point.offered) continue;
    EXPECT_GE(point.promise.force_N, point.errors.force_N.p95) << point.name;
    EXPECT_GE(point.promise.depth_mm, point.errors.depth_mm.p95) << point.name;
    EXPECT_LE(point.promise.force_N, point.errors.force_N.worst) << point.name;
  }
}

TEST_F(Sweep, IsTheSameToTheLastBitAgainOnOneThread) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto again = sweepTrade(*scene_, quick());
  ASSERT_TRUE(again);
  ASSERT_EQ(again->points.size(), sweep_.points.size());
  for (std::size_t i = 0; i < again->points.size(); ++i) {
    const TradePoint &a = sweep_.points[i], &b = again->points[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(std::memcmp(&a.errors, &b.errors, sizeof a.errors), 0) << a.name;
    EXPECT_EQ(a.cost.testsP99, b.cost.testsP99);
    EXPECT_EQ(a.cost.bytes, b.cost.bytes);
  }
}

class SweepCancelled : public Sweep, public testing::WithParamInterface<double> {};
INSTANTIATE_TEST_SUITE_P(At, SweepCancelled, testing::Values(0.01, 0.16, 0.3));

TEST_P(SweepCancelled, Stops) {
  CancelToken token;
  Progress progress;
  progress.cancel = &token;
  progress.report = [&token](double fraction, const std::string&) {
    if (fraction > GetParam()) token.cancel();
  };
  const auto stopped = sweepTrade(*scene_, quick(), progress);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::Cancelled);
}

TEST(ExactOptions, ErrAsTheDefaultDoesToTheLastBit) {
  const auto scene = prepared(ball());
  auto bench = Bench::create(*scene, quick(), {});
  ASSERT_TRUE(bench);
  const auto options = optionsAround(scene->scene.setting, 0.5e-3);
  const auto own = bench->measure({"default", {scene->scene.setting}, {}, {}}, {});
  ASSERT_TRUE(own);
  const std::array<std::string, 7> exact{"branching",      "method",      "tight-spheres",
                                         "one-child-skip", "side-offset", "coherence",
                                         "threads"};
  int tried = 0;
  for (const NamedSetting& single : singleChanges(scene->scene.setting, options)) {
    if (std::find(exact.begin(), exact.end(), single.option) == exact.end()) continue;
    const auto point = bench->measure(single, {});
    ASSERT_TRUE(point);
    EXPECT_EQ(std::memcmp(&point->errors, &own->errors, sizeof own->errors), 0) << single.name;
    ++tried;
  }
  EXPECT_EQ(tried, 9);
}

TEST(Precision, TheReferencesOwnQueryWithTheScenesShellMissesNothing) {
  const auto scene = prepared(ball());
  auto bench = Bench::create(*scene, quick(), {});
  ASSERT_TRUE(bench);
  TradeSetting setting{scene->scene.setting};
  setting.doublePrecision = true;
  const auto exact = bench->measure({"precision=double", setting, {}, {}}, {});
  const auto own = bench->measure({"default", {scene->scene.setting}, {}, {}}, {});
  ASSERT_TRUE(exact && own);
  EXPECT_EQ(exact->errors.missed + exact->errors.extra, 0U);
  // Single precision is worth a micrometre at most: the shell is what errs.
  EXPECT_NEAR(exact->errors.depth_mm.p95, own->errors.depth_mm.p95, 2e-3);
}

TEST(Levels, OfAGovernorChangeNothingOfWhatASettingIsMeasuredToDo) {
  const auto scene = prepared(ball());
  const SimulationSetting own = scene->scene.setting;
  TradeSetting fewer{own};
  fewer.simulation.solverIterations = 5;
  const auto with =
      withLevels(*scene, ladderOf(own, std::vector<MeasuredSetting>{
                                           {"default", own, 10.0, 0.1, 0.1},
                                           {"iterations=5", fewer.simulation, 5.0, 0.2, 0.1}}));
  ASSERT_TRUE(with);
  ASSERT_EQ((*with)->levels.size(), 2U);
  std::vector<TradeErrors> found;
  for (const auto& base : {scene, *with}) {
    auto bench = Bench::create(*base, quick(), {});
    ASSERT_TRUE(bench);
    const auto point = bench->measure({"iterations=5", fewer, {}, {}}, {});
    ASSERT_TRUE(point);
    found.push_back(point->errors);
  }
  EXPECT_EQ(std::memcmp(&found[0], &found[1], sizeof found[0]), 0);
}

TEST(Felt, AStateIsFeltFromItsTickOnNotBefore) {
  Scene slow;
  slow.setting.stepPeriod = 5e-3;
  const auto scene = prepared(ball(), slow);
  Trajectory path = approachPath(*scene);
  path.samples.resize(300);  // on its way, free
  const Pass pass = runPass(scene, recommendedGains({}, 5e-3), path, 1);
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    // Ahead of the hand by less than it moves in a tick: what a state is extrapolated by.
    EXPECT_LT((pass.felt.tool_W[i] - position(path.samples[i].pose)).norm(), 1e-4) << i;
    if (i < 5) {
      EXPECT_EQ(pass.felt.force_W[i].norm(), 0.0) << "nothing holds before the first step's end";
    }
  }
}

/// Bone that the scan's edge cuts open, and a hand that comes in through the cut.
Trajectory throughTheEdge(const PreparedScene& scene) {
  Trajectory path = approachPath(scene);
  path.name = "through the edge";
  const Eigen::Vector3d inside_W = scene.X_WV * scene.labels->geometry.centre_V(20, 32, 20);
  for (std::size_t i = 0; i < path.samples.size(); ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(path.samples.size());
    const Eigen::Vector3d p =
        inside_W - scene.X_WV.linear() * Eigen::Vector3d((1.0 - t) * 60e-3, 0.0, 0.0);
    for (int axis = 0; axis < 3; ++axis) path.samples[i].pose.p[axis] = p[axis];
  }
  return path;
}

TEST(LeftOut, AMotionThatTheReferenceIsLostOnIsNamedAndNotMeasured) {
  const auto scene = prepared(syntheticGrid([](double, double, double z) { return z < 0.0; }));
  TradeRequest request = quick();
  request.recorded = {throughTheEdge(*scene)};
  const auto bench = Bench::create(*scene, request, {});
  ASSERT_TRUE(bench) << sentence(bench.error());
  EXPECT_THAT(bench->leftOut(), testing::Contains("through the edge"));
  EXPECT_THAT(bench->names(), testing::Not(testing::Contains("through the edge")));
  EXPECT_THAT(bench->names(), testing::Contains("approach"));
}

// --- Faults: a setting that claims more accuracy than it has. -----------------------------------

class Fault : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    honest_ = prepared(ball());
    own_ = measured(*honest_);
  }
  static void TearDownTestSuite() { honest_.reset(); }
  /// The default of a scene, against the reference of the scene's labels.
  static TradePoint measured(const PreparedScene& scene) {
    auto bench = Bench::create(scene, quick(), {});
    EXPECT_TRUE(bench);
    auto point = bench->measure({"default", {scene.scene.setting}, {}, {}}, {});
    EXPECT_TRUE(point);
    return *point;
  }
  /// The honest scene with the tree of other labels.
  static PreparedScene withTreeOf(const LabelGrid& labels) {
    PreparedScene scene = *honest_;
    const std::vector<std::uint8_t> values{1};
    auto tree = VoxelTree::build(labels, values, scene.scene.setting.tree);
    EXPECT_TRUE(tree);
    scene.tree = std::make_shared<const VoxelTree>(std::move(*tree));
    return scene;
  }
  static std::shared_ptr<const PreparedScene> honest_;
  static TradePoint own_;
};
std::shared_ptr<const PreparedScene> Fault::honest_;
TradePoint Fault::own_;

TEST_F(Fault, AnatomyThatIsAVoxelTooThickIsSeen) {
  const TradePoint point = measured(withTreeOf(*ball(25.0)));
  EXPECT_GT(point.errors.extra, 100U);
  EXPECT_GT(point.errors.depth_mm.median, own_.errors.depth_mm.p95 + 0.5);
  EXPECT_GT(point.errors.force_N.median, 3.0 * own_.errors.force_N.median);
}

TEST_F(Fault, AnatomyThatIsAVoxelAsideIsSeen) {
  const auto grid = syntheticGrid([](double x, double y, double z) {
    return (x - 1.0) * (x - 1.0) + y * y + z * z < 24.0 * 24.0;
  });
  const TradePoint point = measured(withTreeOf(*grid));
  EXPECT_GT(point.errors.missed + point.errors.extra, 100U);
  EXPECT_GT(point.errors.force_N.p95, 1.5 * own_.errors.force_N.p95);
}

TEST_F(Fault, AHoleThatTheLabelsDoNotHaveIsSeen) {
  LabelGrid holed = *honest_->labels;
  // Where the hand comes down.
  const Eigen::Vector3d site = honest_->X_WV.inverse() * honest_->X_WD.translation();
  for (std::int32_t k = 0; k < 64; ++k) {
    for (std::int32_t j = 0; j < 64; ++j) {
      for (std::int32_t i = 0; i < 64; ++i) {
        if ((holed.geometry.centre_V(i, j, k) - site).norm() < 4e-3) {
          holed.labels[holed.geometry.index(i, j, k)] = 0;
        }
      }
    }
  }
  const TradePoint point = measured(withTreeOf(holed));
  EXPECT_GT(point.errors.missed, 100U);
  EXPECT_GT(point.errors.depth_mm.p95, own_.errors.depth_mm.p95 + 0.1);
}

TEST_F(Fault, AShellWithABareTipIsSeen) {
  PreparedScene scene = *honest_;
  std::vector<Eigen::Vector3d> points, normals;
  for (std::size_t i = 0; i < scene.shell->size(); ++i) {
    if (scene.shell->points_T()[i].z() < 1e-3) continue;
    points.push_back(scene.shell->points_T()[i]);
    normals.push_back(scene.shell->normals_T()[i]);
  }
  auto shell = PointShell::fromPoints(points, normals);
  ASSERT_TRUE(shell);
  scene.shell = std::make_shared<const PointShell>(std::move(*shell));
  const TradePoint point = measured(scene);
  EXPECT_GT(point.errors.depth_mm.p95, own_.errors.depth_mm.p95 + 0.2);
  EXPECT_GT(point.errors.rest_mm.p95, own_.errors.rest_mm.p95 + 0.2);
}

TEST_F(Fault, ContactsThatAreDroppedAreSeen) {
  PreparedScene scene = *honest_;
  scene.scene.setting.contactCapacity = 1;  // of the simulation's; it says nothing of the query's
  const TradePoint point = measured(scene);
  EXPECT_GT(point.errors.force_N.p95, 1.2 * own_.errors.force_N.p95);
}

TEST_F(Fault, ACouplingThatIsSofterThanItSaysIsSeen) {
  auto bench = Bench::create(*honest_, quick(), {});
  ASSERT_TRUE(bench);
  TradeSetting soft{honest_->scene.setting};
  soft.simulation.couplingShare = 0.7;
  const auto point = bench->measure({"soft", soft, {}, {}}, {});
  ASSERT_TRUE(point);
  EXPECT_GT(point->errors.force_N.median, 3.0 * own_.errors.force_N.median);
}

TEST_F(Fault, AServoThatIsLateIsSeen) {
  auto bench = Bench::create(*honest_, quick(), {});
  ASSERT_TRUE(bench);
  TradeSetting slow{honest_->scene.setting};
  slow.simulation.stepPeriod = 10e-3;
  const auto point = bench->measure({"slow", slow, {}, {}}, {});
  ASSERT_TRUE(point);
  EXPECT_GT(point->errors.force_N.p95, 1.5 * own_.errors.force_N.p95);
  EXPECT_GE(point->errors.onset_ms.worst, 3.0);
}

// --- Closed forms -------------------------------------------------------------------------------

class OnKnownShape : public testing::TestWithParam<KnownShape> {};
INSTANTIATE_TEST_SUITE_P(All, OnKnownShape,
                         testing::Values(KnownShape::Sphere, KnownShape::Plane,
                                         KnownShape::Cylinder, KnownShape::Wedge,
                                         KnownShape::Torus),
                         [](const auto& row) { return std::string(nameOf(row.param)); });

TEST_P(OnKnownShape, VoxelsOfAMillimetreErrByTheirSizeAtMost) {
  Scene declared;
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  X_WD.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  X_WD.translation() = topOf(GetParam());
  declared.X_WD = X_WD;
  const auto scene = prepared(std::make_shared<LabelGrid>(voxelsOf(GetParam(), 1e-3)), declared);
  TradeRequest request = quick();
  request.shape = GetParam();
  auto bench = Bench::create(*scene, request, {});
  ASSERT_TRUE(bench) << sentence(bench.error());
  const auto point = bench->measure({"default", {scene->scene.setting}, {}, {}}, {});
  ASSERT_TRUE(point);
  std::printf("%s: depth median %.3f p95 %.3f mm, force median %.3f p95 %.3f N, rest p95 %.3f mm\n",
              nameOf(GetParam()), point->errors.depth_mm.median, point->errors.depth_mm.p95,
              point->errors.force_N.median, point->errors.force_N.p95, point->errors.rest_mm.p95);
  EXPECT_GT(point->errors.reference, 100U);
  EXPECT_LT(point->errors.depth_mm.p95, 1.0);
  EXPECT_GT(point->errors.depth_mm.p95, 0.0);
}

}  // namespace
}  // namespace palpate
