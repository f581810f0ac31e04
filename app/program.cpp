#include "app/program.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <span>
#include <string>

#include "app/command.h"
#include "app/commands.h"
#include "app/console.h"
#include "app/desktop_options.h"
#include "app/process_guard.h"
#ifdef PALPATE_HAS_COLLIDE
#include "app/command_collide.h"
#endif

namespace palpate {
namespace {

constexpr const char* kPurpose =
    "Palpate: feel a patient's own scan before operating on it.\n"
    "For training and research; not for diagnosis.";

/// The program and its libraries need about half of this before they read anything.
constexpr std::uint64_t kLeastMemoryMiB = 128;

struct ProgramOptions {
  bool json = false, progress = false, verbose = false;
  ProcessLimits limits;
  DesktopOptions desktop;
};

void addProgramOptions(CLI::App& program, ProgramOptions& options) {
  program.add_flag("--json", options.json, "One JSON object on stdout, nothing else there");
  program.add_flag("--progress", options.progress,
                   "Lines 'progress <fraction> <text>' on stderr, also on a terminal");
  program.add_flag("--verbose", options.verbose, "More on stderr; may name files");
  program
      .add_option("--limit-memory-mib", options.limits.memoryMiB,
                  "Stop where the command needs more memory than this")
      ->check(CLI::Range(kLeastMemoryMiB, std::uint64_t{1} << 30U));
  program
      .add_option("--limit-seconds", options.limits.seconds,
                  "Stop where the command takes longer than this")
      ->check(CLI::PositiveNumber);
}

void addCommands(CommandSet& commands) {
  addImportCommand(commands);
  addSeriesCommand(commands);
  addSegmentCommand(commands);
  addExportCommand(commands);
  addCompareCommand(commands);
  addTreeCommand(commands);
  addSimulateCommand(commands);
  addReplayCommand(commands);
#ifdef PALPATE_HAS_COLLIDE
  addCollideCommand(commands);
#endif
  addTradeoffCommand(commands);
  addDevicesCommand(commands);
  addDoctorCommand(commands);
}

/// Needed before parsing, since a usage error follows --json too.
bool asksForJson(int argc, char** argv) {
  for (const char* argument : std::span(argv, static_cast<std::size_t>(argc))) {
    if (argument != nullptr && std::string(argument) == "--json") return true;
  }
  return false;
}

void logToStderr(bool verbose) {
  auto logger = spdlog::stderr_color_mt("palpate");
  logger->set_pattern("palpate: %^%l%$: %v");
  logger->set_level(verbose ? spdlog::level::debug : spdlog::level::warn);
  spdlog::set_default_logger(std::move(logger));
}

/// Where an exception leaves a thread of a library there is nobody to catch it: say so and leave
/// with the machine's exit code instead of a core dump.
[[noreturn]] void onTerminate() {
  constexpr char text[] =
      "\nThe program had to stop: a part of it failed or ran out of memory. Nothing was written; "
      "try again with more memory or a smaller input, and report it if it stays.\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text, sizeof text - 1);
  ::_exit(4);
}

Result<CommandOutput> runGuarded(const CommandFunction& run, const CommandContext& context) {
  try {
    return run(context);
  } catch (const std::bad_alloc&) {
    return fail(machineError("There is not enough memory for this.")
                    .advise("Close other programs, allow more memory, or use a smaller input."));
  } catch (const std::exception& exception) {
    return fail(machineError("A part of the program failed: " + std::string(exception.what()) + ".")
                    .advise("Nothing was written. Please report this with the command line."));
  }
}

int runCommand(const CommandFunction& run, const ProgramOptions& options, Console& console) {
  CommandContext context;
  context.json = options.json;
  context.progress.cancel = &cancelOnSignals();
  context.progress.report = [&console](double fraction, const std::string& what) {
    console.progress(fraction, what);
  };
  const LimitGuard guard(options.limits);
  const Result<CommandOutput> output = runGuarded(run, context);
  if (!output) {
    if (output.error().kind == ErrorKind::Cancelled && guard.timeIsUp()) {
      return console.error(guard.timeError());
    }
    return console.error(output.error());
  }
  console.warn(output->warnings);
  if (!console.result(output->json, output->text)) {
    return console.error(machineError("The result could not be written to the standard output.")
                             .advise("Free space where it goes, or keep the pipe open."));
  }
  return output->checkFailed ? exitCode(ErrorKind::CheckFailed) : 0;
}

int runWindow(DesktopOptions& options, Console& console) {
  const Result<void> complete = completeDesktopOptions(options);
  if (!complete) return console.error(complete.error());
  return runDesktop(options);
}

/// --help and --version are not errors, though CLI11 throws them.
int answerParseError(const CLI::App& program, const CLI::ParseError& error, Console& console) {
  if (error.get_exit_code() == 0) {
    const bool version = dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr;
    const std::string text = version ? std::string(error.what()) + "\n" : program.help();
    if (console.result({{version ? "version" : "help", text}}, text)) return 0;
    return console.error(machineError("The standard output does not take the text."));
  }
  std::string message = error.what();
  if (message.empty() || message.back() != '.') message += '.';
  const auto subcommands = program.get_subcommands();
  const std::string name = subcommands.empty() ? "" : " " + subcommands.front()->get_name();
  return console.error(usageError(message).advise("'palpate" + name + " --help' shows how."));
}

}  // namespace

int runProgram(int argc, char** argv) {
  protectProcess();
  std::set_terminate(&onTerminate);
  ProgramOptions options;
  CLI::App program(kPurpose, "palpate");
  program.set_version_flag("--version", "palpate " PALPATE_VERSION);
  program.require_subcommand(0, 1);
  program.footer(
      "Without a command the window opens. Exit codes: 0 done, 1 check failed, 2 usage,\n"
      "3 input refused, 4 the machine or a file system said no, 5 cancelled.");
  addProgramOptions(program, options);
  addDesktopOptions(program, options.desktop);
  CommandSet commands(program);
  addCommands(commands);

  Console console(asksForJson(argc, argv));
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answerParseError(program, error, console);
  }
  console.setProgressLines(options.progress);
  logToStderr(options.verbose);
  const CommandFunction* run = commands.chosen();
  if (run == nullptr) return runWindow(options.desktop, console);
  const std::string stray = givenDesktopOption(program);
  if (!stray.empty()) {
    return console.error(usageError("The option " + stray +
                                    " belongs to the window, not to a "
                                    "command.")
                             .advise("Leave it out, or call 'palpate " + stray + "' alone."));
  }
  return runCommand(*run, options, console);
}

}  // namespace palpate
