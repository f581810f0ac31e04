#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "core/session/recorder.h"
#include "core/session/replay.h"
#include "core/session/session_scene.h"
#include "tests/core/scene/temporary_folder.h"
#include "tests/core/simulation/fragment_scene.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct Recorded {
  RunReport report;
  std::uint64_t drops = 0;
};

/// Records a run with the built-in hand; commands are sent half-way.
Recorded record(const fs::path& file, const std::shared_ptr<const PreparedScene>& scene,
                RunOptions options, double seconds) {
  const auto device = searchingDevice(options.seed);
  auto recorder = Recorder::create(file, *scene, device->info(), options, false);
  EXPECT_TRUE(recorder) << sentence(recorder.error());
  options.sink = recorder->get();
  auto runner = makeRunner(scene, options);
  for (int half = 0; half < 2; ++half) {
    if (options.clock == Clock::Virtual) {
      EXPECT_TRUE(runner->runVirtual(0.5 * seconds, {}));
    } else {
      EXPECT_TRUE(runner->start());
      std::this_thread::sleep_for(std::chrono::duration<double>(0.5 * seconds));
      runner->stop();
    }
    EXPECT_TRUE(runner->send({Command::Kind::SetSolverIterations, 60}));
    EXPECT_TRUE(runner->send({Command::Kind::ResetTool, 0}));
  }
  Recorded recorded{runner->report(), (*recorder)->drops()};
  const auto finished = (*recorder)->finish(recorded.report);
  EXPECT_TRUE(finished) << sentence(finished.error());
  return recorded;
}

Result<ReplayReport> replay(const fs::path& file) {
  auto scene = prepareSession(file);
  if (!scene) return fail(scene.error());
  return replaySession(file, *scene);
}

void sql(const fs::path& file, const std::string& text) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  char* message = nullptr;
  EXPECT_EQ(sqlite3_exec(database, text.c_str(), nullptr, nullptr, &message), SQLITE_OK)
      << (message != nullptr ? message : "");
  sqlite3_close(database);
}

std::string refusal(const fs::path& file) {
  const auto header = readSessionHeader(file);
  if (header) return "accepted";
  EXPECT_EQ(header.error().kind, ErrorKind::InputRefused);
  return header.error().message + "|" + header.error().field.value_or("") + "|" +
         header.error().found.value_or("");
}

#ifdef __SANITIZE_THREAD__
constexpr bool kCanFork = false;  // the sanitizer does not follow threads of a forked child
#else
constexpr bool kCanFork = true;
#endif

class Session : public testing::Test {
 protected:
  TemporaryFolder folder;
  fs::path file = folder / "run.palpate";
};

TEST_F(Session, VirtualRecordingReplaysToTheBit) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.seed = 5;
  const Recorded recorded = record(file, scene, options, 4.0);
  EXPECT_EQ(recorded.drops, 0U);
  EXPECT_GT(recorded.report.contactsMax, 0U);
  const auto report = replay(file);
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_TRUE(report->identical);
  EXPECT_EQ(report->steps, recorded.report.steps);
  EXPECT_FALSE(report->firstDifference);
  EXPECT_EQ(report->forceErrorMax, 0.0);
  EXPECT_EQ(report->depthErrorMax, 0.0);
  EXPECT_EQ(folder.files(), 1U);  // one file, nothing beside it
}

