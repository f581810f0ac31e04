#include "core/dynamics/loose_body.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

MassProperties cube() {
  MassProperties m;
  m.mass = 2e-3;
  m.p_TC = {0.01, 0.02, 0.03};
  m.I_C = Eigen::Matrix3d::Identity() * 3e-8;
  return m;
}

TEST(LooseBody, FallsAsTheClosedFormOfItsDragSays) {
  LooseBodySettings settings;
  settings.gravity = {0, 9.81, 0};
  settings.drag = 10.0;
  LooseBody body(cube(), settings);
  ASSERT_TRUE(body.reset(PlainPose{}));
  for (int i = 0; i < 500; ++i) {
    body.accelerate(1e-3);
    body.advance(1e-3);
  }
  // v = g/c (1 - exp(-c t)), within the step's first order: h g c t exp(-c t) / 2 = 1.65e-4.
  EXPECT_NEAR(body.body().velocity().y(), 0.981 * (1.0 - std::exp(-5.0)), 1.7e-4);
  const double fallen = 0.981 * (0.5 - 0.1 * (1.0 - std::exp(-5.0)));
  EXPECT_NEAR(body.body().centre().y() - 0.02, fallen, 1e-3);
}

TEST(LooseBody, WithoutGravityAndDragItKeepsItsVelocityToTheBit) {
  LooseBody body(cube(), {});
  ASSERT_TRUE(body.reset(PlainPose{}));
  BodyResponse pushed;
  pushed.twist << 0.1, 0.2, 0.3, 1, 2, 3;
  body.take(pushed, 1e-3);
  const Eigen::Vector3d v = body.body().velocity();
  for (int i = 0; i < 1000; ++i) {
    body.accelerate(1e-3);
    body.advance(1e-3);
  }
  EXPECT_EQ(body.body().velocity(), v);
  EXPECT_FALSE(body.speedCapped());
}

TEST(LooseBody, NoPointMovesFartherThanItMay) {
  LooseBodySettings settings;
  settings.maxTravel = 1e-3;
  settings.reach = 0.05;
  LooseBody body(cube(), settings);
  ASSERT_TRUE(body.reset(PlainPose{}));
  BodyResponse thrown;
  thrown.twist << 5, 0, 0, 0, 0, 50;
  body.take(thrown, 1e-3);
  EXPECT_TRUE(body.speedCapped());
  const Eigen::Vector3d far(0.05, 0, 0);
  const Eigen::Vector3d before = body.X_WB() * far;
  body.advance(1e-3);
  EXPECT_LE((body.X_WB() * far - before).norm(), 1e-3 * (1 + 1e-9));
  PlainPose bad;
  bad.q[0] = 2.0;
  EXPECT_FALSE(body.reset(bad));
}

}  // namespace
}  // namespace palpate
