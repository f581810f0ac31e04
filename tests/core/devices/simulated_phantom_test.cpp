#include "core/devices/simulated_phantom.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/devices/arm_model.h"

namespace palpate {
namespace {

class StillHand final : public Hand {
 public:
  HandTarget target(double, const DeviceSample&, const Wrench& felt) noexcept override {
    felt_ = felt;
    return wanted;
  }
  HandTarget wanted{stylusAtRest(0.02), 1, true};
  Wrench felt_;
};

SimulatedPhantomOptions steady() {
  SimulatedPhantomOptions o;
  o.tremor = 0.0;
  return o;
}

Wrench force(double x) {
  Wrench w;
  w.force[0] = x;
  return w;
}

TEST(ArmModel, AFreeArmIsAMassWithFriction) {
  // No hand: v' = (F - f_c)/M, closed form for a constant force (b small: exponential).
  ArmParameters arm = armModels()[1];
  ArmModel model(arm, handGrips().back());
  model.reset(Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity());
  Wrench f = force(0.5);
  for (int i = 0; i < 100; ++i) {
    model.advance(1e-3, f, Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), true);
  }
  const double tau = arm.mass / arm.damping;
  const double expected = (0.5 - arm.friction) / arm.damping * (1.0 - std::exp(-0.1 / tau));
  EXPECT_NEAR(model.v().x(), expected, 1e-3 * expected);
}

TEST(ArmModel, SticksBelowItsFrictionToTheBit) {
  ArmParameters arm = armModels()[0];
  ArmModel model(arm, handGrips().back());
  model.reset(Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity());
  for (int i = 0; i < 1000; ++i) {
    model.advance(1e-3, force(0.99 * arm.friction), Eigen::Vector3d::Zero(),
                  Eigen::Quaterniond::Identity(), true);
  }
  EXPECT_EQ(model.x().x(), 0.0);
  model.advance(1e-3, force(1.05 * arm.friction), Eigen::Vector3d::Zero(),
                Eigen::Quaterniond::Identity(), true);
  EXPECT_GT(model.x().x(), 0.0);
}

TEST(ArmModel, AHeldArmDeflectsAsItsTwoSpringsInSeries) {
  ArmParameters arm = armModels()[1];
  arm.friction = 0.0;
  for (const GripParameters& grip : handGrips()) {
    if (grip.mass == 0.0) continue;
    ArmModel model(arm, grip);
    model.reset(Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity());
    for (int i = 0; i < 20000; ++i) {
      model.advance(1e-3, force(1.0), Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(),
                    true);
    }
    EXPECT_NEAR(model.x().x(), 1.0 / grip.k1 + 1.0 / grip.k2, 1e-6) << grip.name;
  }
}

TEST(ArmModel, NeverGainsEnergyInAPassiveHand) {
  ArmParameters arm = armModels()[1];
  for (const GripParameters& grip : handGrips()) {
    ArmModel model(arm, grip);
    model.reset(Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity());
    model.advance(5e-3, force(20.0), Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), true);
    const double speed = model.v().norm();
    double late = 0.0;
    for (int i = 0; i < 5000; ++i) {
      model.advance(1e-3, {}, Eigen::Vector3d::Zero(), Eigen::Quaterniond::Identity(), true);
      if (i > 4000) late = std::max(late, model.v().norm());
    }
    EXPECT_LT(late, 0.1 * speed) << grip.name;
  }
}

TEST(SimulatedPhantom, KnowsItsModelsAndRefusesOthersWithTheList) {
  EXPECT_EQ(simulatedModels(), (std::vector<std::string>{"touch", "touch-x", "premium-6dof"}));
  const auto hand = std::make_shared<StillHand>();
  const auto model = makeSimulatedPhantom("falcon", hand, 1);
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().found, "falcon");
  EXPECT_EQ(model.error().expected, "one of touch, touch-x, premium-6dof");
  const auto grip = makeSimulatedPhantom("touch", hand, 1, "iron");
  ASSERT_FALSE(grip);
  EXPECT_EQ(grip.error().expected,
            "one of up-down, left-right, fore-aft, soft, stiff, light, joystick, none");
  EXPECT_FALSE(makeSimulatedPhantom("touch", nullptr, 1));
}

TEST(SimulatedPhantom, ReadsInWholeEncoderSteps) {
  auto hand = std::make_shared<StillHand>();
  auto device = makeSimulatedPhantom("touch", hand, 3);
  ASSERT_TRUE(device);
  ASSERT_TRUE((*device)->open());
  const double first = (*device)->read(0).pose.p[1];
  hand->wanted.pose_D.p[1] += 0.01;
  for (std::uint64_t k = 1; k < 500; ++k) {
    const double steps = ((*device)->read(k).pose.p[1] - first) / 5.5e-5;
    ASSERT_NEAR(steps, std::round(steps), 1e-6);
    (*device)->write({});
  }
  EXPECT_GT((*device)->read(500).pose.p[1] - first, 0.002);
}

