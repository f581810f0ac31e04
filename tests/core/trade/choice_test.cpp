#include "core/trade/choice.h"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TradePoint measured(const char* name, double force, double p999, double depth = 0.0) {
  TradePoint point;
  point.name = name;
  point.errors.force_N.p95 = force;
  point.errors.depth_mm.p95 = depth;
  point.cost.p99_us = 0.5 * p999;
  point.cost.p999_us = p999;
  return point;
}

TEST(Choice, TakesTheLeastErrorThatFits) {
  const std::vector<TradePoint> points = {measured("exact", 0.0, 900), measured("good", 0.1, 400),
                                          measured("fast", 0.5, 20)};
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.5)->name, "good");
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.95)->name, "exact");
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.1)->name, "fast");
}

TEST(Choice, TiesGoByDepthThenToTheScenesOwnSetting) {
  EXPECT_EQ(
      chooseSetting({measured("a", 0.1, 300, 0.2), measured("b", 0.1, 400, 0.1)}, 1e-3, 0.5)->name,
      "b");
  EXPECT_EQ(
      chooseSetting({measured("default", 0.1, 300), measured("b", 0.1, 299)}, 1e-3, 0.5)->name,
      "default");
}

TEST(Choice, WhatNoSceneCanDeclareIsNotChosen) {
  std::vector<TradePoint> points = {measured("reference", 0.0, 10), measured("default", 0.1, 10)};
  points[0].offered = false;
  EXPECT_EQ(chooseSetting(points, 1e-3, 0.5)->name, "default");
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

TEST(Front, HoldsWhatNothingBeats) {
  std::vector<TradePoint> points = {measured("a", 0.1, 300),         measured("b", 0.2, 100),
                                    measured("beaten", 0.2, 200),    measured("worse", 0.3, 100),
                                    measured("twin of a", 0.1, 300), measured("not offered", 0, 1)};
  points.back().offered = false;
  markFront(points);
  std::vector<bool> on;
  for (const auto& point : points) on.push_back(point.onFront);
  EXPECT_EQ(on, (std::vector<bool>{true, true, false, false, true, false}));
}

}  // namespace
}  // namespace palpate
