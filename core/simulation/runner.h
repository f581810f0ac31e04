#pragma once
/// The running thing: one prepared scene, one device, the servo and the simulation on a clock.
///
/// Virtual clock: one thread, one tick after the other, as fast as it goes; same seed, same bits.
/// Real clock: a servo thread at 1 kHz and a simulation thread. The desktop, the commands and the
/// tests all run this; none has a loop of its own.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/error.h"
#include "core/base/latest_value.h"
#include "core/base/progress.h"
#include "core/dynamics/loose_body.h"
#include "core/haptics/device.h"
#include "core/haptics/servo_loop.h"
#include "core/simulation/governor.h"
#include "core/simulation/histogram.h"
#include "core/simulation/prepared_scene.h"
#include "core/simulation/snapshot.h"

namespace palpate {

enum class Clock : std::uint8_t { Virtual, Real };

/// A change of level, the governor's or another's.
struct LevelChange {
  std::uint64_t step = 0, tick = 0;  ///< The first step at the new level, and its sample.
  std::uint32_t from = 0, to = 0;
  double step_us = 0.0;  ///< What the step before had taken.
};

/// How a run stepped on the scene's levels.
struct GovernorReport {
  bool governed = false;             ///< Else only commands change the level.
  double budget_us = 0.0;            ///< What a step may take; 0: not governed.
  std::uint64_t stepsOver = 0;       ///< That took longer.
  std::size_t level = 0;             ///< Last
  std::uint64_t changeCount = 0;     ///< All of them.
  std::vector<LevelChange> changes;  ///< The last kChangesKept of them.
  std::vector<double> secondsAt;     ///< Simulated, by level.
};
inline constexpr std::size_t kChangesKept = 64;

/// What a run measured; the fields of `simulate --json`.
struct RunReport {
  Clock clock = Clock::Virtual;
  std::uint64_t seed = 0, steps = 0, ticks = 0;
  Timing stepTime, tickTime, lateness;  ///< µs, over the whole run
  DurationBins stepBins, tickBins, latenessBins;
  std::uint64_t ticksLate = 0, ticksMissed = 0;
  std::uint32_t contactsMax = 0;
  double forceMax = 0, torqueMax = 0;  ///< N, N·m
  double penetrationMax = 0;           ///< m
  double handEnergy = 0;               ///< J, taken from the hand; at the end
  double handEnergyMin = 0;            ///< J, the lowest: below 0 the hand was given energy.
  std::uint64_t recorderDrops = 0;
  std::uint64_t stateHash = 0;  ///< Of every step's state, chained.
  bool realTimePriority = false;
  std::string realTimeNote;                ///< Why not, and how to allow it.
  int servoCpu = -1;                       ///< The processor that the servo was bound to; -1: none.
  std::optional<GovernorReport> governor;  ///< Where the scene has levels.
};

/// Applied between steps, in order (design: ui -> simulation).
struct Command {
  enum class Kind : std::uint8_t {
    ResetTool,            ///< To rest where the device is.
    SetSolverIterations,  ///< `value` impulses a step, 1 to 100000.
    SetFriction,          ///< `value` 0: off; else on.
    SetCoupling,          ///< `value` of the recommended stiffness, 0.1 to 1 (measured stable).
    SetLevel              ///< `value` of the scene's levels, 0 the finest; the governor's.
  } kind = Kind::ResetTool;
  double value = 0.0;
};
static_assert(std::is_trivially_copyable_v<Command>);

/// One simulation step as the recorder and the replay see it. World axes, SI.
struct StepRecord {
  std::uint64_t step = 0, deviceSample = 0;
  std::uint64_t stateHash = 0;     ///< Chained over all steps so far.
  std::uint64_t commandCount = 0;  ///< Commands applied so far.
  PlainPose tool;
  double v[3] = {0, 0, 0}, w[3] = {0, 0, 0};
  Wrench contact;
  std::uint32_t contacts = 0;
  double depth = 0.0;
  double micros = 0.0;  ///< Compute time; not part of the hash.

