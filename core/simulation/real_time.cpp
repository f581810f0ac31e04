#include "core/simulation/real_time.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fstream>

namespace palpate {
namespace {
constexpr std::int64_t kBillion = 1000000000;
}

std::int64_t monotonicNow() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * kBillion + now.tv_nsec;
}

void sleepUntil(std::int64_t deadline) noexcept {
  timespec until{};
  until.tv_sec = static_cast<time_t>(deadline / kBillion);
  until.tv_nsec = static_cast<long>(deadline % kBillion);
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

std::string askForRealTime(pthread_t thread, int priority) {
  sched_param parameter{};
  parameter.sched_priority = priority;
  const int code = ::pthread_setschedparam(thread, SCHED_FIFO, &parameter);
  if (code == 0) return {};
  return std::string("The system refused real-time priority (") + std::strerror(code) +
         "). To allow it, put \"@audio - rtprio 90\" and \"@audio - memlock unlimited\" into "
         "/etc/security/limits.d/palpate.conf, add the user to the group audio, and log in again.";
}

int isolatedProcessor() {
  std::ifstream list("/sys/devices/system/cpu/isolated");
  int first = -1;
  if (!(list >> first)) return -1;  // an empty file: none
  return first;
}

bool bindToProcessor(pthread_t thread, int processor) noexcept {
  if (processor < 0 || processor >= CPU_SETSIZE) return false;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(processor), &set);
  return ::pthread_setaffinity_np(thread, sizeof(set), &set) == 0;
}

void nameThread(pthread_t thread, const char* name) noexcept {
  (void)::pthread_setname_np(thread, name);
}

LockedMemory::LockedMemory(const void* start, std::size_t bytes) noexcept
    : start_(start), bytes_(bytes), locked_(bytes > 0 && ::mlock(start, bytes) == 0) {}

LockedMemory::~LockedMemory() {
  if (locked_) ::munlock(start_, bytes_);
}

void touchStack() noexcept {
  // Deeper than any call chain of a tick or a step.
  volatile char pages[64 * 1024];
  for (std::size_t i = 0; i < sizeof(pages); i += 4096) pages[i] = 0;
}

}  // namespace palpate
