#include <chrono>
#include <memory>
#include <thread>

#include "app/command.h"
#include "app/commands.h"
#include "app/device_facts.h"
#include "app/program_paths.h"
#include "app/run_report.h"
#include "app/run_sinks.h"
#include "app/scene_loading.h"
#include "app/setting_report.h"
#include "app/text_table.h"
#include "app/trade_memo.h"
#include "core/base/whole_file.h"
#include "core/devices/device_list.h"
#include "core/devices/simulated_phantom.h"
#include "core/devices/space_mouse.h"
#include "core/geometry/units.h"
#include "core/session/recorder.h"
#include "core/session/replay.h"
#include "core/simulation/plan_cost.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kDefaultSeconds = 10.0;  // the built-in hand: approach, press, slide, retreat
constexpr double kTicksPerSecond = 1000.0;

struct SimulateOptions {
  fs::path caseOrScene;
  bool headless = false, explain = false, govern = false;
  std::string device, instrument, clock = "virtual";
  fs::path hand, record, samples, steps, bodies;
  double seconds = kDefaultSeconds;
  std::uint64_t seed = 1;
  int servoCpu = -1;
};

/// The hardware, moved by whoever holds it: only in real time, and by no hand of ours.
Result<std::unique_ptr<HapticDevice>> makePhantom(const SimulateOptions& options,
                                                  const std::string& name) {
  if (options.clock != "real" || !options.hand.empty()) {
    return fail(usageError("A Phantom runs on the real clock, in a person's hand.")
                    .inField("--device")
                    .butFound(name)
                    .advise("Add --clock real and leave --hand out, or take a simulated device."));
  }
  Result<PhantomOptions> phantom = phantomOptions(name);
  if (!phantom) return fail(phantom.error());
  return std::make_unique<Phantom>(std::move(*phantom));
}

/// What somebody's hand did in a session, for a simulated one to do it again: in the frame of the
/// device as it stood there.
Result<std::unique_ptr<Hand>> recordedHand(const fs::path& session) {
  const auto header = readSessionHeader(session);
  if (!header) return fail(header.error());
  const auto samples = readSamples(session);
  if (!samples) return fail(samples.error());
  const Eigen::Isometry3d X_DW = header->scene.X_WD->inverse();  // a session always has it
  std::vector<RecordedPose> records;
  for (const ServoSample& sample : *samples) {
    const DeviceSample& d = sample.device;
    if ((d.status & (kDeviceLost | kDeviceNotReady | kDeviceInvalidSample)) != 0) continue;
    records.push_back({d.t, plain(X_DW * isometry(d.pose)), d.buttons});
  }
  return makeRecordedHand(std::move(records));
}

bool isCsv(const fs::path& file) {
  return file.extension() == ".csv" || !readSessionHeader(file);
}

Result<std::shared_ptr<Hand>> makeHand(const SimulateOptions& options) {
  if (options.hand.empty()) return std::shared_ptr<Hand>(makeSearchingHand(options.seed));
  Result<std::unique_ptr<Hand>> hand =
      isCsv(options.hand) ? readScriptedHand(options.hand) : recordedHand(options.hand);
  if (hand) return std::shared_ptr<Hand>(std::move(*hand));
  Error error = hand.error();
  if (!error.advice) error.advise("Correct the file, or leave --hand out for the built-in hand.");
  return fail(error);
}

Result<std::unique_ptr<HapticDevice>> makeSpaceMouse(const SimulateOptions& options) {
  if (options.clock != "real" || !options.hand.empty()) {
    return fail(usageError("A 3D mouse is moved by a person, on the real clock.")
                    .inField("--device")
                    .butFound(kSpaceMouse)
                    .advise("Add --clock real and leave --hand out."));
  }
  auto hand = makeSpaceMouseHand();
  if (!hand) return fail(hand.error());
  return makeSimulatedPhantom("touch-x", std::move(*hand), options.seed);
}

Result<std::unique_ptr<HapticDevice>> makeDevice(const SimulateOptions& options,
                                                 const Scene& scene) {
  if (scene.device.rfind("phantom", 0) == 0) return makePhantom(options, scene.device);
  if (scene.device == kSpaceMouse) return makeSpaceMouse(options);
  auto hand = makeHand(options);
  if (!hand) return fail(hand.error());
  return makeSimulatedPhantom(scene.device, std::move(*hand), options.seed);
}