  // Neither in the hash nor in a session: they follow from the rest.
  double h = 1e-3;          ///< s, that the step lasted.
  double stiffness = 0.0;   ///< K_T in force, N/m.
  std::uint32_t parts = 1;  ///< That the step was done in.
  std::uint32_t contactsBetweenBodies = 0;
  std::uint32_t tests = 0;     ///< Sphere and leaf tests of all queries.
  std::uint32_t impulses = 0;  ///< Of the response.
  std::uint32_t level = 0;     ///< Of the scene's levels.
};
static_assert(std::is_trivially_copyable_v<StepRecord>);

/// Where samples, steps and commands go. Called on the loop threads: real-time safe, never blocks
/// in the real clock; returns false when it had to drop. A command is told before the step it acts
/// on.
class RunSink {
 public:
  virtual ~RunSink() = default;
  virtual bool onTick(const ServoSample& sample) noexcept = 0;  ///< servo thread
  virtual bool onStep(const StepRecord& step) noexcept = 0;     ///< simulation thread
  virtual bool onCommand(std::uint64_t step, const Command& command) noexcept = 0;  ///< simulation
  /// After onStep, where the scene has loose bodies. Simulation thread.
  virtual bool onBodies(std::uint64_t step, std::span<const LooseBody> bodies) noexcept {
    (void)step;
    (void)bodies;
    return true;
  }
};

/// Time of a step from counted work, the same on every machine. All zero: none.
struct ModelledTime {
  double step_us = 0, test_us = 0, contact_us = 0, impulse_us = 0;
};

struct RunOptions {
  Clock clock = Clock::Virtual;
  std::uint64_t seed = 1;
  /// The processor to bind the servo's thread to; -1: an isolated one where the system has any,
  /// else none. A vendor's own thread is not ours to bind.
  int servoCpu = -1;
  bool latchEnabled = false;  ///< Hold-to-enable is a latch. Simulated devices only.
  RunSink* sink = nullptr;    ///< Outlives the run.
  /// Where the scene has levels, the governor chooses among them: on the real clock by measured
  /// times, on the virtual clock only by modelled ones, so that equal inputs give equal bits.
  bool governed = true;
  GovernorSettings governor;
  ModelledTime modelledTime;  ///< In place of measured times; for tests.
};

class Runner {
 public:
  /// The scene and the device outlive the runner's threads; the device is opened here.
  [[nodiscard]] static Result<std::unique_ptr<Runner>> create(
      std::shared_ptr<const PreparedScene> scene, std::unique_ptr<HapticDevice> device,
      const RunOptions& options);
  virtual ~Runner() = default;  ///< Zero wrench, threads joined, device closed.

  /// Virtual clock: runs that many simulated seconds on the calling thread.
  virtual Result<void> runVirtual(double seconds, const Progress& progress) = 0;
  /// Real clock: starts and stops the two threads.
  virtual Result<void> start() = 0;
  virtual void stop() noexcept = 0;

  /// Real clock: any thread, at most a second old while it runs. Virtual: the thread that runs it.
  [[nodiscard]] virtual RunReport report() const = 0;
  /// Render thread only: refresh() and value().
  [[nodiscard]] virtual LatestValue<Snapshot>& snapshots() noexcept = 0;
  /// Any one thread. False: the queue is full, nothing was taken.
  [[nodiscard]] virtual bool send(const Command& command) noexcept = 0;
  /// Any thread: hold-to-enable input, force off, and the way back from a fault.
  virtual void setEnabled(bool enabled) noexcept = 0;
  virtual void forceOff() noexcept = 0;
  virtual void clearFault() noexcept = 0;
  [[nodiscard]] virtual HapticDevice& device() noexcept = 0;
  [[nodiscard]] virtual const PreparedScene& scene() const noexcept = 0;
};

}  // namespace palpate