TEST(SimulatedPhantom, AForceActsAfterOneTickOfLatency) {
  for (const std::uint32_t extra : {0u, 3u}) {
    auto hand = std::make_shared<StillHand>();
    SimulatedPhantomOptions options = steady();
    options.extraDelay = extra;
    options.frictionScale = 0.0;
    auto device = makeSimulatedPhantom("touch-x", hand, 1, "none", options);
    ASSERT_TRUE(device);
    ASSERT_TRUE((*device)->open());
    (void)(*device)->read(0);
    (*device)->write(force(5.0));
    std::uint64_t k = 1;
    for (; k < 20; ++k) {
      (void)(*device)->read(k);
      (*device)->write({});
      if (hand->felt_.force[0] > 0.0) break;
    }
    // Written at 0, it acts from tick 1+extra to 2+extra; the hand is asked before each advance.
    EXPECT_EQ(k, 3u + extra);
  }
}

TEST(SimulatedPhantom, TheMotorsSaturateAndIgnoreWhatIsNoNumber) {
  auto hand = std::make_shared<StillHand>();
  auto device = makeSimulatedPhantom("touch", hand, 1, "up-down", steady());
  ASSERT_TRUE(device);
  ASSERT_TRUE((*device)->open());
  (void)(*device)->read(0);
  Wrench big;
  big.force[0] = 30.0;
  big.force[1] = 40.0;
  big.torque[0] = 1.0;
  for (std::uint64_t k = 1; k < 10; ++k) {
    (*device)->write(big);
    (void)(*device)->read(k);
  }
  EXPECT_NEAR(std::hypot(hand->felt_.force[0], hand->felt_.force[1]), 3.3, 1e-12);
  EXPECT_EQ(hand->felt_.torque[0], 0.0);
  big.force[2] = std::nan("");
  for (std::uint64_t k = 10; k < 20; ++k) {
    (*device)->write(big);
    const DeviceSample s = (*device)->read(k);
    ASSERT_TRUE(isRigid(s.pose));
  }
  EXPECT_EQ(hand->felt_.force[0], 0.0);
}

TEST(SimulatedPhantom, OnlyThePremiumFeelsTorque) {
  for (const std::string& model : simulatedModels()) {
    auto hand = std::make_shared<StillHand>();
    auto device = makeSimulatedPhantom(model, hand, 1, "up-down", steady());
    ASSERT_TRUE(device);
    ASSERT_TRUE((*device)->open());
    const Eigen::Quaterniond before = orientation((*device)->read(0).pose);
    Wrench twist;
    twist.torque[1] = 0.05;
    for (std::uint64_t k = 1; k < 300; ++k) {
      (*device)->write(twist);
      (void)(*device)->read(k);
    }
    const double turned =
        logMap(orientation((*device)->read(300).pose) * before.conjugate()).norm();
    if (model == "premium-6dof") {
      EXPECT_TRUE((*device)->info().feelsTorque);
      EXPECT_NEAR(turned, 0.05 / (2e-4 * 25.0 * 25.0), 0.02);  // τ / (J·ω²)
    } else {
      EXPECT_EQ(turned, 0.0);
    }
  }
}

