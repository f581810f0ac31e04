#include "core/collision/trajectory_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace palpate {
namespace {

const std::string kHeading = "step,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz\n";
const std::string kIdentity = "0,1,0,0,0,0,1,0,0,0,0,1,0\n";

std::string refusal(const std::string& text) {
  const auto poses = parseTrajectory(text, "poses.csv");
  if (poses) return "accepted";
  EXPECT_EQ(poses.error().kind, ErrorKind::InputRefused);
  EXPECT_EQ(poses.error().file, "poses.csv");
  return sentence(poses.error());
}

TEST(TrajectoryFile, ReadsPosesInMillimetres) {
  const auto poses = parseTrajectory(
      kHeading + "7, 0,-1,0, 1.5 ,1,0,0,-2,0,0,1,3e1\r\n\n-1,1,0,0,0,0,1,0,0,0,0,1,0", "poses.csv");
  ASSERT_TRUE(poses) << sentence(poses.error());
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].step, 7);
  EXPECT_EQ((*poses)[1].step, -1);
  const Eigen::Vector3d moved = (*poses)[0].X_WT * Eigen::Vector3d(0.001, 0, 0);
  EXPECT_LT((moved - Eigen::Vector3d(1.5e-3, -1e-3, 30e-3)).norm(), 1e-15);
}

TEST(TrajectoryFile, ARotationWithinTheToleranceIsMadeExact) {
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  char line[256];
  // Rounded to five digits, as many programs write it.
  std::snprintf(line, sizeof line, "0,%.5f,%.5f,0,0,%.5f,%.5f,0,0,0,0,1.000005,0\n", c, -s, s, c);
  const auto poses = parseTrajectory(kHeading + line, "poses.csv");
  ASSERT_TRUE(poses) << sentence(poses.error());
  const Eigen::Matrix3d R = (*poses)[0].X_WT.linear();
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-15);
  EXPECT_NEAR(R(0, 0), c, 1e-5);
}

TEST(TrajectoryFile, BadFilesAreRefusedByLine) {
  EXPECT_NE(refusal("").find("Line 1 of the poses: the heading is not that of a pose file."),
            std::string::npos);
  EXPECT_NE(refusal("step,x,y,z\n").find("the heading is not"), std::string::npos);
  EXPECT_NE(refusal(kHeading).find("The file has no poses."), std::string::npos);
  EXPECT_NE(refusal(kHeading + kIdentity + "1,2,3\n")
                .find("Line 3 of the poses: the count of fields is wrong."),
            std::string::npos);
  EXPECT_NE(refusal(kHeading + "a,1,0,0,0,0,1,0,0,0,0,1,0\n")
                .find("Line 2 of the poses: the step is not a whole number."),
            std::string::npos);
  EXPECT_NE(refusal(kHeading + "0,1,0,0,0,0,1,0,mm,0,0,1,0\n")
                .find("Line 2 of the poses: a field is not a finite number."),
            std::string::npos);
  EXPECT_NE(refusal(kHeading + "0,1,0,0,nan,0,1,0,0,0,0,1,0\n").find("tx"), std::string::npos);
  EXPECT_NE(refusal(kHeading + "0,1,0,0,inf,0,1,0,0,0,0,1,0\n").find("not a finite number"),
            std::string::npos);
  EXPECT_NE(refusal(kHeading + "0,1,0,0,+-5,0,1,0,0,0,0,1,0\n").find("not a finite number"),
            std::string::npos);
  EXPECT_EQ(refusal(kHeading + "+1,+1,0,0,+5,0,1,0,0,0,0,1,0\n"), "accepted");
  EXPECT_NE(refusal(kHeading + kIdentity + "\n" + "0,1.0001,0,0,0,0,1,0,0,0,0,1,0\n")
                .find("Line 4 of the poses: r00 to r22 are not a rotation."),
            std::string::npos);
  EXPECT_NE(refusal(kHeading + "0,-1,0,0,0,0,1,0,0,0,0,1,0\n")
                .find("Line 2 of the poses: r00 to r22 mirror; they are not a rotation."),
            std::string::npos);
  EXPECT_NE(refusal(kHeading + "0,0,0,0,0,0,0,0,0,0,0,0,0\n").find("not a rotation"),
            std::string::npos);
}

TEST(TrajectoryFile, AMissingFileIsRefused) {
  const auto poses = readTrajectory("/nowhere/poses.csv");
  ASSERT_FALSE(poses);
  EXPECT_EQ(poses.error().message, "There is no such file.");
  EXPECT_EQ(poses.error().file, "/nowhere/poses.csv");
  const auto folder = readTrajectory("/");
  ASSERT_FALSE(folder);
  EXPECT_EQ(folder.error().message, "This is a folder, not a file.");
}

}  // namespace
}  // namespace palpate
