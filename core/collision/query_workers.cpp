#include "core/collision/query_workers.h"

#include <algorithm>
#include <system_error>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace palpate {
namespace {

// About 20 µs: back-to-back queries find the threads awake (a hand-off below a microsecond instead
// of a futex wake), a loop of 1 kHz does not burn a processor between its steps.
constexpr int kSpins = 500;

void relax() noexcept {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

bool spinWhile(const std::atomic<std::uint32_t>& value, std::uint32_t seen) noexcept {
  for (int spin = 0; spin < kSpins; ++spin) {
    if (value.load(std::memory_order_acquire) != seen) return false;
    relax();
  }
  return true;
}

}  // namespace

QueryWorkers::QueryWorkers(int threads) {
  const auto wanted = static_cast<std::size_t>(std::clamp(threads, 1, kMaxThreads));
  threads_.reserve(wanted - 1);
  try {
    for (std::size_t i = 1; i < wanted; ++i) threads_.emplace_back([this, i] { serve(i); });
  } catch (const std::system_error&) {
    // Those that run will do.
  }
}

QueryWorkers::~QueryWorkers() {
  stop_.store(true);
  ticket_.fetch_add(kPartMask + 1);
  ticket_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void QueryWorkers::run(Task task, void* context, std::size_t parts) noexcept {
  task_ = task;
  context_ = context;
  parts_ = static_cast<std::uint32_t>(std::min<std::size_t>(parts, kPartMask));
  unfinished_.store(parts_, std::memory_order_relaxed);
  // Sequentially consistent, as the sleepers' count behind notify_all is: else a thread that is
  // about to sleep could be missed.
  const std::uint32_t round = (ticket_.load(std::memory_order_relaxed) | kPartMask) + 1;
  ticket_.store(round | parts_);
  ticket_.notify_all();
  while (doPart(0)) {
  }
  for (std::uint32_t left = unfinished_.load(std::memory_order_acquire); left != 0;
       left = unfinished_.load(std::memory_order_acquire)) {
    if (spinWhile(unfinished_, left)) unfinished_.wait(left);
  }
}

bool QueryWorkers::doPart(std::size_t thread) noexcept {
  std::uint32_t ticket = ticket_.load(std::memory_order_acquire);
  do {
    if ((ticket & kPartMask) == 0) return false;
  } while (!ticket_.compare_exchange_weak(ticket, ticket - 1, std::memory_order_acquire));
  task_(context_, parts_ - (ticket & kPartMask), thread);
  if (unfinished_.fetch_sub(1) == 1) unfinished_.notify_one();
  return true;
}

void QueryWorkers::serve(std::size_t thread) noexcept {
  for (;;) {
    // The ticket first: the last one is published after stop_, so nobody sleeps on it.
    const std::uint32_t ticket = ticket_.load(std::memory_order_acquire);
    if (stop_.load()) return;
    if ((ticket & kPartMask) != 0) {
      (void)doPart(thread);
    } else if (spinWhile(ticket_, ticket)) {
      asleep_.fetch_add(1, std::memory_order_relaxed);
      ticket_.wait(ticket);
      asleep_.fetch_sub(1, std::memory_order_relaxed);
    }
  }
}

}  // namespace palpate
