#pragma once
/// stdout and stderr of a command, by the rules of interface.md: with --json one object on stdout
/// and nothing else there; progress, warnings and the closing sentence on stderr.
///
/// With --json, what libraries print to stdout goes to stderr. Not for the servo or the step.

#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace palpate {

/// {"error": {...}} with nulls where a field does not apply.
[[nodiscard]] nlohmann::ordered_json errorObject(const Error& error);

/// One a process.
class Console {
 public:
  explicit Console(bool json);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Lines even on a terminal; elsewhere they are lines anyway.
  void setProgressLines(bool lines) { progress_lines_ = lines; }
  /// Any thread. At most ten a second reach stderr, the last always.
  void progress(double fraction, const std::string& what);
  void warn(const std::vector<std::string>& warnings);
  /// The result: false when stdout did not take it (a full disk, a closed pipe).
  [[nodiscard]] bool result(const nlohmann::ordered_json& json, const std::string& text);
  /// The sentence as the last line of stderr and, with --json, the error object. Returns the exit
  /// code.
  int error(const Error& error);

 private:
  void clearProgressLine();
  [[nodiscard]] bool writeOut(const std::string& text) const;

  bool json_;
  bool progress_lines_ = false;
  bool terminal_ = false;
  int out_ = 1;  ///< Where the result goes; a copy of the first stdout with --json.
  std::mutex mutex_;
  std::int64_t last_progress_ms_ = -1000;
  bool line_open_ = false;
};

}  // namespace palpate
