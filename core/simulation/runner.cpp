#include "core/simulation/runner.h"

#include <semaphore.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <thread>

#include "core/simulation/bounded_queue.h"
#include "core/simulation/level_log.h"
#include "core/simulation/loop_stats.h"
#include "core/simulation/real_time.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

constexpr double kServoPeriod = 1e-3;
constexpr std::int64_t kServoPeriod_ns = 1000000;
constexpr std::uint64_t kTicksPerSecond = 1000;
// 125 pictures a second at most: more than any screen here shows, an eighth of the copying.
constexpr std::uint64_t kSnapshotTicks = 8;
constexpr std::size_t kCommandCapacity = 256;
// Ticks of zero wrench at the end: a device keeps the last force it was sent (haptics_facts.md §1).
constexpr int kZeroTicks = 5;
// Below the kernel's own threads, above the audio of a desktop; the servo before the simulation.
constexpr int kServoPriority = 80, kStepPriority = 70;

ServoSettings servoSettings(const PreparedScene& scene, const DeviceInfo& info,
                            std::uint32_t stepTicks) {
  ServoSettings settings;
  settings.period = kServoPeriod;
  settings.X_WD = scene.X_WD;
  settings.gains = recommendedGains(info, scene.scene.setting.stepPeriod);
  settings.limits = recommendedLimits(info, kServoPeriod);
  settings.declaredStepTicks = stepTicks;
  return settings;
}

class LoopRunner final : public Runner {
 public:
  LoopRunner(std::shared_ptr<const PreparedScene> scene, std::unique_ptr<HapticDevice> device,
             const RunOptions& options)
      : scene_(std::move(scene)),
        device_(std::move(device)),
        options_(options),
        simulation_(scene_, recommendedGains(device_->info(), scene_->scene.setting.stepPeriod)),
        servo_(*device_, servoSettings(*scene_, device_->info(), simulation_.stepTicks())),
        commands_(kCommandCapacity) {
    planLevels();
    ::sem_init(&ticked_, 0, 0);
    if (options_.latchEnabled) servo_.setEnabled(true);
  }
  LoopRunner(const LoopRunner&) = delete;
  LoopRunner& operator=(const LoopRunner&) = delete;
  ~LoopRunner() override {
    stop();
    zeroDevice(kZeroTicks);
    device_->close();
    ::sem_destroy(&ticked_);
  }

  Result<void> runVirtual(double seconds, const Progress& progress) override;
  Result<void> start() override;
  void stop() noexcept override;
  [[nodiscard]] RunReport report() const override;

  LatestValue<Snapshot>& snapshots() noexcept override { return snapshots_; }
  bool send(const Command& command) noexcept override { return commands_.tryPush(command); }
  void setEnabled(bool enabled) noexcept override {
    servo_.setEnabled(enabled || options_.latchEnabled);
  }
  void forceOff() noexcept override { servo_.forceOff(); }
  void clearFault() noexcept override { servo_.clearFault(); }
  [[nodiscard]] HapticDevice& device() noexcept override { return *device_; }
  [[nodiscard]] const PreparedScene& scene() const noexcept override { return *scene_; }

 private:
  void tickOnce() noexcept;  ///< servo thread
  void stepOnce() noexcept;  ///< simulation thread
  void planLevels();
  void obey(const Command& command) noexcept;
  void watchLevel(const StepRecord& record) noexcept;
  [[nodiscard]] bool tellSink(const StepRecord& record) noexcept;
  void publishSnapshot() noexcept;
  void servoThread() noexcept;
  void stepThread() noexcept;
  void dueTick(std::int64_t& due) noexcept;  ///< Books the lateness, ticks, wakes the simulation.
  static void vendorTick(void* owner) noexcept;
  [[nodiscard]] Result<void> startServo();
  void zeroDevice(int ticks) noexcept;