/// A recording that is taken away again unless it was finished: a cancelled run leaves nothing.
/// (After a crash FILE.part stays and can be replayed.)
class PendingRecording {
 public:
  PendingRecording() = default;
  PendingRecording(const PendingRecording&) = delete;
  PendingRecording& operator=(const PendingRecording&) = delete;
  ~PendingRecording() {
    if (!recorder_) return;
    recorder_.reset();
    std::error_code error;
    fs::remove(file_.string() + ".part", error);
  }

  /// A session may be recorded over, any other file is not touched.
  Result<void> start(const fs::path& file, const PreparedScene& scene, const DeviceInfo& device,
                     const RunOptions& options) {
    std::error_code error;
    const bool regular = fs::is_regular_file(file, error);
    if (fs::exists(file, error) && (!regular || !readSessionHeader(file))) {
      return fail(machineError("The recording would replace something that is no session.")
                      .inFile(file.string())
                      .wants("a new name, or a session")
                      .advise("Choose another name for --record."));
    }
    Result<std::unique_ptr<Recorder>> recorder =
        Recorder::create(file, scene, device, options, true);
    if (!recorder) return fail(recorder.error());
    file_ = file;
    recorder_ = std::move(*recorder);
    return {};
  }

  [[nodiscard]] Recorder* recorder() { return recorder_.get(); }

  Result<void> finish(const RunReport& report) {
    if (!recorder_) return {};
    const Result<void> finished = recorder_->finish(report);
    if (!finished) return fail(finished.error());
    recorder_.reset();
    return {};
  }

 private:
  fs::path file_;
  std::unique_ptr<Recorder> recorder_;
};

Result<void> runOnRealClock(Runner& runner, double seconds, const Progress& progress) {
  using Clock = std::chrono::steady_clock;
  if (const Result<void> started = runner.start(); !started) return fail(started.error());
  const auto start = Clock::now();
  double passed = 0.0;
  while (passed < seconds && !progress.cancelled()) {
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(0.05, seconds - passed)));
    passed = std::chrono::duration<double>(Clock::now() - start).count();
    progress(passed / seconds, "Simulating");
  }
  runner.stop();
  if (progress.cancelled()) return fail(cancelled());
  return {};
}

std::string timingText(const Timing& timing) {
  return decimal(timing.p50, 1) + " / " + decimal(timing.p99, 1) + " / " + decimal(timing.p999, 1) +
         " / " + decimal(timing.max, 1) + " µs";
}

std::string reportText(const RunReport& report) {
  TextTable table({"what", "value"});
  table.add({"clock, seed", std::string(report.clock == Clock::Virtual ? "virtual" : "real") +
                                ", " + std::to_string(report.seed)});
  table.add({"steps, ticks", std::to_string(report.steps) + ", " + std::to_string(report.ticks)});
  table.add({"step p50 / p99 / p99.9 / max", timingText(report.stepTime)});
  table.add({"tick p50 / p99 / p99.9 / max", timingText(report.tickTime)});
  if (report.clock == Clock::Real) {
    table.add({"late p50 / p99 / p99.9 / max", timingText(report.lateness)});
    if (report.servoCpu >= 0) table.add({"servo's processor", std::to_string(report.servoCpu)});
    table.add({"ticks late, missed",
               std::to_string(report.ticksLate) + ", " + std::to_string(report.ticksMissed)});
  }
  if (report.governor) {
    const GovernorReport& governor = *report.governor;
    std::string seconds;
    for (const double at : governor.secondsAt) {
      seconds += (seconds.empty() ? "" : ", ") + decimal(at, 2);
    }
    table.add({"governor", governor.governed
                               ? std::to_string(governor.changeCount) + " changes of level, " +
                                     std::to_string(governor.stepsOver) + " steps over " +
                                     decimal(governor.budget_us, 0) + " µs"
                               : "on the real clock only"});
    table.add({"seconds at each level", seconds});
  }
  table.add({"most contacts", std::to_string(report.contactsMax)});
  table.add({"greatest force", decimal(report.forceMax, 3) + " N"});
  table.add({"greatest torque", decimal(report.torqueMax * 1e3, 2) + " N·mm"});
  table.add({"deepest", decimal(millimetres(report.penetrationMax), 3) + " mm"});
  table.add({"energy taken from the hand", decimal(report.handEnergy * 1e3, 3) + " mJ"});
  table.add({"recorder drops", std::to_string(report.recorderDrops)});
  table.add({"state hash", hashText(report.stateHash)});
  return table.text();
}

