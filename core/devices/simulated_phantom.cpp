#include "core/devices/simulated_phantom.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/devices/arm_model.h"
#include "core/devices/random.h"

namespace palpate {
namespace {

constexpr std::size_t kLongestDelay = 32;  // ticks
constexpr double kVelocityHz = 100.0;
constexpr double kHot = 0.8;  // of the warmth that the continuous force ends in
constexpr double kTremorLow = 8.0, kTremorHigh = 12.0;  // Hz
constexpr int kTremorSines = 3;

/// Involuntary motion of a hand: a few sines, so that any time can be asked for.
class Tremor {
 public:
  Tremor(Random& random, double amplitude) noexcept : amplitude_(amplitude / kTremorSines) {
    for (auto& axis : sines_) {
      for (Sine& s : axis) {
        s.rate = 2.0 * std::numbers::pi * random.uniform(kTremorLow, kTremorHigh);
        s.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
      }
    }
  }
  [[nodiscard]] Eigen::Vector3d at(double t) const noexcept {
    Eigen::Vector3d out = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      for (const Sine& s : sines_[i]) {
        out[static_cast<Eigen::Index>(i)] += amplitude_ * std::sin(s.rate * t + s.phase);
      }
    }
    return out;
  }

 private:
  struct Sine {
    double rate = 0.0, phase = 0.0;
  };
  std::array<std::array<Sine, kTremorSines>, 3> sines_{};
  double amplitude_;
};

double norm(const double (&v)[3]) noexcept {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// The motors' limit: the vector is scaled. What is not a number drives nothing.
void saturate(double (&v)[3], double most) noexcept {
  const double n = norm(v);
  const double s = !std::isfinite(n) ? 0.0 : (n > most ? most / n : 1.0);
  for (double& x : v) x = s > 0.0 ? s * x : 0.0;
}

class SimulatedPhantom final : public HapticDevice {
 public:
  SimulatedPhantom(const ArmParameters& arm, const GripParameters& grip, std::shared_ptr<Hand> hand,
                   std::uint64_t seed, const SimulatedPhantomOptions& options) noexcept
      : arm_(arm),
        options_(options),
        model_(arm, grip),
        hand_(std::move(hand)),
        random_(seed),
        tremor_(random_, options.tremor),
        encoderZero_(random_.uniform(-0.5, 0.5), random_.uniform(-0.5, 0.5),
                     random_.uniform(-0.5, 0.5)) {
    if (options_.encoderStep > 0.0) arm_.encoderStep = options_.encoderStep;
    encoderZero_ *= arm_.encoderStep;
  }

  const DeviceInfo& info() const noexcept override { return arm_.info; }

  Result<void> open() override {
    started_ = false;
    return {};
  }
  void close() noexcept override { write({}); }

  DeviceCondition condition() override {
    DeviceCondition now;
    now.sentence = "Simulated: nothing is felt.";
    const double warmth = std::min(1.0, warmth_.load(std::memory_order_relaxed));
    now.motorTemperature.assign(3, warmth);
    if (warmth >= kHot) now.sentence = "The simulated motors are hot: they give less force.";
    return now;
  }

  DeviceSample read(std::uint64_t tick) noexcept override {
    const double late = lateness();
    const double t = static_cast<double>(tick) * options_.period + late;
    const HandTarget wanted = hand_->target(t, sample_, acting_);
    const bool held = wanted.present && isRigid(wanted.pose_D);
    if (held) wanted_ = wanted;
    wanted_.buttons = wanted.buttons;
    const Eigen::Vector3d x = position(wanted_.pose_D) + tremor_.at(t);
    const Eigen::Quaterniond q = orientation(wanted_.pose_D);
    if (!started_) {
      begin(x, q);
    } else {
      const double passed = options_.period + late - late_;
      drive(passed);
      model_.advance(passed, acting_, x, q, held);
    }
    late_ = late;
    const bool repeats = options_.dropouts > 0.0 && random_.uniform(0.0, 1.0) < options_.dropouts;
    if (!repeats || sample_.index == 0) measure();
    sample_.index = tick;
    sample_.t = static_cast<double>(tick) * options_.period;
    return sample_;
  }

  void write(const Wrench& wrench_D) noexcept override {
    // Newest first: history_[0] acts after one more tick than the hold itself.
    std::copy_backward(history_.begin(), history_.end() - 1, history_.end());
    history_[0] = wrench_D;
  }

 private:
  void begin(const Eigen::Vector3d& x, const Eigen::Quaterniond& q) noexcept {
    model_.reset(x, q);
    history_.fill({});
    acting_ = amplifier_ = {};
    sample_ = {};
    warmth_.store(0.0, std::memory_order_relaxed);
    late_ = 0.0;
    lastX_ = encoders(model_.x());
    lastQ_ = encoders(model_.q());
    v_.setZero();
    w_.setZero();
    started_ = true;
  }

  /// Of this reading behind its tick, s.
  [[nodiscard]] double lateness() noexcept {
    if (options_.jitter <= 0.0) return 0.0;
    double sum = -6.0;  // twelve uniform ones: near enough to a normal one
    for (int i = 0; i < 12; ++i) sum += random_.uniform(0.0, 1.0);
    return std::clamp(options_.jitter * sum, -0.45 * options_.period, 0.45 * options_.period);
  }

  /// What the motors give in the coming `passed` seconds.
  void drive(double passed) noexcept {
    Wrench wanted = history_[std::min<std::size_t>(1 + options_.extraDelay, kLongestDelay - 1)];
    saturate(wanted.force, peakForce());
    saturate(wanted.torque, arm_.info.peakTorque);
    acting_ = options_.amplifierLag > 0.0 ? amplified(wanted, passed) : wanted;
    if (options_.thermalTime <= 0.0) return;
    const double load = norm(acting_.force) / arm_.info.continuousForce;
    const double warmth = warmth_.load(std::memory_order_relaxed);
    warmth_.store(warmth + passed / options_.thermalTime * (load * load - warmth),
                  std::memory_order_relaxed);
  }

  /// The mean over the coming `passed` seconds of what a first-order amplifier gives.
  [[nodiscard]] Wrench amplified(const Wrench& wanted, double passed) noexcept {
    const double left = std::exp(-passed / options_.amplifierLag);
    const double mean = options_.amplifierLag / passed * (1.0 - left);
    Wrench out;
    for (int i = 0; i < 3; ++i) {
      const double force = amplifier_.force[i] - wanted.force[i];
      const double torque = amplifier_.torque[i] - wanted.torque[i];
      out.force[i] = wanted.force[i] + mean * force;
      out.torque[i] = wanted.torque[i] + mean * torque;
      amplifier_.force[i] = wanted.force[i] + left * force;
      amplifier_.torque[i] = wanted.torque[i] + left * torque;
    }
    return out;
  }

  /// Full while the motors are cool; the continuous force once they are hot.
  [[nodiscard]] double peakForce() const noexcept {
    const double hot =
        std::clamp((warmth_.load(std::memory_order_relaxed) - kHot) / (1.0 - kHot), 0.0, 1.0);
    return arm_.info.peakForce + hot * (arm_.info.continuousForce - arm_.info.peakForce);
  }

  [[nodiscard]] Eigen::Vector3d encoders(const Eigen::Vector3d& x) const noexcept {
    const double step = arm_.encoderStep;
    return step * ((x - encoderZero_) / step).array().round().matrix() + encoderZero_;
  }
  /// The gimbal's encoders, as steps of the rotation vector.
  [[nodiscard]] Eigen::Quaterniond encoders(const Eigen::Quaterniond& q) const noexcept {
    const double step = arm_.encoderStepR;
    return expMap(step * (logMap(q) / step).array().round().matrix());
  }

  void measure() noexcept {
    const double a = 1.0 - std::exp(-2.0 * std::numbers::pi * kVelocityHz * options_.period);
    const Eigen::Vector3d x = encoders(model_.x());
    const Eigen::Quaterniond q = encoders(model_.q());
    v_ += a * ((x - lastX_) / options_.period - v_);
    w_ += a * (logMap(q * lastQ_.conjugate()) / options_.period - w_);
    lastX_ = x;
    lastQ_ = q;
    sample_.pose = plain(x, q);
    for (int i = 0; i < 3; ++i) {
      sample_.v[i] = v_[i];
      sample_.w[i] = w_[i];
    }
    sample_.buttons = wanted_.buttons;
  }

  ArmParameters arm_;
  SimulatedPhantomOptions options_;
  ArmModel model_;
  std::shared_ptr<Hand> hand_;
  Random random_;
  Tremor tremor_;
  Eigen::Vector3d encoderZero_;
  std::array<Wrench, kLongestDelay> history_{};
  Wrench acting_;     ///< On the arm.
  Wrench amplifier_;  ///< Where its lag has got to.
  HandTarget wanted_;
  DeviceSample sample_;
  bool started_ = false;
  double late_ = 0.0;  ///< Of the last reading.
  std::atomic<double> warmth_{0.0};
  Eigen::Vector3d lastX_ = Eigen::Vector3d::Zero(), v_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond lastQ_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d w_ = Eigen::Vector3d::Zero();
};

template <class Rows, class Name>
std::vector<std::string> namesOf(const Rows& rows, Name name) {
  std::vector<std::string> out;
  for (const auto& row : rows) out.push_back(name(row));
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

}  // namespace

std::vector<std::string> simulatedModels() {
  return namesOf(armModels(), [](const ArmParameters& a) { return a.info.model; });
}

std::vector<std::string> simulatedGrips() {
  return namesOf(handGrips(), [](const GripParameters& g) { return g.name; });
}

Result<std::unique_ptr<HapticDevice>> makeSimulatedPhantom(const std::string& model,
                                                           std::shared_ptr<Hand> hand,
                                                           std::uint64_t seed,
                                                           const std::string& grip,
                                                           const SimulatedPhantomOptions& options) {
  const auto arm = std::find_if(armModels().begin(), armModels().end(),
                                [&](const ArmParameters& a) { return a.info.model == model; });
  if (arm == armModels().end()) {
    return fail(inputRefused("There is no simulated device of this name.")
                    .inField("device")
                    .butFound(model)
                    .wants("one of " + listed(simulatedModels())));
  }
  const auto held = std::find_if(handGrips().begin(), handGrips().end(),
                                 [&](const GripParameters& g) { return g.name == grip; });
  if (held == handGrips().end()) {
    return fail(inputRefused("There is no simulated grip of this name.")
                    .inField("grip")
                    .butFound(grip)
                    .wants("one of " + listed(simulatedGrips())));
  }
  if (hand == nullptr) return fail(usageError("A simulated device needs a hand."));
  const bool sensible = options.jitter >= 0.0 && options.dropouts >= 0.0 &&
                        options.dropouts < 1.0 && options.amplifierLag >= 0.0 &&
                        options.encoderStep >= 0.0;
  if (!sensible)
    return fail(usageError("A simulated device was given options that make no sense."));
  if (!(options.period > 0.0) || options.extraDelay > kLongestDelay - 2) {
    return fail(usageError("A simulated device needs a period above 0 and a delay of at most 30."));
  }
  ArmParameters chosen = *arm;
  chosen.friction *= options.frictionScale;
  return std::make_unique<SimulatedPhantom>(chosen, *held, std::move(hand), seed, options);
}

}  // namespace palpate
