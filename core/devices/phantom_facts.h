#pragma once
/// Taking a device from the vendor's library, and asking what it is. While the scheduler stands
/// still.

#include <string>
#include <vector>

#include "core/devices/phantom_model.h"
#include "core/devices/phantom_servo.h"
#include "core/devices/vendor_scheduler.h"

namespace palpate {

struct TakenDevice {
  hd::Handle handle = hd::kInvalidHandle;
  std::string name;  ///< The one that answered; "" is the vendor's default device.
};

/// The first of `names` that answers. Machine: each name with the vendor's error, and what to do.
[[nodiscard]] Result<TakenDevice> takeDevice(VendorScheduler& scheduler,
                                             const std::vector<std::string>& names);

struct AskedDevice {
  PhantomFacts facts;
  PhantomServo::Setup setup;
};

/// Asks everything that the driver uses; what a device does not know is left at its default.
[[nodiscard]] AskedDevice askDevice(VendorScheduler& scheduler, const TakenDevice& device);

}  // namespace palpate
