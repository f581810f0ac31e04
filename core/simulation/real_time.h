#pragma once
/// What the real clock asks of the system, and what to do where it says no.

#include <pthread.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace palpate {

/// CLOCK_MONOTONIC, ns.
[[nodiscard]] std::int64_t monotonicNow() noexcept;
/// Sleeps until that time, through signals; returns at once when it is past. Real-time safe.
void sleepUntil(std::int64_t deadline) noexcept;

/// Asks for SCHED_FIFO for a thread. Returns an empty text, or why not and how to allow it.
[[nodiscard]] std::string askForRealTime(pthread_t thread, int priority);

/// The first processor that the system keeps free of other work (isolcpus); -1: none, or unknown.
[[nodiscard]] int isolatedProcessor();
/// Binds a thread to one processor; false where the system says no or there is none of that number.
[[nodiscard]] bool bindToProcessor(pthread_t thread, int processor) noexcept;
/// As tools show it; at most 15 letters.
void nameThread(pthread_t thread, const char* name) noexcept;

/// Locks a range of memory for its lifetime. Where the limit does not allow it, says so by
/// locked(), and nothing else changes.
class LockedMemory {
 public:
  LockedMemory(const void* start, std::size_t bytes) noexcept;
  LockedMemory(const LockedMemory&) = delete;
  LockedMemory& operator=(const LockedMemory&) = delete;
  ~LockedMemory();
  [[nodiscard]] bool locked() const noexcept { return locked_; }

 private:
  const void* start_;
  std::size_t bytes_;
  bool locked_;
};

/// Touches the stack that a loop will use, so that no first touch happens inside it.
void touchStack() noexcept;

}  // namespace palpate
