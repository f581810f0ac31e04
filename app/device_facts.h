#pragma once
/// What is known of a device by its name alone, without opening it.

#include <string>

#include "core/haptics/device.h"

namespace palpate {

/// Of the simulated model of that name; of a Touch X for what has no model (hardware that is not
/// open, a 3D mouse).
[[nodiscard]] DeviceInfo deviceFacts(const std::string& name);

}  // namespace palpate
