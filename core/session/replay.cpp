#include "core/session/replay.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/session/session_file.h"
#include "core/session/session_rows.h"
#include "core/simulation/simulation.h"

namespace palpate {
namespace {

std::uint64_t wholeNumber(const std::string& text, int base) {
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

double distance(const double (&a)[3], const double (&b)[3]) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

Error samplesMissing(const std::filesystem::path& file, std::uint64_t tick) {
  return checkFailed("The recording is inexact: samples were dropped, so it cannot be replayed.")
      .inFile(file.string())
      .inField("samples")
      .butFound("no sample " + std::to_string(tick))
      .advise("Record again with less load on the machine.");
}

/// The three streams of a session, walked together in the order in which they happened.
class Tape {
 public:
  static Result<Tape> open(const std::filesystem::path& file) {
    auto database = openSession(file);
    if (!database) return fail(database.error());
    if (auto whole = checkWhole(*database, file); !whole) return fail(whole.error());
    Tape tape(std::move(*database), file);
    const bool ready =
        tape.database_.prepare("SELECT data FROM steps ORDER BY step", tape.steps_) == SQLITE_OK &&
        tape.database_.prepare("SELECT tick, data FROM samples ORDER BY tick", tape.samples_) ==
            SQLITE_OK &&
        tape.database_.prepare("SELECT step, kind, value FROM commands ORDER BY number",
                               tape.commands_) == SQLITE_OK;
    if (!ready) return fail(damaged(file.string(), "tables"));
    tape.commandWaits_ = tape.commands_.step() == SQLITE_ROW;
    return tape;
  }

  /// The next step, or nothing at the end.
  Result<std::optional<StepRecord>> nextStep() {
    const int code = steps_.step();
    if (code == SQLITE_DONE) return std::optional<StepRecord>();
    auto step = code == SQLITE_ROW ? unpackStep(steps_.bytes(0)) : std::nullopt;
    if (!step) return fail(damaged(file_.string(), "steps"));
    return step;
  }
  /// The sample of that number; nothing where there is none. Numbers must not fall.
  Result<std::optional<ServoSample>> sample(std::uint64_t tick) {
    while (!sample_ || sample_->device.index < tick) {
      const int code = samples_.step();
      if (code == SQLITE_DONE) return std::optional<ServoSample>();
      sample_ = code == SQLITE_ROW ? unpackSample(samples_.bytes(1)) : std::nullopt;
      if (!sample_) return fail(damaged(file_.string(), "samples"));
    }
    if (sample_->device.index != tick) return std::optional<ServoSample>();
    return sample_;
  }
  /// Applies what was told before this step.
  void applyCommands(std::uint64_t step, Simulation& simulation,
                     std::vector<RecordedLevel>& levels) {
    while (commandWaits_ && static_cast<std::uint64_t>(commands_.integer(0)) <= step) {
      Command command;
      command.kind = static_cast<Command::Kind>(commands_.integer(1));
      command.value = commands_.number(2);
      simulation.apply(command);
      if (command.kind == Command::Kind::SetLevel && command.value >= 0.0 &&
          command.value < static_cast<double>(kMostLevels)) {
        levels.push_back({step, static_cast<std::size_t>(command.value)});
      }
      commandWaits_ = commands_.step() == SQLITE_ROW;
    }
  }
  [[nodiscard]] Database& database() { return database_; }

 private:
  Tape(Database database, std::filesystem::path file)
      : database_(std::move(database)), file_(std::move(file)) {}
  Database database_;  // declared first: statements go before it
  std::filesystem::path file_;
  Statement steps_, samples_, commands_;
  std::optional<ServoSample> sample_;
  bool commandWaits_ = false;
};

void show(Simulation& simulation, const ServoSample& sample, Snapshot& snapshot) {
  simulation.fill(snapshot);
  snapshot.felt = sample.wrench;
  snapshot.safety = sample.state;
  snapshot.fault = sample.fault;
}

void compare(const StepRecord& recorded, const StepRecord& played, ReplayReport& report) {
  ++report.steps;
  if (played.stateHash != recorded.stateHash && !report.firstDifference) {
    report.firstDifference = {recorded.step, recorded.stateHash, played.stateHash};
  }
  report.forceErrorMax =
      std::max(report.forceErrorMax, distance(played.contact.force, recorded.contact.force));
  report.depthErrorMax = std::max(report.depthErrorMax, std::abs(played.depth - recorded.depth));
}

}  // namespace

Result<std::shared_ptr<const PreparedScene>> prepareSession(const std::filesystem::path& file,
                                                            const Progress& progress) {
  auto database = openSession(file);
  if (!database) return fail(database.error());
  const auto parts = readParts(*database, file);
  if (!parts) return fail(parts.error());
  auto scene = prepareParts(*parts, file.string(), progress);
  if (!scene) return scene;
  if ((*scene)->fingerprint != wholeNumber(readMeta(*database, "fingerprint"), 16)) {
    return fail(damaged(file.string(), "fingerprint"));
  }
  return scene;
}

Result<SessionHeader> readSessionHeader(const std::filesystem::path& file) {
  auto database = openSession(file);
  if (!database) return fail(database.error());
  const auto parts = readParts(*database, file);
  if (!parts) return fail(parts.error());
  auto scene = sceneOf(*parts, file.string());
  if (!scene) return fail(scene.error());
  SessionHeader header;
  header.scene = std::move(*scene);
  header.deviceName = readMeta(*database, "device");
  header.programVersion = readMeta(*database, "program_version");
  header.seed = wholeNumber(readMeta(*database, "seed"), 10);
  header.sceneFingerprint = wholeNumber(readMeta(*database, "fingerprint"), 16);
  header.exact = readMeta(*database, "exact") == "1";
  header.finished = readMeta(*database, "finished") == "1";
  header.steps =
      static_cast<std::uint64_t>(database->integer("SELECT count(*) FROM steps").value_or(0));
  header.ticks =
      static_cast<std::uint64_t>(database->integer("SELECT count(*) FROM samples").value_or(0));
  if (const auto report = parts->find("report"); report != parts->end()) {
    const auto unpacked = unpackReport(report->second);
    if (!unpacked) return fail(damaged(file.string(), "report"));
    header.report = *unpacked;
  } else if (header.finished) {
    return fail(damaged(file.string(), "report"));
  }
  return header;
}

Result<ReplayReport> replaySession(const std::filesystem::path& file,
                                   std::shared_ptr<const PreparedScene> scene,
                                   const Progress& progress,
                                   const std::function<void(const Snapshot&)>& onSnapshot) {
  const auto header = readSessionHeader(file);
  if (!header) return fail(header.error());
  if (scene->scene.setting.stepPeriod != header->scene.setting.stepPeriod) {
    return fail(usageError("A session can only be replayed at the step period it was recorded at.")
                    .inFile(file.string())
                    .inField("step_period_ms")
                    .butFound(std::to_string(scene->scene.setting.stepPeriod * 1e3))
                    .wants(std::to_string(header->scene.setting.stepPeriod * 1e3)));
  }
  auto tape = Tape::open(file);
  if (!tape) return fail(tape.error());
  const auto parts = readParts(tape->database(), file);
  if (!parts) return fail(parts.error());
  const auto gainBytes = parts->find("gains");
  const auto gains = gainBytes == parts->end() ? std::nullopt : unpackGains(gainBytes->second);
  if (!gains) return fail(damaged(file.string(), "gains"));

  Simulation simulation(std::move(scene), *gains);
  const auto snapshot = onSnapshot ? std::make_unique<Snapshot>() : nullptr;
  ReplayReport report;
  while (true) {
    const auto recorded = tape->nextStep();
    if (!recorded) return fail(recorded.error());
    if (!recorded->has_value()) break;
    const auto sample = tape->sample((*recorded)->deviceSample);
    if (!sample) return fail(sample.error());
    if (!sample->has_value()) {
      if (!header->finished) break;  // cut off between a sample and its step
      return fail(samplesMissing(file, (*recorded)->deviceSample));
    }
    tape->applyCommands((*recorded)->step, simulation, report.levels);
    compare(**recorded, simulation.step((*sample)->device), report);
    if (snapshot) {
      show(simulation, **sample, *snapshot);
      onSnapshot(*snapshot);
    }
    if (report.steps % 256 == 0) {
      if (progress.cancelled()) return fail(cancelled());
      progress(static_cast<double>(report.steps) / static_cast<double>(header->steps), "Replaying");
    }
  }
  report.identical = !report.firstDifference && header->exact;
  return report;
}

Result<std::vector<ServoSample>> readSamples(const std::filesystem::path& file) {
  auto database = openSession(file);
  if (!database) return fail(database.error());
  Statement rows;
  if (database->prepare("SELECT data FROM samples ORDER BY tick", rows) != SQLITE_OK) {
    return fail(damaged(file.string(), "samples"));
  }
  std::vector<ServoSample> samples;
  int code = SQLITE_ROW;
  while ((code = rows.step()) == SQLITE_ROW) {
    const auto sample = unpackSample(rows.bytes(0));
    if (!sample) return fail(damaged(file.string(), "samples"));
    samples.push_back(*sample);
  }
  if (code != SQLITE_DONE) return fail(damaged(file.string(), "samples"));
  return samples;
}

Result<std::vector<StepRecord>> readSteps(const std::filesystem::path& file, std::uint64_t stride) {
  if (stride == 0) return fail(usageError("Every how many steps must be at least one."));
  auto database = openSession(file);
  if (!database) return fail(database.error());
  Statement rows;
  if (database->prepare("SELECT data FROM steps WHERE step % ? = 0 ORDER BY step", rows) !=
      SQLITE_OK) {
    return fail(damaged(file.string(), "steps"));
  }
  rows.bind(1, static_cast<std::int64_t>(std::min<std::uint64_t>(stride, 1ULL << 62U)));
  std::vector<StepRecord> steps;
  int code = SQLITE_ROW;
  while ((code = rows.step()) == SQLITE_ROW) {
    const auto step = unpackStep(rows.bytes(0));
    if (!step) return fail(damaged(file.string(), "steps"));
    steps.push_back(*step);
  }
  if (code != SQLITE_DONE) return fail(damaged(file.string(), "steps"));
  return steps;
}

}  // namespace palpate
