#pragma once
/// What the process promises before it touches a file: no core dump, private files, a clean stop.
///
/// One a process, made at the start of main; main's thread.

#include <cstdint>
#include <memory>

#include "core/base/error.h"
#include "core/base/progress.h"

namespace palpate {

/// Limits of a command that reads hostile files (`import` as the desktop's child). 0: none.
struct ProcessLimits {
  std::uint64_t memoryMiB = 0;
  double seconds = 0.0;
};

/// Core dumps off, other processes of the user kept from reading ours, umask 077, SIGPIPE ignored
/// (a closed pipe is a failed write). Call before any file is opened.
void protectProcess();

/// From now on SIGINT and SIGTERM cancel the returned token; a second one ends the program at once
/// with exit code 5 and the sentence. Not for the desktop, which has its own handlers.
[[nodiscard]] const CancelToken& cancelOnSignals();

/// Memory beyond the limit makes allocations fail; at the time limit the token of
/// cancelOnSignals() is cancelled, and 5 s later the program ends whatever it does (exit code 4).
class LimitGuard {
 public:
  explicit LimitGuard(const ProcessLimits& limits);
  ~LimitGuard();
  LimitGuard(const LimitGuard&) = delete;
  LimitGuard& operator=(const LimitGuard&) = delete;

  [[nodiscard]] bool timeIsUp() const noexcept;
  /// For a command that was stopped by the time limit.
  [[nodiscard]] Error timeError() const;

 private:
  struct Watch;
  std::unique_ptr<Watch> watch_;
};

}  // namespace palpate
