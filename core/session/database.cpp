#include "core/session/database.h"

namespace palpate {

void Statement::bind(int column, const std::string& text) {
  ::sqlite3_bind_text64(handle_.get(), column, text.data(), text.size(), SQLITE_TRANSIENT,
                        SQLITE_UTF8);
}

void Statement::bind(int column, std::span<const std::uint8_t> bytes) {
  ::sqlite3_bind_blob64(handle_.get(), column, bytes.data(), bytes.size(), SQLITE_STATIC);
}

int Statement::run() {
  const int code = step();
  reset();
  return code == SQLITE_DONE || code == SQLITE_ROW ? SQLITE_OK : code;
}

std::string Statement::text(int column) const {
  const auto* start = reinterpret_cast<const char*>(::sqlite3_column_text(handle_.get(), column));
  if (start == nullptr) return {};
  return {start, static_cast<std::size_t>(::sqlite3_column_bytes(handle_.get(), column))};
}

std::span<const std::uint8_t> Statement::bytes(int column) const {
  const auto* start =
      static_cast<const std::uint8_t*>(::sqlite3_column_blob(handle_.get(), column));
  if (start == nullptr) return {};
  return {start, static_cast<std::size_t>(::sqlite3_column_bytes(handle_.get(), column))};
}

std::optional<Database> Database::open(const std::filesystem::path& file, int flags, int& code) {
  sqlite3* handle = nullptr;
  code = ::sqlite3_open_v2(file.c_str(), &handle, flags, nullptr);
  Database database;
  database.handle_.reset(handle);  // SQLite hands out a handle even where it fails
  if (code != SQLITE_OK) return std::nullopt;
  ::sqlite3_extended_result_codes(handle, 0);
  return database;
}

int Database::execute(const char* sql) {
  return ::sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr);
}

int Database::prepare(const char* sql, Statement& out) {
  sqlite3_stmt* statement = nullptr;
  const int code = ::sqlite3_prepare_v2(handle_.get(), sql, -1, &statement, nullptr);
  out.handle_.reset(statement);
  return code;
}

std::optional<std::int64_t> Database::integer(const char* sql) {
  Statement statement;
  if (prepare(sql, statement) != SQLITE_OK || statement.step() != SQLITE_ROW) return std::nullopt;
  return statement.integer(0);
}

bool Database::close() {
  return ::sqlite3_close(handle_.release()) == SQLITE_OK;
}

}  // namespace palpate