  std::shared_ptr<const PreparedScene> scene_;
  std::unique_ptr<HapticDevice> device_;
  RunOptions options_;
  Simulation simulation_;
  ServoLoop servo_;
  BoundedQueue<Command> commands_;
  LatestValue<Snapshot> snapshots_;
  LatestValue<ServoSample> servoSamples_;   ///< servo -> simulation: what the snapshot shows of it
  LatestValue<ServoFigures> servoForStep_;  ///< servo -> simulation, once a second
  mutable LatestValue<ServoFigures> servoForReport_;
  mutable LatestValue<StepFigures> stepForReport_;
  mutable std::mutex reportMutex_;  ///< Between callers of report(); the loops never take it.
  ServoStats servoStats_;
  StepStats stepStats_;
  std::optional<Governor> governor_;  ///< Simulation thread.
  std::optional<LevelLog> levelLog_;  ///< Where the scene has levels.
  mutable LatestValue<LevelFigures> levelsForReport_;
  sem_t ticked_{};  ///< Posted after each tick of the real clock.
  std::atomic<bool> stopping_{false};
  std::thread servoThread_, stepThread_;
  std::atomic<bool> running_{false};  ///< The two threads of the real clock.
  std::int64_t vendorDue_ = 0;        ///< Vendor's servo thread.
  int servoCpu_ = -1;
  bool realTime_ = false;
  std::string realTimeNote_;
};

void LoopRunner::tickOnce() noexcept {
  const std::int64_t start = monotonicNow();
  const ServoSample sample = servo_.tick();
  servoStats_.tick(sample, monotonicNow() - start);
  servoSamples_.publish(sample);
  if (options_.sink != nullptr && !options_.sink->onTick(sample)) servoStats_.dropped();
  if (servoStats_.windowEnded(kTicksPerSecond)) {
    const ServoFigures figures = servoStats_.figures();
    servoForStep_.publish(figures);
    servoForReport_.publish(figures);
  }
}

bool LoopRunner::tellSink(const StepRecord& record) noexcept {
  const bool taken = options_.sink->onStep(record);
  if (simulation_.bodies().empty()) return taken;
  return options_.sink->onBodies(record.step, simulation_.bodies()) && taken;
}

bool isSet(const ModelledTime& time) noexcept {
  return time.step_us > 0 || time.test_us > 0 || time.contact_us > 0 || time.impulse_us > 0;
}

/// What a step takes at the declared pace. One that lasted longer, since those before it were late,
/// was done in more parts than it would have been: that is no load to step down for.
double timeAtPace(const StepRecord& record, double period, const ModelledTime& modelled) noexcept {
  const double took = isSet(modelled) ? modelled.step_us + modelled.test_us * record.tests +
                                            modelled.contact_us * record.contacts +
                                            modelled.impulse_us * record.impulses
                                      : record.micros;
  if (record.parts == 1) return took;
  return took / record.parts * std::ceil(record.parts * std::min(1.0, period / record.h));
}

void LoopRunner::planLevels() {
  if (scene_->levels.empty()) return;
  if (options_.governed && (options_.clock == Clock::Real || isSet(options_.modelledTime))) {
    governor_.emplace(scene_->levels, scene_->scene.setting.stepPeriod, options_.governor);
  }
  levelLog_.emplace(scene_->levels.size(), governor_ ? governor_->budget_us() : 0.0);
}

void LoopRunner::obey(const Command& command) noexcept {
  const std::size_t before = simulation_.level();
  simulation_.apply(command);
  const std::uint64_t step = simulation_.record().step + 1;
  if (options_.sink != nullptr && !options_.sink->onCommand(step, command)) stepStats_.dropped();
  if (simulation_.level() == before) return;
  if (governor_ && governor_->level() != simulation_.level()) {
    governor_->moveTo(simulation_.level());
  }
  levelLog_->changed(step, servo_.deviceSamples().value().index, simulation_.level());
}

void LoopRunner::watchLevel(const StepRecord& record) noexcept {
  const double took = timeAtPace(record, scene_->scene.setting.stepPeriod, options_.modelledTime);
  levelLog_->step(record, took);
  if (governor_) (void)governor_->after(took, record.h);
}