TEST_F(Session, LooseBodiesReplayToTheBit) {
  const auto grid = basin({{-3, -3, 0}, {-2, -4, 8}}, 6);
  const Eigen::Vector3d down = grid->geometry.X_PV.linear() * Eigen::Vector3d(0, 0, -9.81);
  auto materials = datasetMaterials();
  materials[0].with[0].friction = 0.61;  // not the program's own: the session brings its pairs
  Instrument instrument = datasetInstrument();
  instrument.material = "metal";
  const auto scene =
      prepareScene(sceneWithFragments(down), grid, tableOfTwo(), materials, instrument);
  ASSERT_TRUE(scene) << sentence(scene.error());
  const Recorded recorded = record(file, *scene, {}, 2.0);
  const auto again = prepareSession(file);
  ASSERT_TRUE(again) << sentence(again.error());
  EXPECT_EQ((*again)->bodies.size(), 2U);
  EXPECT_EQ((*again)->bodies[0].surface[kBone].friction, 0.61);
  EXPECT_EQ((*again)->instrument.material, "metal");
  EXPECT_EQ((*again)->fingerprint, (*scene)->fingerprint);
  std::uint32_t bodies = 0;
  const auto report =
      replaySession(file, *again, {}, [&](const Snapshot& s) { bodies = s.bodies; });
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_TRUE(report->identical);
  EXPECT_EQ(report->steps, recorded.report.steps);
  EXPECT_EQ(bodies, 2U);
}

TEST_F(Session, HeaderTellsWhatWasRecorded) {
  Scene asked;
  asked.name = "Mr Example, born 1950";
  asked.setting.shellSpacing = 0.61803398874989485e-3;
  asked.setting.solverIterations = 77;
  const auto scene = prepared(ball(), asked);
  RunOptions options;
  options.seed = 5;
  const Recorded recorded = record(file, scene, options, 0.5);
  const auto header = readSessionHeader(file);
  ASSERT_TRUE(header) << sentence(header.error());
  EXPECT_EQ(header->seed, 5U);
  EXPECT_EQ(header->steps, 500U);
  EXPECT_EQ(header->ticks, 500U);
  EXPECT_TRUE(header->exact);
  EXPECT_TRUE(header->finished);
  EXPECT_EQ(header->sceneFingerprint, scene->fingerprint);
  EXPECT_EQ(header->report.stateHash, recorded.report.stateHash);
  EXPECT_EQ(header->report.realTimeNote, recorded.report.realTimeNote);
  EXPECT_EQ(header->scene.setting.solverIterations, 77U);
  EXPECT_EQ(header->scene.setting.shellSpacing, asked.setting.shellSpacing);
  EXPECT_FALSE(header->deviceName.empty());
  EXPECT_FALSE(header->programVersion.empty());
  // A scene is often named after a patient: the name stays out of the session.
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  EXPECT_EQ(bytes.find("Example"), std::string::npos);
  EXPECT_EQ(bytes.find(folder.path().string()), std::string::npos);
}

TEST_F(Session, CarriesOnlyTheAnatomyThatIsFelt) {
  auto grid = ball();
  for (std::size_t i = 0; i < 5000; ++i) grid->labels[i] = 2;
  LabelTable table = boneTable();
  table.push_back({"secret", 2, {1, 2, 3}, "brain"});
  Scene asked;
  asked.labels = {"bone"};
  const auto scene = prepareScene(asked, grid, table, datasetMaterials(), datasetInstrument());
  ASSERT_TRUE(scene) << sentence(scene.error());
  record(file, *scene, {}, 0.2);
  const auto back = prepareSession(file);
  ASSERT_TRUE(back) << sentence(back.error());
  EXPECT_EQ((*back)->fingerprint, (*scene)->fingerprint);
  EXPECT_EQ((*back)->table.size(), 1U);
  for (std::size_t i = 0; i < grid->labels.size(); ++i) {
    ASSERT_EQ((*back)->labels->labels[i], grid->labels[i] == 1 ? 1 : 0);
  }
  EXPECT_TRUE((*back)->X_WD.matrix() == (*scene)->X_WD.matrix());
  const auto report = replay(file);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->identical);
}

