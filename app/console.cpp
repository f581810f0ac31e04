#include "app/console.h"

#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>

namespace palpate {
namespace {

using nlohmann::ordered_json;

constexpr std::int64_t kProgressPeriodMs = 100;

std::int64_t nowMs() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

/// A sentence stays one line whatever a file or a library put into it.
std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
  const auto twice = [](char a, char b) { return a == ' ' && b == ' '; };
  text.erase(std::unique(text.begin(), text.end(), twice), text.end());
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

ordered_json orNull(const std::optional<std::string>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

std::string dump(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace

ordered_json errorObject(const Error& error) {
  ordered_json fields;
  fields["kind"] = kindName(error.kind);
  fields["message"] = oneLine(error.message);
  fields["file"] = orNull(error.file);
  fields["field"] = orNull(error.field);
  fields["found"] = orNull(error.found);
  fields["expected"] = orNull(error.expected);
  fields["advice"] = orNull(error.advice);
  return {{"error", fields}};
}

Console::Console(bool json) : json_(json), terminal_(::isatty(STDERR_FILENO) == 1) {
  if (!json_) return;
  std::fflush(stdout);
  out_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (out_ < 0) {
    out_ = STDOUT_FILENO;
    return;
  }
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
}

Console::~Console() {
  if (out_ == STDOUT_FILENO) return;
  std::fflush(stdout);
  ::dup2(out_, STDOUT_FILENO);
  ::close(out_);
}

void Console::progress(double fraction, const std::string& what) {
  const std::lock_guard lock(mutex_);
  const std::int64_t now = nowMs();
  if (fraction < 1.0 && now - last_progress_ms_ < kProgressPeriodMs) return;
  last_progress_ms_ = now;
  const double shown = std::clamp(fraction, 0.0, 1.0);
  if (progress_lines_ || !terminal_) {
    std::fprintf(stderr, "progress %.3f %s\n", shown, oneLine(what).c_str());
    return;
  }
  std::fprintf(stderr, "\r\033[K%3.0f %%  %s", shown * 100.0, oneLine(what).c_str());
  line_open_ = true;
}

void Console::clearProgressLine() {
  if (line_open_) std::fputs("\r\033[K", stderr);
  line_open_ = false;
}

void Console::warn(const std::vector<std::string>& warnings) {
  const std::lock_guard lock(mutex_);
  clearProgressLine();
  for (const std::string& warning : warnings) spdlog::warn("{}", oneLine(warning));
}

bool Console::result(const ordered_json& json, const std::string& text) {
  const std::lock_guard lock(mutex_);
  clearProgressLine();
  return writeOut(json_ ? dump(json) : text);
}

int Console::error(const Error& error) {
  const std::lock_guard lock(mutex_);
  clearProgressLine();
  // If stdout does not take the object, the sentence and the exit code still say it.
  if (json_) [[maybe_unused]]
    const bool taken = writeOut(dump(errorObject(error)));
  std::fflush(stdout);
  std::fprintf(stderr, "%s\n", oneLine(sentence(error)).c_str());
  return exitCode(error.kind);
}

bool Console::writeOut(const std::string& text) const {
  const char* at = text.data();
  std::size_t left = text.size();
  while (left > 0) {
    const ssize_t written = ::write(out_, at, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    at += written;
    left -= static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace palpate
