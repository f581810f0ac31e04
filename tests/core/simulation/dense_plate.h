#pragma once
/// A plate with a dense shell, pressed flat on bone: a step with far too many contacts.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/simulation/prepared_scene.h"
#include "core/simulation/simulation.h"
#include "tests/core/simulation/synthetic_scene.h"

namespace palpate {

/// 16 mm square, 4 mm high; T in the middle of its lower face, +z up.
inline Instrument plateInstrument(double shellSpacing) {
  Instrument plate;
  plate.name = "plate";
  plate.shellSpacing = shellSpacing;
  const double a = 8e-3, h = 4e-3;
  plate.mesh_T.vertices = {{-a, -a, 0}, {a, -a, 0}, {a, a, 0}, {-a, a, 0},
                           {-a, -a, h}, {a, -a, h}, {a, a, h}, {-a, a, h}};
  plate.mesh_T.triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                            {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  auto mass = massPropertiesOf(plate.mesh_T, 30000.0);  // 31 g
  EXPECT_TRUE(mass) << sentence(mass.error());
  plate.massProperties = *mass;
  return plate;
}

/// Bone below z = 0 of the grid's middle: flat where x < 0, and ridges of 2 mm along y elsewhere,
/// narrower than a coarse shell is apart.
inline std::shared_ptr<LabelGrid> ridgedBone() {
  return syntheticGrid([](double x, double, double z) {
    const double ridge = x > 4.0 ? std::sin(2.0 * std::numbers::pi * x / 6.0) : 0.0;
    return z < (x > 4.0 ? ridge - 1.0 : 0.0) && z > -16.0;
  });
}

/// The middle of the grid's surface, W; the device's axes are the world's.
inline Eigen::Isometry3d overTheBone(const LabelGrid& grid) {
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  X_WD.translation() = grid.geometry.X_PV.translation() + Eigen::Vector3d::Constant(31.5e-3);
  return X_WD;
}

inline std::shared_ptr<const PreparedScene> plateScene(
    double shellSpacing, const SimulationSetting& setting = {},
    const std::shared_ptr<LabelGrid>& grid = ridgedBone()) {
  Scene scene;
  scene.setting = setting;
  scene.setting.contactCapacity = 60000;
  scene.X_WD = overTheBone(*grid);
  auto made =
      prepareScene(scene, grid, boneTable(), datasetMaterials(), plateInstrument(shellSpacing));
  EXPECT_TRUE(made) << sentence(made.error());
  return made ? *made : nullptr;
}

/// What the hand wants, in D: half a second above, down, pressed flat by `deep`, slid over the
/// ridges and back with a slow tilt, up again at the end of `seconds`.
inline PlainPose pressAndSlide(double t, double seconds, double deep, double phase = 0.0) {
  const double down = std::clamp((t - 0.4) / 0.3, 0.0, 1.0);
  const double up = std::clamp((t - (seconds - 0.3)) / 0.2, 0.0, 1.0);
  const double z = 2e-3 - (2e-3 + deep) * (down - up);
  const double slide = std::max(0.0, t - 1.2);
  const double x = -9e-3 + 9e-3 * (1.0 - std::cos(2.0 * slide + (slide > 0 ? phase : 0.0)));
  const double tilt = 0.03 * std::sin(3.0 * slide + phase) * std::min(1.0, slide);
  return plain(Eigen::Vector3d(x, 1e-3 * std::sin(1.3 * slide), z),
               Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY())));
}

/// A hand on an arm of 60 g: a spring and a damper towards where it wants to be, turns as wanted.
/// Always enabled. Deterministic.
class SprungHand final : public HapticDevice {
 public:
  SprungHand(double seconds, double deep, double phase) noexcept
      : seconds_(seconds), deep_(deep), phase_(phase) {
    info_.name = "Sprung hand";
    info_.model = "touch-x";
    info_.simulated = true;
    info_.peakForce = 7.9;
    info_.continuousForce = 7.0;
    info_.couplingStiffness = 600.0;
    x_ = position(pressAndSlide(0.0, seconds_, deep_, phase_));
  }
  [[nodiscard]] const DeviceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Result<void> open() override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] DeviceSample read(std::uint64_t tick) noexcept override {
    const double t = 1e-3 * static_cast<double>(tick);
    const PlainPose wanted = pressAndSlide(t, seconds_, deep_, phase_);
    const Eigen::Vector3d pull = 500.0 * (position(wanted) - x_) - 8.0 * v_ + force_;
    v_ += 1e-3 / 0.06 * pull;
    x_ += 1e-3 * v_;
    DeviceSample sample;
    sample.pose = plain(x_, orientation(wanted));
    for (int axis = 0; axis < 3; ++axis) sample.v[axis] = v_[axis];
    sample.buttons = 1;
    return sample;
  }
  void write(const Wrench& wrench) noexcept override {
    force_ = Eigen::Vector3d(wrench.force[0], wrench.force[1], wrench.force[2]);
  }

 private:
  DeviceInfo info_;
  double seconds_, deep_, phase_;
  Eigen::Vector3d x_ = Eigen::Vector3d::Zero(), v_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
};