void explainPlan(const std::vector<PlanRow>& plan, CommandOutput& output) {
  output.json["plan"] = ordered_json::array();
  TextTable table({"what", "modelled", "µs a step", "memory", "why"});
  for (const PlanRow& row : plan) {
    output.json["plan"].push_back({{"what", row.what},
                                   {"modelled", row.modelled},
                                   {"why", row.why},
                                   {"us", row.us ? ordered_json(*row.us) : ordered_json()},
                                   {"bytes", row.bytes}});
    table.add({row.what, row.modelled ? "yes" : "no", row.us ? decimal(*row.us, 2) : "",
               row.bytes > 0 ? byteSize(row.bytes) : "", row.why});
  }
  output.text = table.text() + "\n" + output.text;
}

/// Rows of a file that was asked for: `each` a tick.
std::size_t capacityOf(const fs::path& file, const SimulateOptions& options, std::size_t each = 1) {
  if (file.empty()) return 0;
  return each * static_cast<std::size_t>((options.seconds + 1.0) * kTicksPerSecond);
}

/// The CSV files of a run: taken down while it goes, written when it has ended.
struct RunTables {
  RunTables(const SimulateOptions& options, const PreparedScene& scene)
      : files{options.samples, options.steps, options.bodies},
        samples(capacityOf(options.samples, options)),
        steps(capacityOf(options.steps, options)),
        bodies(capacityOf(options.bodies, options, scene.bodies.size())) {}

  void addTo(TeeSink& tee) {
    if (!files[0].empty()) tee.add(samples);
    if (!files[1].empty()) tee.add(steps);
    if (!files[2].empty()) tee.add(bodies);
  }
  [[nodiscard]] Result<void> write() const {
    const std::string texts[] = {samples.csv(), steps.csv(), bodies.csv()};
    for (std::size_t i = 0; i < std::size(files); ++i) {
      if (files[i].empty()) continue;
      if (auto written = writeWholeFile(files[i], texts[i]); !written) return written;
    }
    return {};
  }
  [[nodiscard]] std::size_t dropped() const {
    return samples.dropped() + steps.dropped() + bodies.dropped();
  }

  fs::path files[3];
  SampleSink samples;
  StepSink steps;
  BodySink bodies;
};

std::vector<std::string> warningsOf(const RunReport& report, std::size_t rowsDropped) {
  std::vector<std::string> warnings;
  if (report.recorderDrops > 0) {
    warnings.push_back("The recorder dropped " + std::to_string(report.recorderDrops) +
                       " entries: the session is inexact from the first on.");
  }
  if (rowsDropped > 0) {
    warnings.push_back(std::to_string(rowsDropped) +
                       " rows found no room in --samples, --steps or --bodies.");
  }
  if (report.clock == Clock::Real && !report.realTimePriority && !report.realTimeNote.empty()) {
    warnings.push_back(report.realTimeNote);
  }
  return warnings;
}

/// Measured here and now at the scene's own setting, which stays in force while the time suffices.
Result<std::shared_ptr<const PreparedScene>> withGovernor(
    const std::shared_ptr<const PreparedScene>& scene, const Progress& progress) {
  const auto memo = measureTradeMemo(*scene, deviceFacts(scene->scene.device), progress);
  if (!memo) return fail(memo.error());
  return governed(scene, scene->scene.setting, *memo);
}

