#include "core/trade/tradeoff.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/trade/pass.h"
#include "core/trade/trajectory.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {
namespace {

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
    const auto scene = prepared(ball());
    const auto swept = sweepTrade(*scene, 1);
    ASSERT_TRUE(swept) << sentence(swept.error());
    points_ = *swept;
    for (const auto& p : points_) {
      std::printf(
          "%-20s force %.4f N depth %.4f mm normal %.2f deg missed %llu extra %llu "
          "p50 %.1f p99 %.1f p99.9 %.1f us %zu bytes%s\n",
          p.name.c_str(), p.forceErrorP95_N, p.depthErrorP95_mm, p.normalErrorP95_deg,
          static_cast<unsigned long long>(p.contactsMissed),
          static_cast<unsigned long long>(p.contactsExtra), p.stepP50_us, p.stepP99_us,
          p.stepP999_us, p.bytes, p.onFront ? " front" : "");
    }
  }
  static std::vector<TradePoint> points_;
};
std::vector<TradePoint> Sweep::points_;

TEST_F(Sweep, BeginsWithTheReferenceWhichHasNoError) {
  const TradePoint& reference = points_.front();
  EXPECT_EQ(reference.name, "reference");
  EXPECT_EQ(reference.forceErrorP95_N, 0.0);
  EXPECT_EQ(reference.depthErrorP95_mm, 0.0);
  EXPECT_EQ(reference.setting.query.method, QueryMethod::BruteForce);
}

TEST_F(Sweep, ExactOptionsErrAsTheDefaultDoes) {
  const TradePoint& own = named(points_, "default");
  for (const char* name : {"branching=8", "branching=512", "tight-spheres=off",
                           "one-child-skip=off", "side-offset=on", "method=paper"}) {
    const TradePoint& point = named(points_, name);
    EXPECT_EQ(point.forceErrorP95_N, own.forceErrorP95_N) << name;
    EXPECT_EQ(point.depthErrorP95_mm, own.depthErrorP95_mm) << name;
    EXPECT_EQ(point.contactsMissed, own.contactsMissed) << name;
    EXPECT_EQ(point.contactsExtra, own.contactsExtra) << name;
  }
}

TEST_F(Sweep, CoarserShellsErrMoreAndHoldFewerBytes) {
  const TradePoint& own = named(points_, "default");
  const TradePoint& twice = named(points_, "shell=1.00mm");
  const TradePoint& four = named(points_, "shell=2.00mm");
  EXPECT_GT(own.depthErrorP95_mm, 0.0);
  EXPECT_GT(twice.depthErrorP95_mm, own.depthErrorP95_mm);
  EXPECT_GT(four.depthErrorP95_mm, twice.depthErrorP95_mm);
  EXPECT_LT(twice.bytes, own.bytes);
  EXPECT_LT(four.bytes, twice.bytes);
}

TEST_F(Sweep, TheFrontHoldsWhatNothingBeats) {
  bool any = false;
  for (const auto& point : points_) {
    any = any || point.onFront;
    const bool beaten = std::any_of(points_.begin(), points_.end(), [&](const TradePoint& other) {
      return other.forceErrorP95_N < point.forceErrorP95_N &&
             other.stepP999_us < point.stepP999_us && other.bytes < point.bytes;
    });
    if (beaten) {
      EXPECT_FALSE(point.onFront) << point.name;
    }
  }
  EXPECT_TRUE(any);
}

TEST(Pass, AgainstItselfRunAgainHasNoError) {
  const auto scene = prepared(ball());
  const auto samples = approachAndSlide(*scene, 3);
  Pass first = runPass(scene, samples);
  const auto probes = probingPoses(first, samples, 10);
  probe(*scene, probes, first);
  Pass second = runPass(scene, samples);
  probe(*scene, probes, second);
  TradePoint point;
  measure(second, first, 0.5e-3, 0.5e-3, point);
  EXPECT_EQ(point.depthErrorP95_mm, 0.0);
  EXPECT_EQ(point.normalErrorP95_deg, 0.0);
  EXPECT_EQ(point.forceErrorP95_N, 0.0);
  EXPECT_EQ(point.contactsMissed, 0U);
  EXPECT_EQ(point.contactsExtra, 0U);
  EXPECT_GT(point.stepP50_us, 0.0);
  std::size_t contacts = 0;
  for (const auto& row : first.probed) contacts += row.size();
  EXPECT_GT(contacts, 1000U);  // else the zeros above would mean nothing
}

