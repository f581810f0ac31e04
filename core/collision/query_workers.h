#pragma once
/// Threads that help one caller through the parts of a step, started once. Internal to
/// ContactFinder.
///
/// Parts are handed out one at a time to whoever asks first, the caller among them. So a thread
/// that wakes late finds nothing left and nobody waits for it; only a part that a thread has begun
/// is waited for. What a part is and where its results go must not depend on who does it.
///
/// A thread that has nothing to do spins for about 20 µs, then sleeps on its atomic (a futex: no
/// mutex); where every processor is busy it may then come too late and the caller does all itself,
/// half a microsecond later than alone. The threads inherit scheduling and processors of the thread
/// that makes the object.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace palpate {

class QueryWorkers {
 public:
  static constexpr int kMaxThreads = 64;
  /// `thread` is that of who does the part: 0 the caller, 1 .. threads() − 1 the others.
  using Task = void (*)(void* context, std::size_t part, std::size_t thread) noexcept;

  /// Starts threads − 1 threads, fewer where the system refuses (which changes no result).
  explicit QueryWorkers(int threads);
  ~QueryWorkers();
  QueryWorkers(const QueryWorkers&) = delete;
  QueryWorkers& operator=(const QueryWorkers&) = delete;

  /// The caller included.
  [[nodiscard]] std::size_t threads() const noexcept { return threads_.size() + 1; }
  /// Do all threads look for work just now? Then a round costs its caller less than a microsecond
  /// instead of a futex wake. Only ever a hint.
  [[nodiscard]] bool awake() const noexcept { return asleep_.load(std::memory_order_relaxed) == 0; }

  /// Calls task(context, p, …) for p in 0 .. parts − 1 (at most 255), each once, on any thread;
  /// returns when all are done. One caller at a time. No allocation, lock or exception.
  void run(Task task, void* context, std::size_t parts) noexcept;

 private:
  void serve(std::size_t thread) noexcept;
  [[nodiscard]] bool doPart(std::size_t thread) noexcept;

  // Number of the round in the upper bits, parts that nobody has taken in the lower ones: whoever
  // counts them down by one has a part of just this round.
  static constexpr std::uint32_t kPartBits = 8;
  static constexpr std::uint32_t kPartMask = (1U << kPartBits) - 1;
  alignas(64) std::atomic<std::uint32_t> ticket_{0};
  alignas(64) std::atomic<std::uint32_t> unfinished_{0};
  std::atomic<std::uint32_t> asleep_{0};
  // Written by the caller before it publishes a round, read by those who have taken a part of it.
  alignas(64) Task task_ = nullptr;
  void* context_ = nullptr;
  std::uint32_t parts_ = 0;
  std::atomic<bool> stop_{false};
  std::vector<std::thread> threads_;
};

}  // namespace palpate