Result<CommandOutput> runSimulate(const SimulateOptions& options, const CommandContext& context) {
  for (const fs::path& file : {options.samples, options.steps, options.bodies, options.record}) {
    if (file.empty()) continue;
    if (const Result<void> writable = checkWritable(file); !writable) return fail(writable.error());
  }
  const Result<fs::path> datasets = datasetsFolder();
  if (!datasets) return fail(datasets.error());
  SceneOverrides overrides;
  if (!options.instrument.empty()) overrides.instrument = options.instrument;
  if (!options.device.empty()) overrides.device = options.device;
  auto scene = loadScene(options.caseOrScene, *datasets, overrides, context.progress);
  if (!scene) return fail(scene.error());
  if (options.govern) {
    auto ladder = withGovernor(*scene, context.progress);
    if (!ladder) return fail(ladder.error());
    scene = std::move(*ladder);
  }
  Result<std::unique_ptr<HapticDevice>> device = makeDevice(options, (*scene)->scene);
  if (!device) return fail(device.error());

  RunOptions run;
  run.clock = options.clock == "real" ? Clock::Real : Clock::Virtual;
  run.seed = options.seed;
  run.servoCpu = options.servoCpu;
  RunTables tables(options, **scene);
  PendingRecording recording;
  TeeSink tee;
  tables.addTo(tee);
  if (!options.record.empty()) {
    const Result<void> started = recording.start(options.record, **scene, (*device)->info(), run);
    if (!started) return fail(started.error());
    tee.add(*recording.recorder());
  }
  run.sink = tee.orNull();

  Result<std::unique_ptr<Runner>> runner = Runner::create(*scene, std::move(*device), run);
  if (!runner) return fail(runner.error());
  const Result<void> ran = run.clock == Clock::Real
                               ? runOnRealClock(**runner, options.seconds, context.progress)
                               : (*runner)->runVirtual(options.seconds, context.progress);
  if (!ran) return fail(ran.error());
  RunReport report = (*runner)->report();
  if (recording.recorder() != nullptr) report.recorderDrops = recording.recorder()->drops();
  runner->reset();

  if (const Result<void> written = tables.write(); !written) return fail(written.error());
  if (const Result<void> finished = recording.finish(report); !finished) {
    return fail(finished.error());
  }
  CommandOutput output;
  output.json = runReportJson(report, **scene);
  output.text = reportText(report);
  if (options.explain) {
    const auto plan = measuredPlan(*scene, WholeTree::Build, context.progress);
    if (!plan) return fail(plan.error());
    explainPlan(*plan, output);
  }
  output.warnings = warningsOf(report, tables.dropped());
  return output;
}

std::string modelList() {
  std::string list;
  for (const std::string& model : simulatedModels()) list += (list.empty() ? "" : ", ") + model;
  return list;
}

}  // namespace

void addSimulateCommand(CommandSet& commands) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* sub = commands.add(
      "simulate", "Runs the simulation of a case under a simulated Phantom",
      [options](const CommandContext& context) { return runSimulate(*options, context); });
  sub->add_option("CASE|SCENE", options->caseOrScene, "A case's folder, or a scene.toml in one")
      ->required();
  sub->add_flag("--headless", options->headless,
                "Without a window; this command opens none anyway ('palpate --case CASE' does)");
  sub->add_option("--device", options->device,
                  "Simulated: " + modelList() + "; 3d-mouse; or phantom[:NAME]");
  sub->add_option(
      "--hand", options->hand,
      "CSV of poses, or a session whose hand is repeated (default: the built-in searching hand)");
  sub->add_option("--instrument", options->instrument, "A name in datasets/instruments");
  sub->add_option("--seconds", options->seconds, "Simulated time")
      ->check(CLI::Range(0.001, 3600.0))
      ->capture_default_str();
  sub->add_option("--clock", options->clock, "virtual (as fast as it goes) or real")
      ->check(CLI::IsMember({"virtual", "real"}))
      ->capture_default_str();
  sub->add_option("--seed", options->seed, "Of the hand and the device")->capture_default_str();
  sub->add_option("--servo-cpu", options->servoCpu,
                  "Processor for the servo in real time (default: an isolated one, if any)")
      ->check(CLI::Range(0, 1023));
  sub->add_option("--record", options->record, "Session file to write");
  sub->add_option("--samples", options->samples, "CSV to write, one row a servo tick");
  sub->add_option("--steps", options->steps, "CSV to write, one row a simulation step");
  sub->add_option("--bodies", options->bodies, "CSV to write, one row a step and loose body");
  sub->add_flag("--govern", options->govern,
                "Steps down along the measured front when steps take too long (measures it first)");
  sub->add_flag("--explain", options->explain, "What is modelled, what is not, and why");
}

}  // namespace palpate
