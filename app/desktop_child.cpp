#include "app/desktop_child.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>

extern char** environ;

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPatience = std::chrono::seconds(3);  // between SIGTERM and SIGKILL

struct Pipe {
  int read = -1, write = -1;
  bool open() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) return false;
    read = ends[0];
    write = ends[1];
    return true;
  }
  void closeWrite() {
    if (write >= 0) ::close(write);
    write = -1;
  }
  ~Pipe() {
    if (read >= 0) ::close(read);
    closeWrite();
  }
};

Result<pid_t> spawn(const std::string& program, const std::vector<std::string>& arguments,
                    const Pipe& out, const Pipe& err) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out.write, 1);
  posix_spawn_file_actions_adddup2(&actions, err.write, 2);
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  pid_t child = 0;
  const int failed =
      ::posix_spawn(&child, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) {
    return fail(machineError("The import could not be started.")
                    .inFile(program)
                    .butFound(std::strerror(failed))
                    .advise("Reinstall Palpate, or import on the command line."));
  }
  return child;
}

/// Takes whole lines off the front; reports progress lines, keeps the last other one.
void takeLines(std::string& buffer, std::string& lastLine, const Progress& progress) {
  for (std::size_t end = buffer.find('\n'); end != std::string::npos; end = buffer.find('\n')) {
    const std::string line = buffer.substr(0, end);
    buffer.erase(0, end + 1);
    if (line.rfind("progress ", 0) != 0) {
      if (!line.empty()) lastLine = line;
      continue;
    }
    char* rest = nullptr;
    const double fraction = std::strtod(line.c_str() + 9, &rest);
    progress(fraction, *rest == ' ' ? rest + 1 : rest);
  }
}

std::optional<std::string> textOf(const nlohmann::json& error, const char* key) {
  if (!error.contains(key) || !error[key].is_string()) return std::nullopt;
  return error[key].get<std::string>();
}

Error errorOf(const std::string& out, const std::string& lastLine, int status) {
  const auto json = nlohmann::json::parse(out, nullptr, false);
  if (json.is_object() && json.contains("error")) {
    const auto& e = json["error"];
    Error error = inputRefused(textOf(e, "message").value_or("The scan was refused."));
    if (textOf(e, "kind") == "machine") error.kind = ErrorKind::Machine;
    error.file = textOf(e, "file");
    error.field = textOf(e, "field");
    error.found = textOf(e, "found");
    error.expected = textOf(e, "expected");
    error.advice = textOf(e, "advice");
    return error;
  }
  if (WIFSIGNALED(status)) {
    return inputRefused("The import stopped unexpectedly while it read the scan.")
        .advise("The file may be damaged, or too large for this machine; nothing was changed.");
  }
  return inputRefused(lastLine.empty() ? "The import failed without a reason." : lastLine);
}

}  // namespace

Result<std::string> runChild(const std::string& program, const std::vector<std::string>& arguments,
                             const Progress& progress) {
  Pipe out;
  Pipe err;
  if (!out.open() || !err.open()) return fail(machineError("No pipe could be made."));
  const Result<pid_t> child = spawn(program, arguments, out, err);
  if (!child) return fail(child.error());
  out.closeWrite();
  err.closeWrite();

  std::string text;
  std::string errors;
  std::string lastLine;
  std::array<pollfd, 2> ends{pollfd{out.read, POLLIN, 0}, pollfd{err.read, POLLIN, 0}};
  std::optional<Clock::time_point> askedToStop;
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    if (progress.cancelled() && !askedToStop) {
      ::kill(*child, SIGTERM);
      askedToStop = Clock::now();
    }
    if (askedToStop && Clock::now() - *askedToStop > kPatience) ::kill(*child, SIGKILL);
    if (::poll(ends.data(), ends.size(), 50) <= 0) continue;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i].fd < 0 || ends[i].revents == 0) continue;
      std::array<char, 4096> block{};
      const ssize_t n = ::read(ends[i].fd, block.data(), block.size());
      if (n > 0) (i == 0 ? text : errors).append(block.data(), static_cast<std::size_t>(n));
      if (n == 0 || (n < 0 && errno != EINTR)) ends[i].fd = -1;
    }
    takeLines(errors, lastLine, progress);
  }
  int status = 0;
  while (::waitpid(*child, &status, 0) < 0 && errno == EINTR) {
  }
  if (askedToStop) return fail(cancelled());
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return text;
  return fail(errorOf(text, lastLine, status));
}

}  // namespace palpate
