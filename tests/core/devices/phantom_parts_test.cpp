/// The parts of the Phantom's driver that need no library: poses, velocities, models, calibration,
/// and a servo tick that takes no memory.

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <random>

#include "core/devices/hdapi.h"
#include "core/devices/phantom_calibration.h"
#include "core/devices/phantom_model.h"
#include "core/devices/phantom_motion.h"
#include "core/devices/phantom_servo.h"
#include "tests/core/devices/fake_hd/fake_machine.h"

namespace {
// Counts what this thread takes while it is asked to.
thread_local bool counting = false;
thread_local int taken = 0;
}  // namespace

// Not inlined: GCC would take malloc and free for a mismatched pair.
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (counting) ++taken;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace palpate::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

std::optional<PlainPose> poseOf(std::array<double, 16> numbers) {
  double c[16];
  std::copy(numbers.begin(), numbers.end(), c);
  return poseFromTransform(c);
}

Eigen::Isometry3d randomPose(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  Eigen::Isometry3d X = at(0.4 * u(random), 0.4 * u(random), 0.4 * u(random));
  X.linear() = expMap(3.0 * Eigen::Vector3d(u(random), u(random), u(random))).toRotationMatrix();
  return X;
}

TEST(PhantomPose, TakesTheNearestRotation) {
  const std::uint64_t seed = 20261122;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> noise(-0.01, 0.01);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Isometry3d X = randomPose(random);
    Eigen::Matrix3d off = X.linear();
    for (int k = 0; k < 9; ++k) off(k) += noise(random);
    auto numbers = transform(X);
    for (std::size_t column = 0; column < 3; ++column)
      for (std::size_t row = 0; row < 3; ++row)
        numbers[4 * column + row] =
            off(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    const auto pose = poseOf(numbers);
    ASSERT_TRUE(pose);
    // The polar factor by singular values: another way to the same rotation.
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(off, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
    EXPECT_LT((orientation(*pose).toRotationMatrix() - nearest).norm(), 1e-12);
    EXPECT_TRUE(isRigid(*pose));
    EXPECT_LT((position(*pose) - X.translation()).norm(), 1e-15);
  }
}

TEST(PhantomPose, RefusesWhatIsNoPose) {
  const auto good = transform(at(0.01, 0.02, 0.03));
  EXPECT_TRUE(poseOf(good));
  for (std::size_t i = 0; i < 16; ++i) {
    for (const double bad : {kNaN, std::numeric_limits<double>::infinity()}) {
      auto numbers = good;
      numbers[i] = bad;
      EXPECT_FALSE(poseOf(numbers)) << i;
    }
  }
  EXPECT_FALSE(poseOf({}));
  auto scaled = good;
  scaled[0] = scaled[5] = scaled[10] = 1.05;
  EXPECT_FALSE(poseOf(scaled));
  auto mirrored = good;
  mirrored[0] = -1.0;
  EXPECT_FALSE(poseOf(mirrored));
  auto far = good;
  far[12] = 2001.0;
  EXPECT_FALSE(poseOf(far));
  auto huge = good;
  huge[1] = 1e308;
  EXPECT_FALSE(poseOf(huge));
}

TEST(PhantomMotion, FindsSteadyVelocitiesInTheDevicesAxes) {
  MotionEstimate motion;
  const Eigen::Vector3d v(0.1, -0.2, 0.3), w(1.0, 2.0, -3.0);
  Eigen::Quaterniond q = expMap(Eigen::Vector3d(0.5, 0.1, -0.4));
  for (int i = 0; i < 100; ++i) {
    motion.update(plain(Eigen::Vector3d(1e-3 * i * v), q));
    q = (expMap(1e-3 * w) * q).normalized();
    if (i == 0) {
      EXPECT_EQ(motion.v()[0], 0.0);
    }
    // First-order low-pass at 100 Hz: after n steps 1 - exp(-2 pi 0.1 n) of the value.
    const double part = 1.0 - std::exp(-2.0 * M_PI * 0.1 * i);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(motion.v()[k], part * v[k], 1e-9);
      EXPECT_NEAR(motion.w()[k], part * w[k], 1e-9);
    }
  }
}

TEST(PhantomMotion, AMissingPoseDecaysTheVelocityAndMakesNoSpikeAfterwards) {
  MotionEstimate motion;
  const auto at_ms = [](int i) {
    return plain(Eigen::Vector3d(1e-4 * i, 0, 0), Eigen::Quaterniond::Identity());
  };
  for (int i = 0; i < 100; ++i) motion.update(at_ms(i));
  EXPECT_NEAR(motion.v()[0], 0.1, 1e-9);
  double last = motion.v()[0];
  for (int i = 0; i < 5; ++i) {
    motion.update(std::nullopt);
    EXPECT_DOUBLE_EQ(motion.pose().p[0], 99e-4);
    EXPECT_LT(motion.v()[0], last);
    last = motion.v()[0];
  }
  for (int i = 105; i < 200; ++i) {
    motion.update(at_ms(i));
    EXPECT_LE(motion.v()[0], 0.1 + 1e-9) << i;  // six ticks' way in six ticks
  }
  EXPECT_NEAR(motion.v()[0], 0.1, 1e-9);
  motion.reset();
  motion.update(at_ms(100000));
  EXPECT_EQ(motion.v()[0], 0.0);  // a jump after a calibration is no motion
}

