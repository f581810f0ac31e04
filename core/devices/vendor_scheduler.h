#pragma once
/// The one scheduler of a vendor library, and the devices that it ticks.
///
/// The vendor's scheduler owns a thread and calls one callback a device and tick on it. Devices
/// are added and removed only while it stands still, and before it is stopped every device gets
/// several ticks of zero wrench: the last force would otherwise persist. So opening or closing one
/// of two devices interrupts the other for some milliseconds, without force.

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <vector>

#include "core/base/error.h"
#include "core/devices/hdapi.h"

namespace palpate {

/// Ticks of zero wrench before force may be considered gone.
inline constexpr std::uint32_t kQuietTicks = 8;

class VendorScheduler;

/// A device as the scheduler sees it.
class VendorDevice {
 public:
  virtual ~VendorDevice() = default;
  /// Vendor's thread, once a tick; real-time safe.
  virtual void onTick(VendorScheduler& scheduler) noexcept = 0;
  /// Vendor's thread: an error popped from the vendor's stack that names this device.
  virtual void noteError(const hd::ErrorInfo& error) noexcept = 0;
  /// Of the vendor's library; hd::kInvalidHandle while there is none.
  [[nodiscard]] virtual hd::Handle handle() const noexcept = 0;
  /// Any thread: from now on zero wrench is sent (true), or no longer forced to be (false).
  virtual void hush(bool quiet) noexcept = 0;
  /// Any thread: consecutive ticks at which zero wrench was sent.
  [[nodiscard]] virtual std::uint32_t quietTicks() const noexcept = 0;
};

class VendorScheduler {
 public:
  static constexpr unsigned long kRate = 1000;  ///< Hz, the servo's.

  /// The scheduler of that library; lives as long as the process.
  [[nodiscard]] static VendorScheduler& of(const hd::Library& library);

  /// Runs `change` while no callback runs, then starts again if there is a device to tick. Not on
  /// the vendor's thread. The Error is the change's, or the start's.
  [[nodiscard]] Result<void> whileStopped(const std::function<Result<void>()>& change);

  /// Inside whileStopped() only. remove() is idempotent.
  [[nodiscard]] Result<void> add(VendorDevice& device);
  void remove(VendorDevice& device) noexcept;
  /// Inside whileStopped() only: pops the vendor's errors, newest first.
  std::vector<hd::ErrorInfo> takeErrors();

  /// Vendor's thread: pops the vendor's errors and hands each to the device it names, else to
  /// `current`. Bounded; real-time safe.
  void routeErrors(VendorDevice& current) noexcept;

  [[nodiscard]] const hd::Library& library() const noexcept { return library_; }

 private:
  struct Slot {
    VendorScheduler* scheduler = nullptr;
    std::atomic<VendorDevice*> device{nullptr};
    std::atomic<bool> inside{false};  // a callback runs
    hd::SchedulerHandle handle = 0;
  };

  explicit VendorScheduler(const hd::Library& library);
  static hd::CallbackCode callback(void* slot) noexcept;
  void quietAll() noexcept;
  void stop() noexcept;
  [[nodiscard]] Result<void> start();

  const hd::Library& library_;
  std::mutex mutex_;
  bool running_ = false;
  std::array<Slot, 4> slots_;  // more Phantoms than anyone has hands
};

/// The oldest of `errors` (newest first) that is worst for the driver: the cause.
[[nodiscard]] const hd::ErrorInfo* causeOf(const std::vector<hd::ErrorInfo>& errors) noexcept;

/// "COMM_ERROR (0x302, internal 7)".
[[nodiscard]] std::string errorText(const hd::ErrorInfo& error);

}  // namespace palpate
