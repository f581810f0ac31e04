#pragma once
/// Devices for the tests: one that is moved by a script, and ones that spoil what another reads.

#include <cstdint>
#include <functional>
#include <memory>

#include "core/haptics/device.h"

namespace palpate::stability {

/// A pose of the stylus in D at a time.
using Path = std::function<PlainPose(double t)>;

/// Nobody's hand: the stylus is where the path says, whatever the force. Velocities as a driver's:
/// differences through a 100 Hz filter. The main button is held.
[[nodiscard]] std::unique_ptr<HapticDevice> makePuppet(const DeviceInfo& info, Path path,
                                                       double period);

/// That share of the readings is lost: the last one is given again.
[[nodiscard]] std::unique_ptr<HapticDevice> dropping(std::unique_ptr<HapticDevice> device,
                                                     double share, std::uint64_t seed);
/// Each reading is of another time than its tick: up to half a period early or late, half a period
/// late in the mean.
[[nodiscard]] std::unique_ptr<HapticDevice> jittering(std::unique_ptr<HapticDevice> device,
                                                      double period, std::uint64_t seed);
/// Coarser encoders: positions in steps of `step` metres, velocities made from those.
[[nodiscard]] std::unique_ptr<HapticDevice> coarser(std::unique_ptr<HapticDevice> device,
                                                    double step, double period);
/// At one tick the reading is spoiled.
[[nodiscard]] std::unique_ptr<HapticDevice> spoiling(std::unique_ptr<HapticDevice> device,
                                                     std::uint64_t tick,
                                                     std::function<void(DeviceSample&)> spoil);

}  // namespace palpate::stability
