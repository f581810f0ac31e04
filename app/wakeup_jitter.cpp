#include "app/wakeup_jitter.h"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>

#include "core/simulation/real_time.h"

namespace palpate {
namespace {

constexpr std::int64_t kPeriodNs = 1'000'000;
constexpr double kPeriodUs = 1000.0;
constexpr double kLateUs = 100.0;  // interface.md: due more than 100 µs ago
constexpr int kPriority = 80;  // above the kernel's threaded interrupts (50), below its own (99)

double percentile(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size())));
  return sorted[std::min(sorted.size(), std::max<std::size_t>(rank, 1)) - 1];
}

struct Loop {
  std::vector<double> lateness_us;
  std::atomic<std::size_t> done{0};
  std::atomic<bool> stop{false};
  std::string priorityNote;
  int processor = -1;
  bool bound = true;

  void run() {
    if (processor >= 0) bound = bindToProcessor(::pthread_self(), processor);
    ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
    const sched_param wanted{kPriority};
    const int refused = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted);
    if (refused != 0) {
      priorityNote = "Real-time priority was refused (" + std::string(std::strerror(refused)) +
                     "). To allow it, add '@users - rtprio 80' to /etc/security/limits.d and log "
                     "in again.";
    }
    std::int64_t due = monotonicNow() + kPeriodNs;
    for (double& late : lateness_us) {
      if (stop.load(std::memory_order_relaxed)) return;
      sleepUntil(due);
      const std::int64_t now = monotonicNow();
      late = static_cast<double>(now - due) * 1e-3;
      due += kPeriodNs;
      if (now > due) due += (now - due) / kPeriodNs * kPeriodNs;  // skip what was missed
      done.fetch_add(1, std::memory_order_relaxed);
    }
  }
};

}  // namespace

JitterReport summariseLateness(std::vector<double> lateness_us) {
  constexpr std::array<double, 11> kEdges{0, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000};
  JitterReport report;
  for (std::size_t i = 0; i < kEdges.size(); ++i) {
    const bool last = i + 1 == kEdges.size();
    const double to = last ? std::numeric_limits<double>::infinity() : kEdges[i + 1];
    report.histogram.push_back({kEdges[i], to, 0});
  }
  for (const double late : lateness_us) {
    report.late += late > kLateUs ? 1U : 0U;
    report.missed += late > kPeriodUs ? static_cast<std::uint64_t>(late / kPeriodUs) : 0U;
    const auto above = std::upper_bound(kEdges.begin(), kEdges.end(), std::max(late, 0.0));
    ++report.histogram[static_cast<std::size_t>(above - kEdges.begin()) - 1].count;
  }
  std::sort(lateness_us.begin(), lateness_us.end());
  report.wakeups = lateness_us.size();
  report.p50_us = percentile(lateness_us, 0.50);
  report.p99_us = percentile(lateness_us, 0.99);
  report.p999_us = percentile(lateness_us, 0.999);
  report.max_us = lateness_us.empty() ? 0.0 : lateness_us.back();
  return report;
}

std::vector<int> usableProcessors() {
  std::vector<int> all;
  cpu_set_t set;
  CPU_ZERO(&set);
  if (::sched_getaffinity(0, sizeof(set), &set) != 0) return all;
  for (int i = 0; i < CPU_SETSIZE; ++i) {
    if (CPU_ISSET(static_cast<std::size_t>(i), &set)) all.push_back(i);
  }
  return all;
}

Result<JitterReport> measureWakeupJitter(double seconds, const Progress& progress, int processor) {
  Loop loop;
  loop.processor = processor;
  loop.lateness_us.resize(static_cast<std::size_t>(std::max(1.0, seconds * 1e9 / kPeriodNs)));
  const std::size_t bytes = loop.lateness_us.size() * sizeof(double);
  const bool locked = ::mlock(loop.lateness_us.data(), bytes) == 0;
  const std::string memoryNote =
      locked ? ""
             : "The loop's memory could not be locked (" + std::string(std::strerror(errno)) +
                   "). To allow it, add '@users - memlock 262144' to /etc/security/limits.d and "
                   "log in again.";
  std::thread thread([&loop] { loop.run(); });
  const std::size_t total = loop.lateness_us.size();
  while (loop.done.load(std::memory_order_relaxed) < total && !progress.cancelled()) {
    const double wait = std::min(0.1, seconds);
    std::this_thread::sleep_for(std::chrono::duration<double>(wait));
    const std::size_t done = loop.done.load(std::memory_order_relaxed);
    progress(static_cast<double>(done) / static_cast<double>(total), "Measuring wake-ups");
  }
  loop.stop.store(true);
  thread.join();
  if (progress.cancelled()) return fail(cancelled());
  if (!loop.bound) {
    return fail(machineError("The loop could not be bound to a processor.")
                    .butFound("processor " + std::to_string(processor)));
  }
  JitterReport report = summariseLateness(loop.lateness_us);
  if (locked) ::munlock(loop.lateness_us.data(), bytes);
  report.realTimePriority = loop.priorityNote.empty();
  report.priorityNote = loop.priorityNote;
  report.memoryLocked = locked;
  report.memoryNote = memoryNote;
  return report;
}

}  // namespace palpate
