#include "core/devices/hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

namespace palpate {
namespace {

class HandFile : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    file_ = std::filesystem::temp_directory_path() /
            ("palpate-hand-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
             info->name() + ".csv");
  }
  void TearDown() override { std::filesystem::remove(file_); }
  Result<std::unique_ptr<Hand>> read(const std::string& text) {
    std::ofstream(file_) << text;
    return readScriptedHand(file_);
  }
  std::filesystem::path file_;
  const std::string header_ = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons\n";
};

TEST_F(HandFile, InterpolatesPlacesLinearlyAndTurnsAlongTheArc) {
  const double c = std::cos(M_PI / 4), s = std::sin(M_PI / 4);
  auto hand = read(header_ + "0,0,10,0,1,0,0,0,0\r\n1.0, 20,30,-40," + std::to_string(c) + "," +
                   std::to_string(s) + ",0,0,1\n");
  ASSERT_TRUE(hand) << sentence(hand.error());
  const HandTarget half = (*hand)->target(0.5, {}, {});
  EXPECT_NEAR(half.pose_D.p[0], 0.010, 1e-12);
  EXPECT_NEAR(half.pose_D.p[1], 0.020, 1e-12);
  EXPECT_NEAR(half.pose_D.p[2], -0.020, 1e-12);
  EXPECT_NEAR(half.pose_D.q[1], std::sin(M_PI / 8), 1e-6);
  EXPECT_EQ(half.buttons, 0u);  // they change at the row
  const HandTarget after = (*hand)->target(9.0, {}, {});
  EXPECT_NEAR(after.pose_D.p[0], 0.020, 1e-12);
  EXPECT_EQ(after.buttons, 1u);
  EXPECT_EQ((*hand)->target(-1.0, {}, {}).pose_D.p[1], 0.010);
}

struct Refusal {
  const char* name;
  std::string rows;
  const char* field;
  const char* message;
};

TEST_F(HandFile, RefusesByFileAndLine) {
  const std::string good = "0,0,0,0,1,0,0,0,1\n";
  const std::vector<Refusal> refusals = {
      {"not a number", good + "1,0,zero,0,1,0,0,0,1\n", "line 3",
       "The hand's path has a row that cannot be read."},
      {"not finite", good + "1,0,nan,0,1,0,0,0,1\n", "line 3",
       "The hand's path has a row that cannot be read."},
      {"too few columns", good + good.substr(0, 9) + "\n", "line 3",
       "The hand's path has a row that cannot be read."},
      {"too many columns", good + "1,0,0,0,1,0,0,0,1,5\n", "line 3",
       "The hand's path has a row that cannot be read."},
      {"times", good + "\n" + good, "line 4", "The times of the hand's path do not rise."},
      {"orientation", good + "1,0,0,0,0,0,0,0,1\n", "line 3",
       "A row of the hand's path has no orientation."},
      {"buttons", good + "1,0,0,0,1,0,0,0,-1\n", "line 3",
       "A row of the hand's path has impossible buttons."},
      {"no rows", "", "line 1", "The hand's path has no rows."},
  };
  for (const Refusal& r : refusals) {
    SCOPED_TRACE(r.name);
    const auto hand = read(header_ + r.rows);
    ASSERT_FALSE(hand);
    EXPECT_EQ(hand.error().kind, ErrorKind::InputRefused);
    EXPECT_EQ(hand.error().message, r.message);
    EXPECT_EQ(hand.error().field, r.field);
    EXPECT_EQ(hand.error().file, file_.string());
  }
}

TEST_F(HandFile, RefusesAnotherHeaderAndAMissingFile) {
  const auto other = read("time,x,y\n0,0,0\n");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().field, "line 1");
  EXPECT_EQ(other.error().found, "\"time,x,y\"");
  EXPECT_EQ(other.error().expected, "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz,buttons");
  const auto missing = readScriptedHand("/nowhere/hand.csv");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().message, "The hand's path cannot be opened.");
}

TEST(StylusAtRest, PointsItsShaftUpAndTowardsTheUser) {
  const PlainPose pose = stylusAtRest(0.04);
  EXPECT_EQ(pose.p[1], 0.04);
  const Eigen::Vector3d shaft = orientation(pose) * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(shaft.x(), 0.0, 1e-12);
  EXPECT_NEAR(shaft.y(), std::cos(M_PI / 6), 1e-12);
  EXPECT_NEAR(shaft.z(), std::sin(M_PI / 6), 1e-12);
}

/// A wall at y = 0 that pushes back with 600 N/m, and a stylus that follows the hand at once.
struct Search {
  double lowest = 1.0, mostForce = 0.0, mostSpeed = 0.0;
  int touches = 0;
};

