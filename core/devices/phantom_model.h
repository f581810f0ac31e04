#pragma once
/// What is known of the Phantoms: limits and recommended gains by model (haptics_facts.md §2, §3).

#include <array>
#include <string>

#include "core/haptics/device.h"

namespace palpate {

/// What the vendor's library said of a device; SI, NaN where it said nothing usable.
struct PhantomFacts {
  std::string configuredName;  ///< As in the vendor's configuration; empty: its default device.
  std::string model, vendor, driverVersion, firmware, libraryVersion;
  std::string serial;  ///< Of the device. Never logged, recorded or reported.
  int outputDof = 3;
  double peakForce = 0, continuousForce = 0;             ///< N
  double peakTorque = 0, continuousTorque = 0;           ///< N·m
  std::array<double, 3> workspaceMin{}, workspaceMax{};  ///< m
  std::uint32_t calibrationStyles = 0;
  int updateRate = 0;  ///< Hz
};

/// Limits are the smaller of the table's and the device's own; a model that is not in the table
/// gets the gains and limits of the weakest.
[[nodiscard]] DeviceInfo deviceInfo(const PhantomFacts& facts);

}  // namespace palpate
