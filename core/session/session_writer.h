#pragma once
/// Writes a session file: the recorder's own thread, never a loop.
///
/// The first thing that fails is kept; everything after it does nothing.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/session/database.h"
#include "core/session/session_rows.h"
#include "core/session/session_scene.h"

namespace palpate {

/// A command as it was told: before this step.
struct TimedCommand {
  std::uint64_t step = 0;
  Command command;
};
static_assert(std::is_trivially_copyable_v<TimedCommand>);

class SessionWriter {
 public:
  /// Creates `file` anew. `shown` is the name that errors tell.
  [[nodiscard]] static Result<std::unique_ptr<SessionWriter>> create(
      const std::filesystem::path& file, const std::filesystem::path& shown);

  void meta(const std::string& key, const std::string& value);
  void part(const std::string& name, const std::vector<std::uint8_t>& data);
  void sample(const ServoSample& sample);  ///< And the events that follow from it.
  void step(const StepRecord& step);
  void command(const TimedCommand& command);
  /// Writes the events of levels whose first step is known by now. Names of the scene's levels.
  void levelEvents(const std::vector<std::string>& names);

  void begin();
  /// On the disk when it returns.
  void commit();
  /// One file, nothing beside it, closed.
  void close();
  [[nodiscard]] const std::optional<Error>& error() const { return error_; }

 private:
  SessionWriter(Database database, std::filesystem::path shown)
      : database_(std::move(database)), shown_(std::move(shown)) {}
  [[nodiscard]] bool createTables();
  void check(int code);
  void event(std::uint64_t tick, const char* kind, const std::string& detail);

  Database database_;
  std::filesystem::path shown_;
  std::optional<Error> error_;
  std::optional<Statement> meta_, part_, sample_, step_, command_, event_, sampleOf_;
  Packer packer_;
  ServoSample last_;
  std::vector<TimedCommand> levels_;  ///< Told, and without an event so far.
};

}  // namespace palpate
