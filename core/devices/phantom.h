#pragma once
/// A Phantom (Omni, Touch, Desktop, Touch X, Premium) through the vendor's HDAPI.
///
/// open() loads the vendor's library, takes the device and starts the vendor's scheduler, whose
/// thread from then on polls the calibration and sends zero wrench. startServo() lets it call the
/// owner's tick as well. Several Phantoms may be open at once, one object each, by the names they
/// have in the vendor's set-up.
///
/// Frame D and units are those of device.h: metres, N·m; HDAPI's mm and mN·m stay inside.
/// Velocities are our own differences (phantom_motion.h). Pose and force are held back while the
/// device is not calibrated (kDeviceNotReady). Faults: hd_error.h; a lost device leaves zero wrench
/// and kDeviceLost, and comes back by itself or by reconnect().

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "core/devices/hdapi.h"
#include "core/devices/phantom_model.h"
#include "core/devices/phantom_servo.h"
#include "core/haptics/device.h"

namespace palpate {

struct PhantomOptions {
  /// Names in the vendor's set-up, in the order they are tried; "" is the vendor's default device.
  std::vector<std::string> names{"Default PHANToM", "Default Device", ""};
  std::vector<std::string> libraries = hd::libraryCandidates();
};

class Phantom final : public HapticDevice {
 public:
  explicit Phantom(PhantomOptions options = {});
  ~Phantom() override;
  Phantom(const Phantom&) = delete;
  Phantom& operator=(const Phantom&) = delete;

  /// Limits of the device once it was opened.
  [[nodiscard]] const DeviceInfo& info() const noexcept override { return info_; }
  /// Machine: no library, no device, no scheduler; with what was tried. Any number of retries.
  [[nodiscard]] Result<void> open() override;
  /// Zero wrench for several ticks, then the scheduler stands still, and the device is given back.
  void close() noexcept override;

  [[nodiscard]] bool ownsClock() const noexcept override { return true; }
  [[nodiscard]] Result<void> startServo(void (*tick)(void* owner) noexcept, void* owner) override;
  void stopServo() noexcept override;
  /// Only inside the tick given to startServo().
  [[nodiscard]] DeviceSample read(std::uint64_t tick) noexcept override;
  void write(const Wrench& wrench_D) noexcept override;

  /// Any thread but the vendor's. A scheduler that stopped ticking shows as a fault.
  [[nodiscard]] PhantomStatus status();
  /// status() and facts() for people.
  [[nodiscard]] DeviceCondition condition() override;
  /// The arm is in its reset position (guidance of the encoder-reset style).
  void confirm() noexcept override { servo_.confirmCalibration(); }
  /// Gives the device back and takes it again, the servo running on (with kDeviceLost meanwhile).
  /// Refuses another model under the same name. On an Error it can be tried again.
  [[nodiscard]] Result<void> reconnect() override;
  /// What the vendor's library said; empty before open().
  [[nodiscard]] const PhantomFacts& facts() const noexcept { return facts_; }
  /// The library in use; empty before open().
  [[nodiscard]] std::string libraryPath() const;

 private:
  [[nodiscard]] Result<void> take(const std::vector<std::string>& names);
  [[nodiscard]] Result<void> prepare();
  void giveBack() noexcept;

  PhantomOptions options_;
  DeviceInfo info_;
  PhantomFacts facts_;
  PhantomServo servo_;
  PhantomServo::Setup setup_;
  VendorScheduler* scheduler_ = nullptr;  // set while open
  std::mutex statusMutex_;                // among the readers of the status; never the servo's
  std::uint64_t lastTicks_ = 0;
  std::chrono::steady_clock::time_point lastTickSeen_;
};

}  // namespace palpate
