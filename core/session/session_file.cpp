#include "core/session/session_file.h"

#include "core/simulation/bits.h"

namespace palpate {
namespace {

Error notASession(const std::filesystem::path& file) {
  return inputRefused("The file is not a session of Palpate.")
      .inFile(file.string())
      .advise("Give a file that \"palpate simulate --record\" has written.");
}

Error missing(const std::filesystem::path& file) {
  Error error = inputRefused("There is no such file.").inFile(file.string());
  std::error_code code;
  if (std::filesystem::exists(file.string() + ".part", code)) {
    return error.advise("A recording that was cut off is beside it and can be replayed: " +
                        file.filename().string() + ".part.");
  }
  return error.advise("Check the path.");
}

}  // namespace

Result<Database> openSession(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return fail(missing(file));
  int code = SQLITE_OK;
  auto database = Database::open(file, SQLITE_OPEN_READONLY, code);
  if (!database) {
    return fail(inputRefused("The file cannot be read.")
                    .inFile(file.string())
                    .advise("Check that you may read it."));
  }
  const auto application = database->integer("PRAGMA application_id");
  const auto format = database->integer("PRAGMA user_version");
  if (!application || !format || *application != kSessionApplication) {
    return fail(notASession(file));
  }
  if (*format > kSessionFormat) {
    return fail(inputRefused("The session was recorded by a later version of this program.")
                    .inFile(file.string())
                    .inField("format")
                    .butFound(std::to_string(*format))
                    .wants("at most " + std::to_string(kSessionFormat))
                    .advise("Update the program."));
  }
  const auto tables = database->integer(
      "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN "
      "('meta', 'parts', 'samples', 'steps', 'commands', 'events')");
  if (tables != 6) return fail(damaged(file.string(), "tables"));
  return std::move(*database);
}

Result<void> checkWhole(Database& database, const std::filesystem::path& file) {
  Statement check;
  if (database.prepare("PRAGMA quick_check(1)", check) != SQLITE_OK || check.step() != SQLITE_ROW ||
      check.text(0) != "ok") {
    return fail(damaged(file.string(), "pages"));
  }
  return {};
}

Result<SessionParts> readParts(Database& database, const std::filesystem::path& file) {
  SessionParts parts;
  Statement rows;
  if (database.prepare("SELECT name, hash, data FROM parts", rows) != SQLITE_OK) {
    return fail(damaged(file.string(), "parts"));
  }
  int code = SQLITE_ROW;
  while ((code = rows.step()) == SQLITE_ROW) {
    const std::string name = rows.text(0);
    const auto bytes = rows.bytes(2);
    const auto hash = static_cast<std::uint64_t>(rows.integer(1));
    if (hashBits(bytes.data(), bytes.size(), 0) != hash) {
      return fail(damaged(file.string(), name));
    }
    parts[name].assign(bytes.begin(), bytes.end());
  }
  if (code != SQLITE_DONE) return fail(damaged(file.string(), "parts"));
  return parts;
}

std::string readMeta(Database& database, const std::string& key) {
  Statement row;
  if (database.prepare("SELECT value FROM meta WHERE key = ?", row) != SQLITE_OK) return {};
  row.bind(1, key);
  return row.step() == SQLITE_ROW ? row.text(0) : std::string();
}

}  // namespace palpate