TEST(SimulatedPhantom, SameSeedSameBitsOtherSeedOtherTremor) {
  const auto run = [](std::uint64_t seed) {
    auto device = makeSimulatedPhantom("touch-x", makeSearchingHand(seed), seed);
    std::vector<double> out;
    EXPECT_TRUE((*device)->open());
    for (std::uint64_t k = 0; k < 3000; ++k) {
      const DeviceSample s = (*device)->read(k);
      out.insert(out.end(), {s.pose.p[0], s.pose.p[1], s.v[1], s.pose.q[1]});
      (*device)->write(force(0.3 * std::sin(0.01 * static_cast<double>(k))));
    }
    return out;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

TEST(SimulatedPhantom, VelocityIsTheFilteredMotion) {
  class MovingHand final : public Hand {
   public:
    HandTarget target(double t, const DeviceSample&, const Wrench&) noexcept override {
      return {stylusAtRest(0.05 * t), 1, true};
    }
  };
  auto device =
      makeSimulatedPhantom("premium-6dof", std::make_shared<MovingHand>(), 1, "fore-aft", steady());
  ASSERT_TRUE((*device)->open());
  double mean = 0.0;
  for (std::uint64_t k = 0; k < 2000; ++k) {
    const DeviceSample s = (*device)->read(k);
    if (k >= 1000) mean += s.v[1] / 1000.0;
    (*device)->write({});
  }
  EXPECT_NEAR(mean, 0.05, 5e-4);
}

/// A device whose hand is not there, driven by a constant wrench; positions along x by tick.
std::vector<double> driven(const SimulatedPhantomOptions& options, double newtons, int ticks,
                           DeviceCondition* last = nullptr, double* felt = nullptr) {
  auto hand = std::make_shared<StillHand>();
  hand->wanted.present = false;
  auto device = makeSimulatedPhantom("touch-x", hand, 9, "none", options);
  EXPECT_TRUE(device);
  EXPECT_TRUE((*device)->open());
  std::vector<double> x;
  for (int i = 0; i < ticks; ++i) {
    const DeviceSample s = (*device)->read(static_cast<std::uint64_t>(i));
    x.push_back(s.pose.p[0]);
    Wrench w;
    w.force[0] = newtons;
    (*device)->write(w);
    if (felt != nullptr) *felt = s.v[0];
  }
  if (last != nullptr) *last = (*device)->condition();
  return x;
}

TEST(SimulatedPhantom, AnAmplifiersLagDelaysTheMotionByAboutItself) {
  SimulatedPhantomOptions plain, lagging;
  plain.tremor = lagging.tremor = 0.0;
  lagging.amplifierLag = 2e-3;
  const auto a = driven(plain, 1.0, 60), b = driven(lagging, 1.0, 60);
  // Behind a first-order lag a ramp of force arrives late by the time constant: x(t) -> x(t - 2
  // ms).
  EXPECT_LT(b[59], a[59]);
  EXPECT_NEAR(b[59], a[57], 0.2 * (a[58] - a[57]) + 2.3e-5);
}

TEST(SimulatedPhantom, DropoutsRepeatTheLastReadingAsOftenAsAsked) {
  SimulatedPhantomOptions options;
  options.dropouts = 0.2;
  const auto x = driven(options, 2.0, 2000);
  int repeated = 0, moving = 0;
  for (std::size_t i = 100; i < 600; ++i) {  // fast by now: every true reading differs
    ++moving;
    repeated += x[i] == x[i - 1] ? 1 : 0;
  }
  EXPECT_NEAR(repeated, 0.2 * moving, 4 * std::sqrt(0.2 * 0.8 * moving));
}

TEST(SimulatedPhantom, JitterSpreadsTheReadingsOfAnEvenMotionAndDriftsNowhere) {
  SimulatedPhantomOptions even, jittering;
  jittering.jitter = 50e-6;
  const auto a = driven(even, 2.0, 1000), b = driven(jittering, 2.0, 1000);
  // How late or early each reading is, in periods, from how far it is from the even one.
  double mean = 0.0, square = 0.0;
  for (std::size_t i = 600; i < 1000; ++i) {
    const double late = (b[i] - a[i]) / (a[i] - a[i - 1]);
    mean += late / 400.0;
    square += late * late / 400.0;
  }
  EXPECT_NEAR(mean, 0.0, 0.02);
  EXPECT_NEAR(std::sqrt(square), 0.05, 0.01);
}

TEST(SimulatedPhantom, HotMotorsGiveTheContinuousForceAndSaySo) {
  SimulatedPhantomOptions options;
  options.thermalTime = 0.05;  // not a minute, for the test
  DeviceCondition cold, hot;
  double fast = 0.0, slow = 0.0;
  (void)driven(options, 1.0, 2000, &cold);
  (void)driven(options, 7.0, 2000, &hot, &slow);
  options.thermalTime = 0.0;
  (void)driven(options, 7.0, 2000, nullptr, &fast);
  ASSERT_EQ(cold.motorTemperature.size(), 3u);
  EXPECT_NEAR(cold.motorTemperature[0], 1.0 / (1.75 * 1.75), 0.01);  // (F / F_cont)²
  EXPECT_GT(hot.motorTemperature[0], 0.8);
  EXPECT_NE(hot.sentence, cold.sentence);
  EXPECT_LT(slow, 0.5 * fast);
}

TEST(SimulatedPhantom, OptionsThatMakeNoSenseAreRefused) {
  SimulatedPhantomOptions options;
  options.dropouts = 1.0;
  EXPECT_FALSE(makeSimulatedPhantom("touch", std::make_shared<StillHand>(), 1, "soft", options));
  options.dropouts = 0.0;
  options.jitter = std::nan("");
  EXPECT_FALSE(makeSimulatedPhantom("touch", std::make_shared<StillHand>(), 1, "soft", options));
}

}  // namespace
}  // namespace palpate
