#include "app/desktop_simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "app/desktop_signals.h"
#include "app/device_facts.h"
#include "core/base/counted.h"
#include "core/devices/device_list.h"
#include "core/devices/simulated_phantom.h"
#include "core/devices/space_mouse.h"
#include "core/geometry/units.h"
#include "ui/format.h"

namespace palpate {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr auto kLookPeriod = std::chrono::milliseconds(200);
constexpr auto kRetryPeriod = std::chrono::seconds(2);
constexpr double kStartHeight_m = 0.04;  // above the anatomy, as the built-in hand starts

}  // namespace

DesktopSimulation::~DesktopSimulation() {
  (void)stop();  // The window is gone; a recording that could not be finished stays as FILE.part.
}

void DesktopSimulation::setScene(std::shared_ptr<const PreparedScene> scene) {
  (void)stop();
  scene_ = std::move(scene);
  restSnapshot();
}

Result<void> DesktopSimulation::replaceScene(std::shared_ptr<const PreparedScene> scene) {
  if (!running() || !scene) {
    setScene(std::move(scene));
    return {};
  }
  const Eigen::Isometry3d X_WH = scene_->X_WD * isometry(target_.pose_D);
  const Clock clock = clock_;
  setScene(std::move(scene));
  if (auto started = start(clock, {}); !started) return started;
  if (mouseHand_) {
    target_.pose_D = plain(scene_->X_WD.inverse() * X_WH);
    mouseHand_->follow(target_);
  }
  return {};
}

void DesktopSimulation::setDevice(const std::string& name,
                                  const std::optional<DeviceInfo>& hardware) {
  device_ = name;
  hardware_ = hardware;
}

const DeviceInfo& DesktopSimulation::info() {
  if (hardware_) return *hardware_;
  if (infoOf_ != device_) {
    info_ = deviceFacts(device_);
    infoOf_ = device_;
  }
  return info_;
}

void DesktopSimulation::restSnapshot() {
  last_ = Snapshot{};
  if (!scene_) return;
  last_.tool = plain(scene_->X_WD * isometry(stylusAtRest(kStartHeight_m)));
  last_.device = last_.tool;
}

Result<std::unique_ptr<HapticDevice>> DesktopSimulation::makeDevice() {
  mouseHand_.reset();
  if (hardware_) {
    const auto options = phantomOptions(device_);
    if (!options) return fail(options.error());
    return std::make_unique<Phantom>(*options);
  }
  target_ = HandTarget{};
  target_.pose_D = stylusAtRest(kStartHeight_m);
  target_.buttons = 0;  // Arming is the window's, not the stylus' button.
  if (device_ == kSpaceMouse) {
    auto hand = makeSpaceMouseHand();
    if (!hand) return fail(hand.error());
    return makeSimulatedPhantom("touch-x", std::move(*hand), kSeed);
  }
  if (handKind_ == ui::HandKind::Demo) {
    return makeSimulatedPhantom(device_, makeSearchingHand(kSeed), kSeed);
  }
  mouseHand_ = std::make_shared<FollowingHand>(target_);
  return makeSimulatedPhantom(device_, mouseHand_, kSeed);
}

Result<void> DesktopSimulation::start(Clock clock, const std::filesystem::path& recordTo) {
  if (auto stopped = stop(); !stopped) return stopped;
  if (!scene_) {
    return fail(usageError("There is nothing to feel yet.").advise("Segment a tissue first."));
  }
  auto device = makeDevice();
  if (!device) return fail(device.error());
  RunOptions options;
  options.clock = clock;
  options.seed = kSeed;
  if (!recordTo.empty()) {
    auto recorder = Recorder::create(recordTo, *scene_, (*device)->info(), options, false);
    if (!recorder) return fail(recorder.error());
    recorder_ = std::move(*recorder);
    options.sink = recorder_.get();
  }
  auto runner = Runner::create(scene_, std::move(*device), options);
  if (!runner) {
    recorder_.reset();
    return fail(runner.error());
  }
  runner_ = std::move(*runner);
  DesktopSignals::guard(runner_.get());
  clock_ = clock;
  condition_ = {};
  lookedAt_ = triedAt_ = {};
  armed_ = false;
  restSnapshot();
  if (clock == Clock::Real) {
    if (auto started = runner_->start(); !started) {
      DesktopSignals::guard(nullptr);
      runner_.reset();
      recorder_.reset();
      return fail(started.error());
    }
  }
  return {};
}