TEST_F(Session, WhatIsLeftOutOfTheTreeIsLeftOutAgain) {
  // A ball with a cavity, cut in half by the region, under a device that reaches all of it.
  auto grid = ball();
  for (int k = 28; k < 36; ++k) {
    for (int j = 28; j < 36; ++j) {
      for (int i = 18; i < 26; ++i) grid->labels[grid->geometry.index(i, j, k)] = 0;
    }
  }
  const Eigen::Vector3d middle =
      1e3 * (grid->geometry.X_PV * grid->geometry.centre_V(31.5, 31.5, 31.5));
  Scene asked;
  asked.region =
      SceneBox{middle - Eigen::Vector3d(100, 100, 100), middle + Eigen::Vector3d(0.1, 100, 100)};
  asked.reach = Reach::Device;
  asked.workspace = SceneBox{{-0.1 / 3.0, -60, -60}, {80, 60, 60}};
  const auto scene = prepared(grid, asked);
  EXPECT_GT(scene->saving.outsideRegion, 0U);
  EXPECT_EQ(scene->saving.cavitiesFilled, 1U);
  const Recorded recorded = record(file, scene, {}, 2.0);
  EXPECT_GT(recorded.report.contactsMax, 0U);
  const auto again = prepareSession(file);
  ASSERT_TRUE(again) << sentence(again.error());
  EXPECT_EQ((*again)->fingerprint, scene->fingerprint);
  EXPECT_EQ((*again)->labels->labels, scene->labels->labels);
  EXPECT_EQ((*again)->saving.filledVoxels, scene->saving.filledVoxels);
  EXPECT_EQ((*again)->scene.workspace->least_mm, asked.workspace->least_mm);
  const auto report = replay(file);
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_TRUE(report->identical);
}

TEST_F(Session, OfFormatTwoLeavesNothingOut) {
  SessionParts parts = partsOf(*prepared(ball()));
  EXPECT_EQ(sceneOf(parts, "x")->reach, Reach::Sealed);
  std::string text(parts["scene"].begin(), parts["scene"].end());
  const std::size_t at = text.find("reach = ");
  ASSERT_NE(at, std::string::npos);
  text.erase(at, text.find('\n', at) + 1 - at);
  parts["scene"].assign(text.begin(), text.end());
  const auto scene = sceneOf(parts, "x");
  ASSERT_TRUE(scene) << sentence(scene.error());
  EXPECT_EQ(scene->reach, Reach::All);
}

TEST_F(Session, RealClockRecordingReplaysToTheBit) {
  const auto scene = prepared(ball());
  RunOptions options;
  options.clock = Clock::Real;
  const Recorded recorded = record(file, scene, options, 3.0);
  EXPECT_EQ(recorded.drops, 0U);
  EXPECT_GT(recorded.report.steps, 500U);
  const auto report = replay(file);
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_TRUE(report->identical);
  EXPECT_EQ(report->steps, recorded.report.steps);
}

TEST_F(Session, SamplesCanBeReadForAHandToRepeat) {
  record(file, prepared(ball()), {}, 0.5);
  const auto samples = readSamples(file);
  ASSERT_TRUE(samples) << sentence(samples.error());
  ASSERT_EQ(samples->size(), 500U);
  EXPECT_EQ((*samples)[499].device.index, 499U);
  EXPECT_TRUE(isRigid((*samples)[499].device.pose));
  EXPECT_FALSE(readSamples(folder / "nowhere.palpate"));
}

TEST_F(Session, StepsCanBeReadForScrubbing) {
  record(file, prepared(ball()), {}, 0.5);
  const auto steps = readSteps(file, 100);
  ASSERT_TRUE(steps) << sentence(steps.error());
  ASSERT_EQ(steps->size(), 5U);
  for (std::size_t i = 0; i < steps->size(); ++i) EXPECT_EQ((*steps)[i].step, 100 * (i + 1));
  EXPECT_EQ(readSteps(file, 0).error().kind, ErrorKind::Usage);
}