inline Eigen::Vector3d forceOf(const Wrench& wrench) {
  return {wrench.force[0], wrench.force[1], wrench.force[2]};
}

/// By nearest rank.
inline double percentileOf(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(
      std::max(std::ceil(share * static_cast<double>(values.size())) - 1.0, 0.0));
  return values[rank];
}

/// Counted work as time: about what a step takes here, and the same everywhere.
inline constexpr ModelledTime kCounted{2.0, 0.004, 0.02, 0.1};

inline double counted_us(const StepRecord& record) {
  return kCounted.step_us + kCounted.test_us * record.tests +
         kCounted.contact_us * record.contacts + kCounted.impulse_us * record.impulses;
}

/// Each setting along the same samples: counted time and the coupling's force against the first
/// one's. A sweep in miniature.
inline std::vector<MeasuredSetting> sweepPlate(const std::shared_ptr<const PreparedScene>& own,
                                               const std::vector<MeasuredSetting>& settings,
                                               const std::vector<DeviceSample>& samples) {
  std::vector<MeasuredSetting> measured = settings;
  std::vector<Eigen::Vector3d> force;
  std::vector<double> depth;
  for (std::size_t s = 0; s < measured.size(); ++s) {
    Scene scene = own->scene;
    scene.setting = measured[s].setting;
    auto made = prepareScene(scene, own->labels, own->table, own->materials, own->instrument);
    EXPECT_TRUE(made) << sentence(made.error());
    Simulation simulation(*made, CouplingGains{});
    std::vector<double> times, forceErrors, depthErrors;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const StepRecord& record = simulation.step(samples[i]);
      times.push_back(counted_us(record));
      const Eigen::Vector3d f = forceOf(simulation.tool().coupling);
      if (s == 0) {
        force.push_back(f);
        depth.push_back(record.depth);
      }
      forceErrors.push_back((f - force[i]).norm());
      depthErrors.push_back(1e3 * std::abs(record.depth - depth[i]));
    }
    measured[s].stepP99_us = percentileOf(times, 0.99);
    measured[s].forceErrorP95_N = percentileOf(forceErrors, 0.95);
    measured[s].depthErrorP95_mm = percentileOf(depthErrors, 0.95);
  }
  return measured;
}

/// What `hand` does against the scene, at 1 kHz, without a governor.
inline std::vector<DeviceSample> samplesOf(const std::shared_ptr<const PreparedScene>& scene,
                                           double seconds, double deep, double phase) {
  class Keep final : public RunSink {
   public:
    bool onTick(const ServoSample& sample) noexcept override {
      samples.push_back(sample.device);
      return true;
    }
    bool onStep(const StepRecord&) noexcept override { return true; }
    bool onCommand(std::uint64_t, const Command&) noexcept override { return true; }
    std::vector<DeviceSample> samples;
  } keep;
  RunOptions options;
  options.sink = &keep;
  auto runner = Runner::create(scene, std::make_unique<SprungHand>(seconds, deep, phase), options);
  EXPECT_TRUE(runner);
  EXPECT_TRUE((*runner)->runVirtual(seconds, {}));
  return keep.samples;
}

/// Settings to try: the own one first, then bounds, budgets, impulses.
inline std::vector<MeasuredSetting> candidates(const SimulationSetting& own) {
  std::vector<MeasuredSetting> list{{"own", own, 0, 0, 0}};
  for (const double mm : {0.3, 0.6, 1.0, 2.0, 4.0}) {
    list.push_back({"bound " + std::to_string(mm).substr(0, 3) + " mm", own, 0, 0, 0});
    list.back().setting.query.perceptualBound = 1e-3 * mm;
  }
  for (const std::uint32_t budget : {4000u, 1000u, 250u}) {
    list.push_back({"budget " + std::to_string(budget), own, 0, 0, 0});
    list.back().setting.query.contactBudget = budget;
  }
  return list;
}

}  // namespace palpate
