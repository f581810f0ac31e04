#pragma once
/// How late this machine wakes a 1 kHz loop: what `doctor` measures before anybody trusts a device.

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/progress.h"

namespace palpate {

struct JitterBin {
  double from_us = 0.0, to_us = 0.0;  ///< Half-open; the last one is open-ended (to_us = infinity).
  std::uint64_t count = 0;
};

struct JitterReport {
  std::uint64_t wakeups = 0, late = 0, missed = 0;  ///< late: over 100 µs; missed: a whole period.
  double p50_us = 0, p99_us = 0, p999_us = 0, max_us = 0;
  std::vector<JitterBin> histogram;
  bool realTimePriority = false;
  bool memoryLocked = false;
  std::string priorityNote, memoryNote;  ///< Why not, and how to allow it; empty when granted.
};

/// From lateness per wake-up in µs; percentiles by nearest rank. The counting part of the
/// measurement, apart from the clock.
[[nodiscard]] JitterReport summariseLateness(std::vector<double> lateness_us);

/// Runs the loop on a thread of its own for `seconds`, with real-time priority and locked memory
/// where the machine grants them. Cancelled: an Error.
/// @param processor  to bind the thread to; -1: wherever the system puts it. Refused (Machine)
/// where
///                   the program may not use it.
[[nodiscard]] Result<JitterReport> measureWakeupJitter(double seconds, const Progress& progress,
                                                       int processor = -1);

/// Those that this program may run on, ascending.
[[nodiscard]] std::vector<int> usableProcessors();

}  // namespace palpate
