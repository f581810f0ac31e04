#include "core/session/session_writer.h"

#include <cerrno>
#include <string>

#include "core/base/whole_file.h"
#include "core/session/session_file.h"
#include "core/simulation/bits.h"

namespace palpate {
namespace {

constexpr const char* kTables =
    "CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;"
    "CREATE TABLE parts(name TEXT PRIMARY KEY, hash INTEGER NOT NULL, data BLOB NOT NULL);"
    "CREATE TABLE samples(tick INTEGER PRIMARY KEY, data BLOB NOT NULL);"
    "CREATE TABLE steps(step INTEGER PRIMARY KEY, sample INTEGER NOT NULL, data BLOB NOT NULL);"
    "CREATE TABLE commands(number INTEGER PRIMARY KEY, step INTEGER NOT NULL,"
    " kind INTEGER NOT NULL, value REAL NOT NULL);"
    "CREATE TABLE events(number INTEGER PRIMARY KEY, tick INTEGER NOT NULL, kind TEXT NOT NULL,"
    " detail TEXT NOT NULL);";

bool giving(SafetyState state) {
  return state == SafetyState::Ramping || state == SafetyState::Armed ||
         state == SafetyState::Fading;
}

}  // namespace

Result<std::unique_ptr<SessionWriter>> SessionWriter::create(const std::filesystem::path& file,
                                                             const std::filesystem::path& shown) {
  int code = SQLITE_OK;
  auto database = Database::open(file, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, code);
  if (!database) return fail(cannotWrite(shown, errno != 0 ? errno : EACCES));
  std::unique_ptr<SessionWriter> writer(new SessionWriter(std::move(*database), shown));
  if (!writer->createTables()) return fail(*writer->error_);
  return writer;
}

bool SessionWriter::createTables() {
  const std::string header =
      "PRAGMA application_id = " + std::to_string(kSessionApplication) +
      "; PRAGMA user_version = " + std::to_string(kSessionFormat) +
      ";"
      // Write-ahead log, flushed at each commit: a power cut loses at most the open transaction.
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;";
  check(database_.execute(header.c_str()));
  check(database_.execute(kTables));
  const auto prepare = [this](const char* sql, std::optional<Statement>& out) {
    out.emplace();
    check(database_.prepare(sql, *out));
  };
  prepare("INSERT OR REPLACE INTO meta VALUES(?, ?)", meta_);
  prepare("INSERT OR REPLACE INTO parts VALUES(?, ?, ?)", part_);
  prepare("INSERT INTO samples VALUES(?, ?)", sample_);
  prepare("INSERT INTO steps VALUES(?, ?, ?)", step_);
  prepare("INSERT INTO commands(step, kind, value) VALUES(?, ?, ?)", command_);
  prepare("INSERT INTO events(tick, kind, detail) VALUES(?, ?, ?)", event_);
  prepare("SELECT sample FROM steps WHERE step = ?", sampleOf_);
  return !error_;
}

void SessionWriter::check(int code) {
  if (code == SQLITE_OK || error_) return;
  int why = database_.systemError();
  if (code == SQLITE_FULL) why = ENOSPC;
  error_ = cannotWrite(shown_, why != 0 ? why : EIO);
}

void SessionWriter::meta(const std::string& key, const std::string& value) {
  if (error_) return;
  meta_->bind(1, key);
  meta_->bind(2, value);
  check(meta_->run());
}

void SessionWriter::part(const std::string& name, const std::vector<std::uint8_t>& data) {
  if (error_) return;
  part_->bind(1, name);
  part_->bind(2, static_cast<std::int64_t>(hashBits(data.data(), data.size(), 0)));
  part_->bind(3, data);
  check(part_->run());
}

void SessionWriter::sample(const ServoSample& sample) {
  if (error_) return;
  packer_.clear();
  pack(packer_, sample);
  sample_->bind(1, static_cast<std::int64_t>(sample.device.index));
  sample_->bind(2, packer_.bytes());
  check(sample_->run());

  const std::uint64_t tick = sample.device.index;
  if (sample.fault != last_.fault && sample.fault != SafetyFault::None) {
    event(tick, "fault", describe(sample.fault));
  }
  if (giving(sample.state) != giving(last_.state)) {
    event(tick, giving(sample.state) ? "armed" : "disarmed", describe(sample.state));
  }
  if ((sample.contacts > 0) != (last_.contacts > 0)) {
    event(tick, sample.contacts > 0 ? "contact-begin" : "contact-end", "");
  }
  last_ = sample;
}

void SessionWriter::step(const StepRecord& step) {
  if (error_) return;
  packer_.clear();
  pack(packer_, step);
  step_->bind(1, static_cast<std::int64_t>(step.step));
  step_->bind(2, static_cast<std::int64_t>(step.deviceSample));
  step_->bind(3, packer_.bytes());
  check(step_->run());
}

void SessionWriter::command(const TimedCommand& timed) {
  if (error_) return;
  command_->bind(1, static_cast<std::int64_t>(timed.step));
  command_->bind(2, static_cast<std::int64_t>(timed.command.kind));
  command_->bind(3, timed.command.value);
  check(command_->run());
  if (timed.command.kind == Command::Kind::SetLevel) levels_.push_back(timed);
}

// A command is told before its step, which may come with the next lot.
void SessionWriter::levelEvents(const std::vector<std::string>& names) {
  if (error_) return;
  std::erase_if(levels_, [&](const TimedCommand& timed) {
    sampleOf_->bind(1, static_cast<std::int64_t>(timed.step));
    const bool known = sampleOf_->step() == SQLITE_ROW;
    const auto tick = known ? static_cast<std::uint64_t>(sampleOf_->integer(0)) : 0;
    sampleOf_->reset();
    if (!known) return false;
    const double value = timed.command.value;
    const bool named = value >= 0.0 && value < static_cast<double>(names.size());
    const auto level = named ? static_cast<std::size_t>(value) : 0;
    event(tick, "level", std::to_string(level) + (named ? " " + names[level] : std::string()));
    return true;
  });
}

void SessionWriter::event(std::uint64_t tick, const char* kind, const std::string& detail) {
  event_->bind(1, static_cast<std::int64_t>(tick));
  event_->bind(2, std::string(kind));
  event_->bind(3, detail);
  check(event_->run());
}

void SessionWriter::begin() {
  if (!error_) check(database_.execute("BEGIN"));
}

void SessionWriter::commit() {
  if (!error_) check(database_.execute("COMMIT"));
}

void SessionWriter::close() {
  for (auto* statement : {&meta_, &part_, &sample_, &step_, &command_, &event_, &sampleOf_}) {
    statement->reset();
  }
  if (!error_) {
    check(database_.execute("PRAGMA wal_checkpoint(TRUNCATE); PRAGMA journal_mode = DELETE"));
  }
  if (!database_.close() && !error_) error_ = cannotWrite(shown_, EIO);
}

}  // namespace palpate