Search search(std::uint64_t seed, double wallY, std::vector<double>* trace = nullptr) {
  auto hand = makeSearchingHand(seed);
  Search out;
  Wrench felt;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (int i = 0; i < 12000; ++i) {
    const HandTarget t = hand->target(i * 1e-3, {}, felt);
    const Eigen::Vector3d p = position(t.pose_D);
    if (trace != nullptr) trace->insert(trace->end(), {p.x(), p.y(), p.z()});
    const double f = std::max(0.0, 600.0 * 0.15 * (wallY - p.y()));  // through a soft hand
    if (f > 0.3 && felt.force[1] <= 0.3) ++out.touches;
    felt.force[1] = f;
    out.lowest = std::min(out.lowest, p.y());
    out.mostForce = std::max(out.mostForce, f);
    if (i > 0) out.mostSpeed = std::max(out.mostSpeed, (p - last).norm() * 1e3);
    last = p;
    EXPECT_EQ(t.buttons, 1u);
    EXPECT_TRUE(isRigid(t.pose_D));
  }
  return out;
}

TEST(SearchingHand, FindsTheAnatomyByFeelPressesAndComesAgain) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Search s = search(seed, 0.0);
    EXPECT_GE(s.touches, 2) << seed;
    EXPECT_GT(s.mostForce, 0.9) << seed;
    EXPECT_LT(s.mostForce, 1.6) << seed;
    EXPECT_LT(s.mostSpeed, 0.15) << seed;
  }
}

TEST(SearchingHand, GivesUpWhereThereIsNothing) {
  const Search s = search(1, -10.0);
  EXPECT_EQ(s.touches, 0);
  EXPECT_GT(s.lowest, -0.05);
}

TEST(SearchingHand, IsTheSameForTheSameSeedAndDiffersForAnother) {
  std::vector<double> a, b, c;
  (void)search(5, 0.0, &a);
  (void)search(5, 0.0, &b);
  (void)search(6, 0.0, &c);
  EXPECT_EQ(a, b);
  EXPECT_NE(a, c);
}

TEST(FollowingHand, GoesToItsTargetAtAHandsBandwidth) {
  FollowingHand hand({stylusAtRest(0.0), 0, true});
  (void)hand.target(0.0, {}, {});
  HandTarget wanted{stylusAtRest(0.02), 1, true};
  hand.follow(wanted);
  // One time constant of 8 Hz is 19.9 ms.
  HandTarget now;
  for (int i = 1; i <= 20; ++i) now = hand.target(i * 1e-3, {}, {});
  EXPECT_NEAR(now.pose_D.p[1] / 0.02, 1.0 - std::exp(-1.0), 0.01);
  EXPECT_EQ(now.buttons, 1u);
  PlainPose bad;
  bad.p[0] = std::nan("");
  hand.follow({bad, 1, true});
  EXPECT_TRUE(isRigid(hand.target(0.03, {}, {}).pose_D));
}

TEST(RecordedHand, WantsWhatWasRecordedAndLetsGoAtTheEnd) {
  const double c = std::cos(M_PI / 4), s = std::sin(M_PI / 4);
  std::vector<RecordedPose> records(3);
  records[0].t = 1.0;
  records[1].t = 1.5;
  records[2].t = 2.0;
  records[1].pose_D.p[0] = 0.02;
  records[1].pose_D.q[0] = c;
  records[1].pose_D.q[3] = s;
  records[2].pose_D = records[1].pose_D;
  records[0].buttons = records[1].buttons = records[2].buttons = 1;
  auto hand = makeRecordedHand(records);
  ASSERT_TRUE(hand);
  const auto at = [&](double t) { return (*hand)->target(t, {}, {}); };
  EXPECT_EQ(at(0.0).pose_D.p[0], 0.0);
  EXPECT_NEAR(at(1.25).pose_D.p[0], 0.01, 1e-15);
  EXPECT_NEAR(2.0 * std::acos(at(1.25).pose_D.q[0]), M_PI / 4, 1e-12);
  EXPECT_EQ(at(1.9).buttons, 1u);
  EXPECT_EQ(at(5.0).pose_D.p[0], 0.02);
  EXPECT_EQ(at(5.0).buttons, 0u);
  EXPECT_NEAR(at(1.25).pose_D.p[0], 0.01, 1e-15);  // a new run
  EXPECT_TRUE(at(3.0).present);
}

TEST(RecordedHand, WhatIsNoMotionIsRefused) {
  EXPECT_EQ(makeRecordedHand({}).error().message, "The recording holds no pose of the stylus.");
  std::vector<RecordedPose> records(3);
  records[1].t = 1.0;
  records[2].t = 1.0;
  EXPECT_EQ(makeRecordedHand(records).error().field.value_or(""), "sample 2");
  records[2].t = 2.0;
  records[1].pose_D.q[0] = 0.5;
  EXPECT_EQ(makeRecordedHand(records).error().field.value_or(""), "sample 1");
}

}  // namespace
}  // namespace palpate
