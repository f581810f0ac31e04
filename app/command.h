#pragma once
/// How a command joins the program.
///
/// One file a command: `app/command_<name>.cpp` with one function `void
/// add<Name>Command(CommandSet&)` declared in app/commands.h (collide: app/command_collide.h). It
/// adds its CLI11 subcommand and options, and hands over the function that runs it. Everything
/// around it is main's: parsing,
/// --json, exit codes, the error object, Ctrl-C, limits. A command never prints, exits or throws.
///
///   void addTreeCommand(CommandSet& commands) {
///     auto options = std::make_shared<TreeCommandOptions>();
///     CLI::App* sub = commands.add("tree", "Builds the tree of a label",
///         [options](const CommandContext& context) { return runTree(*options, context); });
///     sub->add_option("CASE", options->folder, "...")->required();
///   }

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"

namespace palpate {

/// What a command is given. `progress` writes to stderr (lines `progress <fraction> <text>` with
/// --progress, one overwritten line on a terminal, else nothing) and carries Ctrl-C: hand it to
/// everything that takes a Progress.
struct CommandContext {
  bool json = false;
  Progress progress;
};

/// What a command gives back. Exactly one of the texts is printed: `json` with --json, else
/// `text`. Warnings go to stderr, one line each, in both cases.
struct CommandOutput {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  std::string text;
  std::vector<std::string> warnings;
  bool checkFailed = false;  ///< Exit 1 with the output printed (a replay that is not identical).
};

using CommandFunction = std::function<Result<CommandOutput>(const CommandContext&)>;

class CommandSet {
 public:
  explicit CommandSet(CLI::App& program) : program_(program) {}

  /// The subcommand, to add options to. Values live in what `run` captures.
  CLI::App* add(const std::string& name, const std::string& description, CommandFunction run);
  /// After parsing: what the user asked for; nullptr when no subcommand was given.
  [[nodiscard]] const CommandFunction* chosen() const;

 private:
  struct Entry {
    CLI::App* subcommand;
    CommandFunction run;
  };
  CLI::App& program_;
  std::vector<Entry> entries_;
};

}  // namespace palpate