void LoopRunner::stepOnce() noexcept {
  Command command;
  while (commands_.tryPop(command)) obey(command);
  if (governor_ && governor_->level() != simulation_.level()) {
    obey({Command::Kind::SetLevel, static_cast<double>(governor_->level())});
  }
  const StepRecord& record = simulation_.step(servo_.deviceSamples().value());
  servo_.publishTool(simulation_.tool());
  stepStats_.step(record);
  if (levelLog_) watchLevel(record);
  if (options_.sink != nullptr && !tellSink(record)) stepStats_.dropped();
  if (stepStats_.windowEnded(kTicksPerSecond / simulation_.stepTicks())) {
    stepForReport_.publish(stepStats_.figures());
    if (levelLog_) levelsForReport_.publish(levelLog_->figures());
  }
  const std::uint64_t every = std::max<std::uint64_t>(1, kSnapshotTicks / simulation_.stepTicks());
  if (record.step % every == 0) publishSnapshot();
}

void LoopRunner::publishSnapshot() noexcept {
  servoSamples_.refresh();
  servoForStep_.refresh();
  const ServoSample& servo = servoSamples_.value();
  const ServoFigures& figures = servoForStep_.value();
  Snapshot& snapshot = snapshots_.slotToFill();
  simulation_.fill(snapshot);
  snapshot.felt = servo.wrench;
  snapshot.safety = servo.state;
  snapshot.fault = servo.fault;
  snapshot.stepTime = stepStats_.lastSecond();
  snapshot.tickTime = figures.lastSecond;
  snapshot.ticksLate = figures.late;
  snapshot.ticksMissed = figures.missed;
  snapshots_.publishFilled();
}

Result<void> LoopRunner::runVirtual(double seconds, const Progress& progress) {
  if (options_.clock != Clock::Virtual) {
    return fail(usageError("The run was made for the real clock: start() it."));
  }
  if (device_->ownsClock()) {
    return fail(usageError("This device keeps its own time: run it in the real clock.")
                    .butFound(device_->info().name));
  }
  if (!std::isfinite(seconds) || seconds < 0.0) {
    return fail(usageError("A run lasts zero or more seconds."));
  }
  const auto ticks = static_cast<std::uint64_t>(std::llround(seconds / kServoPeriod));
  const std::string what = "Simulating";
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    if (tick % (kTicksPerSecond / 4) == 0) {
      if (progress.cancelled()) return fail(cancelled());
      progress(static_cast<double>(tick) / static_cast<double>(ticks), what);
    }
    tickOnce();
    // Every stepTicks-th sample makes a step, counted over all runs of this runner.
    servo_.deviceSamples().refresh();
    if (servo_.deviceSamples().value().index % simulation_.stepTicks() == 0) stepOnce();
  }
  progress(1.0, what);
  return {};
}

void LoopRunner::dueTick(std::int64_t& due) noexcept {
  const std::int64_t late = monotonicNow() - due;
  servoStats_.woke(late);
  if (late >= kServoPeriod_ns) {
    const std::int64_t skipped = late / kServoPeriod_ns;
    servoStats_.missed(static_cast<std::uint64_t>(skipped));
    due += skipped * kServoPeriod_ns;
  }
  tickOnce();
  ::sem_post(&ticked_);
  due += kServoPeriod_ns;
}

void LoopRunner::servoThread() noexcept {
  touchStack();
  std::int64_t due = monotonicNow() + kServoPeriod_ns;
  while (!stopping_.load(std::memory_order_acquire)) {
    sleepUntil(due);
    dueTick(due);
  }
}

// A vendor's scheduler keeps its own time: its first call sets the grid that lateness is told on,
// and a call before its time moves the grid, as two clocks drift.
void LoopRunner::vendorTick(void* owner) noexcept {
  auto& self = *static_cast<LoopRunner*>(owner);
  const std::int64_t now = monotonicNow();
  if (self.vendorDue_ == 0 || now < self.vendorDue_) self.vendorDue_ = now;
  self.dueTick(self.vendorDue_);
}

