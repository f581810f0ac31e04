#pragma once
/// A bounded queue for one producer and one consumer, without waiting on either side.
///
/// Every "bounded queue" arrow of design.md is one of these: a full queue refuses, and the caller
/// counts. Real-time safe after construction: no allocation, lock or exception.

#include <atomic>
#include <cstddef>
#include <memory>
#include <type_traits>

namespace palpate {

template <class T>
class BoundedQueue {
  static_assert(std::is_trivially_copyable_v<T>, "messages between threads are plain data");

 public:
  /// Holds at least `capacity` items.
  explicit BoundedQueue(std::size_t capacity) {
    std::size_t size = 2;
    while (size < capacity + 1) size *= 2;
    slots_ = std::make_unique<T[]>(size);
    mask_ = size - 1;
  }

  /// Producer only. False when full: nothing was taken.
  [[nodiscard]] bool tryPush(const T& item) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    const std::size_t next = (tail + 1) & mask_;
    if (next == head_.load(std::memory_order_acquire)) return false;
    slots_[tail] = item;
    tail_.store(next, std::memory_order_release);
    return true;
  }
  /// Consumer only. False when empty.
  [[nodiscard]] bool tryPop(T& item) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) return false;
    item = slots_[head];
    head_.store((head + 1) & mask_, std::memory_order_release);
    return true;
  }

 private:
  std::unique_ptr<T[]> slots_;
  std::size_t mask_ = 0;
  alignas(64) std::atomic<std::size_t> head_{0};  // consumer's
  alignas(64) std::atomic<std::size_t> tail_{0};  // producer's
};

}  // namespace palpate