TEST(PhantomModel, TakesTheLowerOfTableAndDevice) {
  PhantomFacts facts;
  facts.model = "Touch X";
  facts.peakForce = 20.0;
  facts.continuousForce = 1.0;
  const DeviceInfo touchX = deviceInfo(facts);
  EXPECT_EQ(touchX.model, "touch-x");
  EXPECT_DOUBLE_EQ(touchX.peakForce, 7.9);
  EXPECT_DOUBLE_EQ(touchX.continuousForce, 1.0);
  EXPECT_DOUBLE_EQ(touchX.couplingStiffness, 600.0);
  EXPECT_DOUBLE_EQ(touchX.workspaceMax[2], 0.060);  // it reported none
}

TEST(PhantomModel, KnowsTheModelsByTheirReportedNames) {
  const auto model = [](const char* reported) {
    PhantomFacts facts;
    facts.model = reported;
    return deviceInfo(facts).model;
  };
  EXPECT_EQ(model("Touch"), "touch");
  EXPECT_EQ(model("Touch HID"), "touch");
  EXPECT_EQ(model("Touch X"), "touch-x");
  EXPECT_EQ(model("PHANTOM Omni"), "touch");
  EXPECT_EQ(model("PHANTOM Desktop"), "touch-x");
  EXPECT_EQ(model("PHANTOM Premium 1.5 6DOF"), "premium-6dof");
  EXPECT_EQ(model("PHANTOM Premium 3.0 6DOF"), "premium-3-6dof");
  EXPECT_EQ(model("Touchstone"), "phantom");
  EXPECT_EQ(model(""), "phantom");
}

TEST(PhantomModel, AnUnknownDeviceGetsTheWeakestLimitsAndOnlyTheTorqueItClaims) {
  PhantomFacts facts;
  facts.model = "PHANTOM Next";
  facts.outputDof = 6;
  facts.peakForce = 30.0;
  facts.peakTorque = kNaN;
  EXPECT_DOUBLE_EQ(deviceInfo(facts).peakForce, 3.3);
  EXPECT_DOUBLE_EQ(deviceInfo(facts).couplingStiffness, 400.0);
  EXPECT_FALSE(deviceInfo(facts).feelsTorque);
  facts.peakTorque = 0.05;
  EXPECT_TRUE(deviceInfo(facts).feelsTorque);
  EXPECT_DOUBLE_EQ(deviceInfo(facts).peakTorque, 0.05);
}

TEST(PhantomCalibration, ChoosesTheStyleThatAsksLeast) {
  const std::uint32_t chosen[8] = {0, 1, 2, 2, 4, 4, 2, 2};
  for (std::uint32_t styles = 0; styles < 8; ++styles)
    EXPECT_EQ(chooseCalibrationStyle(styles), chosen[styles]) << styles;
  EXPECT_EQ(chooseCalibrationStyle(8), 0u);
}

/// A vendor's library in a few lines that take no memory, to see what the driver itself takes.
struct Bare {
  static hd::Library library() {
    hd::Library bare;
    bare.path = "bare";
    hd::Api& api = bare.api;
    api.disableDevice = api.makeCurrentDevice = api.beginFrame = api.endFrame = [](hd::Handle) {};
    api.getError = []() -> hd::ErrorInfo {
      // Now and then a storm.
      static thread_local int n = 0;
      return {++n % 997 > 990 ? hd::kExceededMaxForce : hd::kSuccess, 0, 0};
    };
    api.getBooleanv = [](hd::Enum, hd::Boolean* out) { *out = 1; };
    api.getIntegerv = [](hd::Enum, std::int32_t* out) { *out = 1; };
    api.getDoublev = [](hd::Enum what, double* out) {
      if (what != hd::kTransform) return;
      std::fill_n(out, 16, 0.0);
      static thread_local int n = 0;
      out[0] = out[5] = out[10] = out[15] = 1.0;
      out[12] = ++n % 100 == 0 ? kNaN : 0.01 * n;
    };
    api.setDoublev = [](hd::Enum, const double*) {};
    api.checkCalibration = []() -> hd::Enum { return hd::kCalibrationOk; };
    api.updateCalibration = [](hd::Enum) {};
    return bare;
  }
};

TEST(PhantomServo, ATickTakesNoMemory) {
  static const hd::Library library = Bare::library();
  VendorScheduler& scheduler = VendorScheduler::of(library);
  PhantomServo servo;
  PhantomServo::Setup setup;
  setup.handle = 0;
  setup.torque = setup.inkwell = setup.warmth = true;
  servo.begin(setup);
  servo.setOwner([](void* owner) noexcept { static_cast<PhantomServo*>(owner)->setWrench({}); },
                 &servo);
  counting = true;
  for (int i = 0; i < 10000; ++i) servo.onTick(scheduler);
  counting = false;
  EXPECT_EQ(taken, 0);
  EXPECT_GT(servo.status().errors, 100u);
  EXPECT_EQ(servo.status().invalidSamples, 100u);
  counting = true;
  int* volatile one = new int(1);  // volatile: the compiler may not leave it out
  delete one;
  counting = false;
  EXPECT_EQ(taken, 1);  // it does count
}

}  // namespace
}  // namespace palpate::test