void DesktopSimulation::advanceVirtual(double seconds) {
  if (runner_ && clock_ == Clock::Virtual) (void)runner_->runVirtual(seconds, {});
}

Result<void> DesktopSimulation::stop() {
  if (!runner_) return {};
  (void)refresh();
  if (reconnect_.valid()) reconnect_.wait();
  runner_->forceOff();
  runner_->stop();
  const RunReport report = runner_->report();
  DesktopSignals::guard(nullptr);
  runner_.reset();
  mouseHand_.reset();
  armed_ = false;
  last_.felt = Wrench{};  // Nothing is felt any more.
  if (!recorder_) return {};
  const auto recorder = std::move(recorder_);
  return recorder->finish(report);
}

std::optional<RunReport> DesktopSimulation::report() const {
  if (!runner_) return std::nullopt;
  return runner_->report();
}

void DesktopSimulation::arm(bool on) {
  armed_ = on && runner_ != nullptr;
  if (runner_) runner_->setEnabled(on);
}

void DesktopSimulation::forceOff() {
  if (runner_) runner_->forceOff();
  arm(false);
}

void DesktopSimulation::clearFault() {
  if (runner_) runner_->clearFault();
}

void DesktopSimulation::confirmCalibration() {
  if (runner_) runner_->device().confirm();
}

bool DesktopSimulation::reconnecting() const {
  return reconnect_.valid() &&
         reconnect_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
}

void DesktopSimulation::reconnect() {
  if (!runner_ || reconnecting()) return;
  triedAt_ = std::chrono::steady_clock::now();
  reconnect_ =
      std::async(std::launch::async, [&device = runner_->device()] { return device.reconnect(); });
}

/// A few times a second; while the device is gone it is looked for again by itself.
void DesktopSimulation::lookAtDevice() {
  const auto now = std::chrono::steady_clock::now();
  if (now - lookedAt_ < kLookPeriod) return;
  lookedAt_ = now;
  condition_ = runner_->device().condition();
  const bool gone = condition_.state == DeviceCondition::State::Gone && condition_.canReconnect;
  if (gone && now - triedAt_ > kRetryPeriod) reconnect();
}

bool DesktopSimulation::send(const Command& command) {
  return runner_ == nullptr || runner_->send(command);
}

void DesktopSimulation::moveHand(const Eigen::Vector3d& delta_W) {
  if (!mouseHand_ || !scene_) return;
  Eigen::Vector3d p = position(target_.pose_D) + scene_->X_WD.linear().transpose() * delta_W;
  const DeviceInfo& device = info();
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    // The arm's reach; the resting pose counts as within it.
    p[axis] = std::clamp(p[axis], std::min(device.workspaceMin[a], -kStartHeight_m),
                         std::max(device.workspaceMax[a], kStartHeight_m));
  }
  target_.pose_D = plain(p, orientation(target_.pose_D));
  mouseHand_->follow(target_);
}

void DesktopSimulation::turnHand(const Eigen::Vector3d& rotation_W) {
  if (!mouseHand_ || !scene_) return;
  const Eigen::Vector3d inD = scene_->X_WD.linear().transpose() * rotation_W;
  target_.pose_D =
      plain(position(target_.pose_D), (expMap(inD) * orientation(target_.pose_D)).normalized());
  mouseHand_->follow(target_);
}

const Snapshot* DesktopSimulation::refresh() {
  if (runner_ && runner_->snapshots().refresh()) last_ = runner_->snapshots().value();
  if (runner_) lookAtDevice();
  return scene_ ? &last_ : nullptr;
}

