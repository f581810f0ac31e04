#pragma once
/// The newest value of one writer, for one reader, without waiting: a triple buffer.
///
/// Every "latest value" arrow of design.md ("Threads and what crosses between them") is one of
/// these. The writer never waits for the reader and the reader never sees a torn value; values in
/// between are lost. Real-time safe on both sides: no allocation, lock or exception.

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate {

template <class T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>, "messages between threads are plain data");

 public:
  /// Writer thread only.
  void publish(const T& value) noexcept {
    slots_[write_] = value;
    const std::uint8_t old =
        shared_.exchange(static_cast<std::uint8_t>(write_ | kFresh), std::memory_order_acq_rel);
    write_ = old & kIndex;
  }
  /// Writer thread only: a slot to fill in place, then publishFilled(). Saves a copy of large T.
  [[nodiscard]] T& slotToFill() noexcept { return slots_[write_]; }
  void publishFilled() noexcept {
    const std::uint8_t old =
        shared_.exchange(static_cast<std::uint8_t>(write_ | kFresh), std::memory_order_acq_rel);
    write_ = old & kIndex;
  }
  /// Reader thread only. Takes the newest value, if there is one since the last call.
  bool refresh() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    const std::uint8_t old = shared_.exchange(read_, std::memory_order_acq_rel);
    read_ = old & kIndex;
    return true;
  }
  /// Reader thread only. What the last refresh() took; a value-initialised T before the first.
  [[nodiscard]] const T& value() const noexcept { return slots_[read_]; }

 private:
  static constexpr std::uint8_t kIndex = 3;
  static constexpr std::uint8_t kFresh = 4;
  std::array<T, 3> slots_{};
  std::uint8_t write_ = 0;               // writer's own
  std::atomic<std::uint8_t> shared_{1};  // in between
  std::uint8_t read_ = 2;                // reader's own
};

}  // namespace palpate
