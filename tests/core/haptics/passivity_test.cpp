#include "core/haptics/passivity.h"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

DeviceSample at(double x, double v = 0.0) {
  DeviceSample s;
  s.pose.p[0] = x;
  s.v[0] = v;
  return s;
}

Wrench force(double f) {
  Wrench w;
  w.force[0] = f;
  return w;
}

TEST(PassivityObserver, BooksTheHeldForceOverTheDisplacement) {
  // A spring pressed in by 1 mm and let out: each tick's force acts over the next displacement.
  PassivityObserver o;
  double expected = 0.0, x = 0.0, f = 0.0;
  for (int i = 0; i <= 100; ++i) {
    const double next = 1e-3 * std::sin(M_PI * i / 100.0);
    expected -= f * (next - x);
    x = next;
    o.observe(at(x));
    EXPECT_NEAR(o.energy(), expected, 1e-15);
    f = -500.0 * x;
    o.commit(force(f));
  }
  // The hold of a spring gives back a little more than it took: ½·K·Σ dx².
  EXPECT_LT(o.energy(), 0.0);
}

TEST(PassivityObserver, CountsTorqueOverTheTurn) {
  PassivityObserver o;
  DeviceSample s;
  o.observe(s);
  Wrench w;
  w.torque[2] = 0.1;
  o.commit(w);
  s.pose = plain(Eigen::Vector3d::Zero(), expMap({0, 0, 0.01}));
  o.observe(s);
  EXPECT_NEAR(o.energy(), -0.1 * 0.01, 1e-15);
}

TEST(PassivityObserver, DampsOnlyWhenTheBalanceIsNegative) {
  PassivityObserver o;
  o.observe(at(0.0));
  Wrench out = o.dissipate(force(1.0), at(0.0, 0.1), 1e-3, 3.0);
  EXPECT_EQ(out.force[0], 1.0);
  o.commit(force(1.0));
  o.observe(at(1e-5));  // driven: 10 µJ given
  out = o.dissipate(force(1.0), at(1e-5, 0.1), 1e-3, 3.0);
  EXPECT_NEAR(out.force[0], 1.0 - 1e-5 / (1e-3 * 0.01) * 0.1, 1e-9);  // α = -E/(T·v²) = 1
  o.commit(force(1.0));
  o.observe(at(2e-4));
  out = o.dissipate(force(1.0), at(2e-4, 0.1), 1e-3, 3.0);
  EXPECT_NEAR(out.force[0], 1.0 - 3.0 * 0.1, 1e-12);  // no more than the most
}

TEST(PassivityObserver, LetsAWrenchDriveTheHandOnlyAsFarAsTheBalanceGoes) {
  PassivityObserver o;
  o.observe(at(0.0));
  EXPECT_EQ(o.passiveFraction(force(1.0), at(0.0, -0.12), 1e-3), 1.0);  // it brakes
  EXPECT_EQ(o.passiveFraction(force(0.08), at(0.0), 1e-3), 1.0);
  EXPECT_NEAR(o.passiveFraction(force(1.0), at(0.0, 0.1), 1e-3),
              kPassivityReserve / (1e-4 + kUnforeseenMove), 1e-9);
  o.commit(force(-1.0));
  DeviceSample moved = at(1e-3);  // 1 mJ taken, as far as its velocity said
  o.observe(at(0.0, 0.1));
  moved.t = 0.01;
  o.observe(moved);
  EXPECT_EQ(o.passiveFraction(force(1.0), at(1e-3, 0.1), 1e-3), 1.0);
}

TEST(PassivityObserver, AnArmThatIsNeverWhereItsVelocitySaysIsTrustedLess) {
  PassivityObserver o;
  o.observe(at(0.0));
  EXPECT_EQ(o.passiveFraction(force(0.05), at(0.0), 1e-3), 1.0);
  DeviceSample s = at(5e-4);  // half a millimetre out of the blue, twice that is expected next
  s.t = 1e-3;
  o.observe(s);
  EXPECT_NEAR(o.passiveFraction(force(0.05), s, 1e-3), kPassivityReserve / (0.05 * 1e-3), 1e-9);
  for (int i = 0; i < 3000; ++i) {
    s.t += 1e-3;
    o.observe(s);
  }
  EXPECT_EQ(o.passiveFraction(force(0.05), s, 1e-3), 1.0);  // forgotten
}

TEST(PassivityObserver, ASpentBalanceCanBeEarnedBack) {
  PassivityObserver o;
  o.observe(at(0.0));
  o.commit(force(1.0));
  o.observe(at(3e-5));  // 30 µJ given
  double x = 3e-5;
  for (int i = 0; i < 300; ++i) {  // pressed against the force by 15 mm
    const double f = o.passiveFraction(force(1.0), at(x, -0.05), 1e-3);
    o.commit(force(f));
    x -= 5e-5;
    o.observe(at(x));
  }
  EXPECT_GT(o.energy(), 0.0);
}

// The worst that the prediction allows: the hand gives way by the unforeseen move in every tick, or
// goes back and forth by it, for ten seconds. No number of small leaks adds up to the promise.
TEST(PassivityObserver, ManyTicksOfGivingWayDoNotWearTheFloorAway) {
  for (const int period : {1, 2, 5, 50}) {
    PassivityObserver o;
    double x = 0.0;
    o.observe(at(x));
    for (int i = 0; i < 10000; ++i) {
      o.commit(force(3.0 * o.passiveFraction(force(3.0), at(x), 1e-3)));
      const bool back = period > 1 && i / period % 2 == 1;
      x += back ? -kUnforeseenMove : kUnforeseenMove;
      o.observe(at(x));
      ASSERT_GE(o.energy(), -20e-6) << "tick " << i << ", turning every " << period;
    }
  }
}

TEST(PassivityObserver, FailsBeyondItsReachAndStartsAnewWhenCleared) {
  PassivityObserver o;
  o.observe(at(0.0));
  o.commit(force(1.0));
  o.observe(at(6e-4));
  EXPECT_TRUE(o.failed());
  o.rebase();
  EXPECT_FALSE(o.failed());
  EXPECT_NEAR(o.energy(), -6e-4, 1e-12);  // the record is not rewritten
}

}  // namespace
}  // namespace palpate