TEST_F(Session, ReplayShowsEverySnapshot) {
  const auto scene = prepared(ball());
  record(file, scene, {}, 0.3);
  std::uint64_t shown = 0;
  const auto report = replaySession(
      file, scene, {}, [&shown](const Snapshot& snapshot) { EXPECT_EQ(snapshot.step, ++shown); });
  ASSERT_TRUE(report);
  EXPECT_EQ(shown, 300U);
}

TEST_F(Session, OtherSettingsAreComparedNotRefused) {
  RunOptions options;
  options.seed = 5;
  record(file, prepared(ball()), options, 4.0);
  Scene coarse;
  coarse.setting.shellSpacing = 2e-3;
  const auto report = replaySession(file, prepared(ball(), coarse));
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_FALSE(report->identical);
  EXPECT_GT(report->forceErrorMax, 0.0);
  Scene slower;
  slower.setting.stepPeriod = 2e-3;
  EXPECT_EQ(replaySession(file, prepared(ball(), slower)).error().kind, ErrorKind::Usage);
}

TEST_F(Session, ATamperedSampleShowsAtTheStepThatUsedIt) {
  RunOptions options;
  record(file, prepared(ball()), options, 1.0);
  // One bit of the device's position in sample 700: byte 16 is the first of its pose.
  sql(file,
      "UPDATE samples SET data = CAST(substr(data, 1, 16) || x'01' || substr(data, 18) AS BLOB) "
      "WHERE tick = 700 AND substr(data, 17, 1) <> x'01'");
  const auto report = replay(file);
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_FALSE(report->identical);
  ASSERT_TRUE(report->firstDifference);
  EXPECT_EQ(report->firstDifference->step, 701U);
  EXPECT_NE(report->firstDifference->expectedHash, report->firstDifference->foundHash);
}

TEST_F(Session, ATamperedStepShowsAtThatStep) {
  record(file, prepared(ball()), {}, 1.0);
  sql(file,  // the state hash is bytes 16 to 23
      "UPDATE steps SET data = CAST(substr(data, 1, 16) || x'0102030405060708' || "
      "substr(data, 25) AS BLOB) WHERE step = 321");
  const auto report = replay(file);
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->firstDifference);
  EXPECT_EQ(report->firstDifference->step, 321U);
}

TEST_F(Session, AForgottenCommandShows) {
  record(file, prepared(ball()), {}, 1.0);
  sql(file, "DELETE FROM commands");
  const auto report = replay(file);
  ASSERT_TRUE(report);
  ASSERT_TRUE(report->firstDifference);
  EXPECT_EQ(report->firstDifference->step, 501U);
}

TEST_F(Session, ADroppedSampleIsToldNotGuessed) {
  record(file, prepared(ball()), {}, 1.0);
  sql(file,
      "DELETE FROM samples WHERE tick = 400; UPDATE meta SET value = '0' WHERE key = 'exact'");
  const auto report = replay(file);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::CheckFailed);
  EXPECT_EQ(report.error().message,
            "The recording is inexact: samples were dropped, so it cannot be replayed.");
  EXPECT_EQ(report.error().found, "no sample 400");
}

TEST_F(Session, EventsTellArmingAndContact) {
  RunOptions options;
  options.seed = 5;
  record(file, prepared(ball()), options, 4.0);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto count = [database](const char* kind) {
    sqlite3_stmt* statement = nullptr;
    sqlite3_prepare_v2(database, "SELECT count(*) FROM events WHERE kind = ?", -1, &statement,
                       nullptr);
    sqlite3_bind_text(statement, 1, kind, -1, SQLITE_STATIC);
    sqlite3_step(statement);
    const int rows = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return rows;
  };
  EXPECT_GE(count("armed"), 1);
  EXPECT_GE(count("contact-begin"), 1);
  EXPECT_GE(count("contact-begin"), count("contact-end"));
  EXPECT_EQ(count("fault"), 0);
  sqlite3_close(database);
}