void DesktopSimulation::describe(ui::Model& model) const {
  ui::SimulateModel& simulate = model.simulate;
  simulate.ready = scene_ != nullptr;
  simulate.running = running();
  simulate.recording = recording();
  simulate.recordedSeconds = recording() ? last_.t : 0.0;
  simulate.armed = armed_;
  simulate.hand = handKind_;
  simulate.condition = condition_;
  simulate.reconnecting = reconnecting();
  simulate.loose = scene_ ? static_cast<int>(scene_->bodies.size()) : 0;
  if (scene_) {
    simulate.setting = scene_->scene.setting;
    const TreeStats& stats = scene_->tree->stats();
    simulate.tree = counted(static_cast<std::size_t>(stats.levels), "level", "levels") + ", " +
                    ui::grouped(stats.surfaceVoxels) + " voxels";
    char text[64];
    const double spacing = scene_->scene.setting.shellSpacing > 0.0
                               ? scene_->scene.setting.shellSpacing
                               : scene_->instrument.shellSpacing;
    std::snprintf(text, sizeof text, ", %.2f mm", millimetres(spacing));
    simulate.shell = ui::grouped(scene_->shell->size()) + " points" + text;
  }
  model.health = ui::DeviceHealth::Good;
  model.healthSentence = "All is well.";
  if (!running()) {
    model.healthSentence = "The simulation is stopped.";
    return;
  }
  if (last_.fault != SafetyFault::None) {
    model.health = ui::DeviceHealth::Fault;
    model.healthSentence = palpate::describe(last_.fault);
  } else if (condition_.state == DeviceCondition::State::Problem ||
             condition_.state == DeviceCondition::State::Gone) {
    model.health = ui::DeviceHealth::Fault;
    model.healthSentence = condition_.sentence;
  } else if (condition_.state == DeviceCondition::State::Calibrating) {
    model.health = ui::DeviceHealth::Late;
    model.healthSentence = condition_.sentence;
  } else if (last_.ticksMissed > 0 && last_.tick > 0 &&
             static_cast<double>(last_.ticksMissed) > 0.01 * static_cast<double>(last_.tick)) {
    model.health = ui::DeviceHealth::Late;
    model.healthSentence = "This machine misses servo periods: what is felt may be rough.";
  }
  const RunReport report = runner_->report();
  simulate.realTime = report.realTimePriority;
  simulate.realTimeNote = report.realTimeNote;
}

ui::InstrumentRow describeInstrument(const Instrument& instrument) {
  ui::InstrumentRow row;
  row.name = instrument.name;
  row.title = instrument.title;
  row.description = instrument.description;
  row.mass_g = instrument.massProperties.mass * 1000.0;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9);
  Eigen::Vector3d high = -low;
  for (const auto& v : instrument.mesh_T.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  row.length_mm = millimetres(high.z() - low.z());
  row.width_mm = 0.0;
  // The widest of each slab along the shaft, seen from the side.
  constexpr std::size_t kSlabs = 60;
  std::array<double, kSlabs + 1> radius{};
  for (const auto& v : instrument.mesh_T.vertices) {
    const double f = (v.z() - low.z()) / std::max(1e-9, high.z() - low.z());
    const auto slab = static_cast<std::size_t>(f * kSlabs);
    const double r = millimetres(std::hypot(v.x(), v.y()));
    radius[slab] = std::max(radius[slab], r);
    if (millimetres(v.z()) < 10.0) row.width_mm = std::max(row.width_mm, 2.0 * r);
  }
  for (std::size_t i = 0; i <= kSlabs; ++i) {
    if (radius[i] <= 0.0 && i != 0 && i != kSlabs) continue;
    row.outline.push_back({static_cast<float>(row.length_mm * static_cast<double>(i) / kSlabs),
                           static_cast<float>(radius[i])});
  }
  return row;
}

}  // namespace palpate