TEST(Pass, AMissingContactIsCounted) {
  Pass reference, pass;
  reference.probed.resize(1);
  pass.probed.resize(1);
  Contact contact;
  contact.depth = 1e-3;
  reference.probed[0].push_back(contact);
  contact.p[0] = 5e-3;
  reference.probed[0].push_back(contact);
  pass.probed[0].push_back(contact);
  contact.p[0] = -5e-3;
  contact.depth = 3e-3;
  pass.probed[0].push_back(contact);
  TradePoint point;
  measure(pass, reference, 0.5e-3, 0.5e-3, point);
  EXPECT_EQ(point.contactsMissed, 1U);
  EXPECT_EQ(point.contactsExtra, 1U);
  EXPECT_NEAR(point.depthErrorP95_mm, 2.0, 1e-12);
}

TEST(Trajectory, ComesDownAndSlidesInContact) {
  const auto scene = prepared(ball());
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto samples = approachAndSlide(*scene, seed);
    ASSERT_EQ(samples.size(), 3000U);
    const Eigen::Isometry3d X_DW = scene->X_WD.inverse();
    EXPECT_NEAR((X_DW * position(samples.front().pose)).y(), 10e-3, 1e-9);
    EXPECT_NEAR((X_DW * position(samples.back().pose)).y(), -1.5e-3, 1e-9);
    for (std::size_t i = 1; i < samples.size(); ++i) {
      // The stated velocity is that of the path, so the coupling's damper pulls rightly.
      const Eigen::Vector3d v(samples[i].v[0], samples[i].v[1], samples[i].v[2]);
      const Eigen::Vector3d moved = position(samples[i].pose) - position(samples[i - 1].pose);
      EXPECT_LT((moved / 1e-3 - v).norm(), 2e-3);
      EXPECT_LT(v.norm(), 0.15);
    }
    const Pass pass = runPass(scene, samples);
    EXPECT_GT(pass.force_W[2000].norm(), 0.1);
  }
}

TradePoint measured(const char* name, double force, double p999) {
  TradePoint point;
  point.name = name;
  point.forceErrorP95_N = force;
  point.stepP999_us = p999;
  return point;
}

TEST(Choice, TakesTheLeastErrorThatFits) {
  const std::vector<TradePoint> points = {measured("exact", 0.0, 900), measured("good", 0.1, 400),
                                          measured("fast", 0.5, 20)};
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.5)->name, "good");
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.95)->name, "exact");
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.1)->name, "fast");
}

TEST(Choice, OfEqualErrorTakesTheFaster) {
  EXPECT_EQ(chooseSetting({measured("a", 0.1, 300), measured("b", 0.1, 200)}, 1e-3, 0.5)->name,
            "b");
}

TEST(Choice, RefusesWhenNothingFits) {
  const auto none = chooseSetting({measured("fast", 0.5, 20)}, 1e-5, 0.5);
  ASSERT_FALSE(none);
  EXPECT_EQ(sentence(none.error()),
            "No measured setting fits the deadline. Field: deadline. Found: 20.0 us, with fast. "
            "Expected: a step of at most 5.0 us at p99.9. "
            "Allow a longer deadline, or a coarser instrument shell.");
  EXPECT_FALSE(chooseSetting({}, 1e-3, 0.5));
  EXPECT_EQ(chooseSetting({}, 0.0, 0.5).error().kind, ErrorKind::Usage);
  EXPECT_EQ(chooseSetting({}, 1e-3, 1.5).error().kind, ErrorKind::Usage);
}

}  // namespace
}  // namespace palpate