TEST_F(Session, AKilledRecordingLosesAtMostTheLastSecondAndReplays) {
  if (!kCanFork) GTEST_SKIP() << "Forks, which the thread sanitizer does not follow.";
  const auto scene = prepared(ball());
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    RunOptions options;
    options.clock = Clock::Real;
    const auto device = searchingDevice(1);
    auto recorder = Recorder::create(file, *scene, device->info(), options, false);
    if (!recorder) ::_exit(3);
    options.sink = recorder->get();
    auto runner = makeRunner(scene, options);
    if (!runner->start()) ::_exit(3);
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    const std::uint64_t steps = runner->report().steps;  // at most a second old itself
    std::ofstream(folder / "steps") << steps << std::flush;
    std::raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_FALSE(fs::exists(file));
  const auto missing = readSessionHeader(file);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().advice,
            "A recording that was cut off is beside it and can be replayed: run.palpate.part.");
  std::uint64_t steps = 0;
  std::ifstream(folder / "steps") >> steps;
  const fs::path part = folder / "run.palpate.part";
  const auto header = readSessionHeader(part);
  ASSERT_TRUE(header) << sentence(header.error());
  EXPECT_FALSE(header->finished);
  EXPECT_GT(header->steps, 500U);
  EXPECT_GE(header->steps + 1000, steps);
  const auto report = replay(part);
  ASSERT_TRUE(report) << sentence(report.error());
  EXPECT_TRUE(report->identical);
  EXPECT_EQ(report->steps, header->steps);
}