void LoopRunner::stepThread() noexcept {
  touchStack();
  std::uint64_t nextIndex = 0;
  while (true) {
    while (::sem_wait(&ticked_) != 0) {
    }
    if (stopping_.load(std::memory_order_acquire)) return;
    while (::sem_trywait(&ticked_) == 0) {  // after a slow step only the newest sample counts
    }
    servo_.deviceSamples().refresh();
    const std::uint64_t index = servo_.deviceSamples().value().index;
    if (index < nextIndex) continue;
    nextIndex = index + simulation_.stepTicks();
    stepOnce();
  }
}

Result<void> LoopRunner::start() {
  if (options_.clock != Clock::Real) {
    return fail(usageError("The run was made for the virtual clock: runVirtual() it."));
  }
  if (running_) return {};
  stopping_.store(false, std::memory_order_release);
  stepThread_ = std::thread([this] {
    LockedMemory own(this, sizeof(*this));
    LockedMemory contacts(simulation_.contactMemory().data(),
                          simulation_.contactMemory().size_bytes());
    stepThread();
  });
  running_ = true;
  nameThread(stepThread_.native_handle(), "palpate-step");
  realTimeNote_ = askForRealTime(stepThread_.native_handle(), kStepPriority);
  if (auto started = startServo(); !started) {
    stop();
    return started;
  }
  realTime_ = realTimeNote_.empty();
  return {};
}

Result<void> LoopRunner::startServo() {
  if (device_->ownsClock()) {
    vendorDue_ = 0;
    return device_->startServo(&LoopRunner::vendorTick, this);
  }
  servoThread_ = std::thread([this] { servoThread(); });
  nameThread(servoThread_.native_handle(), "palpate-servo");
  const int wanted = options_.servoCpu >= 0 ? options_.servoCpu : isolatedProcessor();
  if (bindToProcessor(servoThread_.native_handle(), wanted)) {
    servoCpu_ = wanted;
  } else if (options_.servoCpu >= 0) {
    return fail(machineError("The servo could not be bound to that processor.")
                    .inField("--servo-cpu")
                    .butFound(std::to_string(options_.servoCpu))
                    .wants("a processor of this machine that the program may use"));
  }
  const std::string note = askForRealTime(servoThread_.native_handle(), kServoPriority);
  if (!note.empty()) realTimeNote_ = note;
  return {};
}

void LoopRunner::stop() noexcept {
  if (!running_) return;
  stopping_.store(true, std::memory_order_release);
  if (device_->ownsClock()) device_->stopServo();
  if (servoThread_.joinable()) servoThread_.join();
  ::sem_post(&ticked_);
  if (stepThread_.joinable()) stepThread_.join();
  running_ = false;
  zeroDevice(1);
}

void LoopRunner::zeroDevice(int ticks) noexcept {
  if (device_->ownsClock()) return;  // its stopServo() has done it; write() is for its scheduler
  for (int tick = 0; tick < ticks; ++tick) device_->write(Wrench{});
}

RunReport LoopRunner::report() const {
  RunReport report;
  if (running_) {
    const std::lock_guard<std::mutex> lock(reportMutex_);
    servoForReport_.refresh();
    stepForReport_.refresh();
    levelsForReport_.refresh();
    report = reportOf(options_, servoForReport_.value(), stepForReport_.value());
    if (levelLog_) report.governor = reportOf(levelsForReport_.value());
  } else {
    report = reportOf(options_, servoStats_.figures(), stepStats_.figures());
    if (levelLog_) report.governor = reportOf(levelLog_->figures());
  }
  report.realTimePriority = realTime_;
  report.realTimeNote = realTimeNote_;
  report.servoCpu = servoCpu_;
  return report;
}

}  // namespace

Result<std::unique_ptr<Runner>> Runner::create(std::shared_ptr<const PreparedScene> scene,
                                               std::unique_ptr<HapticDevice> device,
                                               const RunOptions& options) {
  if (options.latchEnabled && !device->info().simulated) {
    return fail(usageError("Hold-to-enable may be a latch only on a simulated device.")
                    .butFound(device->info().name)
                    .advise("Hold the stylus' button to feel force."));
  }
  if (auto opened = device->open(); !opened) return fail(opened.error());
  return std::unique_ptr<Runner>(
      std::make_unique<LoopRunner>(std::move(scene), std::move(device), options));
}

}  // namespace palpate
