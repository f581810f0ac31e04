#pragma once
/// Signals and crashes while the window runs: the force goes first, then the window.
///
/// One a process, main thread. SIGTERM, SIGINT and SIGHUP turn the force off and ask the window to
/// close, which ends a recording properly. A crash turns the force off, gives the servo thread time
/// to send it, and lets the crash happen.

#include "core/simulation/runner.h"

namespace palpate {

class DesktopSignals {
 public:
  DesktopSignals();
  ~DesktopSignals();  ///< The handlers that were there before.
  DesktopSignals(const DesktopSignals&) = delete;
  DesktopSignals& operator=(const DesktopSignals&) = delete;

  /// Whose force a signal takes away; null before that runner goes.
  static void guard(Runner* runner) noexcept;
  /// True once a signal asked the window to close.
  [[nodiscard]] static bool askedToClose() noexcept;
};

}  // namespace palpate