TEST_F(Session, AFullDiskIsSaidAndLeavesNothing) {
  if (!kCanFork) GTEST_SKIP() << "Forks, which the thread sanitizer does not follow.";
  const auto scene = prepared(ball());
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // A limit on file size answers writes as a full disk does, in this process alone.
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{400000, 400000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    RunOptions options;
    const auto device = searchingDevice(1);
    auto recorder = Recorder::create(file, *scene, device->info(), options, false);
    if (!recorder) ::_exit(2);
    options.sink = recorder->get();
    auto runner = makeRunner(scene, options);
    if (!runner->runVirtual(40.0, {})) ::_exit(3);  // several commits, however quick
    const auto finished = (*recorder)->finish(runner->report());
    if (finished || finished.error().kind != ErrorKind::Machine) ::_exit(4);
    if (finished.error().file != file.string()) ::_exit(5);
    if (runner->report().recorderDrops == 0) ::_exit(6);  // once it failed, it takes nothing
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(folder.files(), 0U);
}

TEST_F(Session, IsTheUsersAlone) {
  record(file, prepared(ball()), {}, 0.1);
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Session, ARecorderThatIsDroppedLeavesNothing) {
  const auto scene = prepared(ball());
  const auto device = searchingDevice(1);
  {
    auto recorder = Recorder::create(file, *scene, device->info(), {}, false);
    ASSERT_TRUE(recorder);
    EXPECT_GE(folder.files(), 1U);
  }
  EXPECT_EQ(folder.files(), 0U);
}

TEST_F(Session, TheSinkTakesNothingAfterTheEnd) {
  const auto scene = prepared(ball());
  const auto device = searchingDevice(1);
  auto recorder = Recorder::create(file, *scene, device->info(), {}, false);
  ASSERT_TRUE(recorder);
  EXPECT_TRUE((*recorder)->onTick({}));
  ASSERT_TRUE((*recorder)->finish({}));
  EXPECT_FALSE((*recorder)->onTick({}));
  EXPECT_EQ((*recorder)->drops(), 1U);
}

TEST_F(Session, AFullQueueDropsCountsAndSaysInexact) {
  const auto scene = prepared(ball());
  const auto device = searchingDevice(1);
  RunOptions options;
  options.clock = Clock::Real;
  auto recorder = Recorder::create(file, *scene, device->info(), options, false);
  ASSERT_TRUE(recorder);
  ServoSample sample;
  std::uint64_t refused = 0;
  for (std::uint64_t i = 0; i < 200000; ++i) {
    sample.device.index = i;
    if (!(*recorder)->onTick(sample)) ++refused;
  }
  EXPECT_GT(refused, 0U);
  EXPECT_EQ((*recorder)->drops(), refused);
  ASSERT_TRUE((*recorder)->finish({}));
  const auto header = readSessionHeader(file);
  ASSERT_TRUE(header) << sentence(header.error());
  EXPECT_FALSE(header->exact);
}

TEST_F(Session, ExistingFilesAndFoldersAreRefusedAndKept) {
  folder.write("run.palpate", "precious");
  const auto scene = prepared(ball());
  const auto device = searchingDevice(1);
  const auto refused = Recorder::create(file, *scene, device->info(), {}, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::InputRefused);
  EXPECT_EQ(refused.error().message, "The file exists already.");
  EXPECT_EQ(folder.files(), 1U);
  auto allowed = Recorder::create(file, *scene, device->info(), {}, true);
  ASSERT_TRUE(allowed);
  std::string kept;
  std::ifstream(file) >> kept;
  EXPECT_EQ(kept, "precious");  // until the new one is whole
  ASSERT_TRUE((*allowed)->finish({}));
  EXPECT_TRUE(readSessionHeader(file));
  const auto aFolder = Recorder::create(folder.path(), *scene, device->info(), {}, true);
  ASSERT_FALSE(aFolder);
  EXPECT_EQ(aFolder.error().message, "A session is a file, and a folder has that name.");
}

TEST_F(Session, PlacesThatCannotBeWrittenAreMachineErrors) {
  const auto scene = prepared(ball());
  const auto device = searchingDevice(1);
  for (const char* place : {"/proc/run.palpate", "/dev/null/run.palpate"}) {
    const auto recorder = Recorder::create(place, *scene, device->info(), {}, true);
    ASSERT_FALSE(recorder) << place;
    EXPECT_EQ(recorder.error().kind, ErrorKind::Machine) << sentence(recorder.error());
  }
}

TEST_F(Session, WhatIsNoSessionIsRefusedByName) {
  EXPECT_EQ(refusal(file), "There is no such file.||");
  folder.write("run.palpate", "just a text that is long enough to be looked at as a database");
  EXPECT_EQ(refusal(file), "The file is not a session of Palpate.||");
  folder.write("run.palpate", "");
  EXPECT_EQ(refusal(file), "The file is not a session of Palpate.||");
  fs::remove(file);
  sql(file, "CREATE TABLE meta(a)");
  EXPECT_EQ(refusal(file), "The file is not a session of Palpate.||");
}

TEST_F(Session, LaterFormatsAreRefusedByNumber) {
  record(file, prepared(ball()), {}, 0.1);
  sql(file, "PRAGMA user_version = 4");
  EXPECT_EQ(refusal(file), "The session was recorded by a later version of this program.|format|4");
}

TEST_F(Session, DamagedFilesAreRefusedByWhatIsDamaged) {
  record(file, prepared(ball()), {}, 0.1);
  const fs::path copy = folder / "copy.palpate";
  const auto broken = [&](const std::string& how) {
    fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
    sql(copy, how);
    return refusal(copy);
  };
  EXPECT_EQ(broken("UPDATE parts SET data = x'00' WHERE name = 'instrument'"),
            "The session file is damaged.|instrument|");
  EXPECT_EQ(broken("DELETE FROM parts WHERE name = 'exact'"),
            "The session file is damaged.|exact|");
  EXPECT_EQ(broken("DROP TABLE steps"), "The session file is damaged.|tables|");
  // Cut in half: whatever is read first says so, and nothing is replayed.
  fs::copy_file(file, copy, fs::copy_options::overwrite_existing);
  fs::resize_file(copy, fs::file_size(copy) / 2);
  const auto scene = prepared(ball());
  const auto report = replaySession(copy, scene);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().kind, ErrorKind::InputRefused);
}

}  // namespace
}  // namespace palpate
