#pragma once
/// SQLite, as far as a session needs it: errors returned, handles owned.

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/base/error.h"

namespace palpate {

/// A prepared statement. One thread at a time.
class Statement {
 public:
  void bind(int column, std::int64_t value) { ::sqlite3_bind_int64(handle_.get(), column, value); }
  void bind(int column, double value) { ::sqlite3_bind_double(handle_.get(), column, value); }
  void bind(int column, const std::string& text);
  /// The bytes must stay until run() or reset().
  void bind(int column, std::span<const std::uint8_t> bytes);
  /// SQLITE_ROW, SQLITE_DONE or an error code.
  [[nodiscard]] int step() { return ::sqlite3_step(handle_.get()); }
  /// For a statement that gives no rows: steps once and resets. The SQLite code; 0 is good.
  [[nodiscard]] int run();
  void reset() { ::sqlite3_reset(handle_.get()); }

  [[nodiscard]] std::int64_t integer(int column) const {
    return ::sqlite3_column_int64(handle_.get(), column);
  }
  [[nodiscard]] double number(int column) const {
    return ::sqlite3_column_double(handle_.get(), column);
  }
  [[nodiscard]] std::string text(int column) const;
  /// Valid until the next step or reset.
  [[nodiscard]] std::span<const std::uint8_t> bytes(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const { ::sqlite3_finalize(statement); }
  };
  std::unique_ptr<sqlite3_stmt, Finalize> handle_;
};

/// One open file. One thread at a time.
class Database {
 public:
  /// The SQLite code in `code`; nothing where it could not be opened.
  [[nodiscard]] static std::optional<Database> open(const std::filesystem::path& file, int flags,
                                                    int& code);
  /// Runs statements without results. The SQLite code; 0 is good.
  [[nodiscard]] int execute(const char* sql);
  [[nodiscard]] int prepare(const char* sql, Statement& out);
  /// The number a one-cell query gives, or nothing.
  [[nodiscard]] std::optional<std::int64_t> integer(const char* sql);
  /// False when the last pages could not be written.
  [[nodiscard]] bool close();
  [[nodiscard]] std::string lastMessage() const { return ::sqlite3_errmsg(handle_.get()); }
  /// errno of the last failed system call, or 0.
  [[nodiscard]] int systemError() const { return ::sqlite3_system_errno(handle_.get()); }

 private:
  struct Close {
    void operator()(sqlite3* database) const { ::sqlite3_close_v2(database); }
  };
  std::unique_ptr<sqlite3, Close> handle_;
};

}  // namespace palpate
