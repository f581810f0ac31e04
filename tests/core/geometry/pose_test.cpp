#include "core/geometry/pose.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace palpate {
namespace {

TEST(ExponentialMap, LogUndoesItUpToHalfATurn) {
  constexpr unsigned kSeed = 20080313;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int n = 0; n < 1000; ++n) {
    Eigen::Vector3d r(uniform(random), uniform(random), uniform(random));
    if (r.norm() > 1.0) continue;
    r *= std::numbers::pi * std::pow(10.0, -12.0 * (n % 13) / 12.0);
    EXPECT_LT((logMap(expMap(r)) - r).norm(), 1e-12 * std::max(1.0, r.norm())) << r.transpose();
  }
}

TEST(ExponentialMap, AgreesWithEigensAngleAxis) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -2, 0.5).normalized();
  for (const double angle : {1e-9, 1e-5, 1e-3, 0.5, 2.0, 3.1}) {
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, axis));
    EXPECT_LT(expMap(angle * axis).angularDistance(expected), 1e-14) << angle;
  }
}

TEST(ExponentialMap, LogTakesTheShorterArc) {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(1.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(logMap(q).norm(), 0.5 * std::numbers::pi, 1e-12);
}

TEST(PlainPose, RefusesWhatIsNotRigid) {
  PlainPose pose;
  EXPECT_TRUE(isRigid(pose));
  pose.q[0] = 0.9;
  EXPECT_FALSE(isRigid(pose));
  pose = {};
  pose.p[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(isRigid(pose));
}

}  // namespace
}  // namespace palpate
