#pragma once
/// A simulated Phantom in a simulated hand (haptics_facts.md §5): mass, damping, Coulomb friction,
/// encoder steps, zero-order hold, one tick of latency, saturation; five-parameter hand.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/devices/hand.h"
#include "core/haptics/device.h"

namespace palpate {

/// "touch" (Omni), "touch-x" (Desktop), "premium-6dof".
[[nodiscard]] std::vector<std::string> simulatedModels();

/// `grip`: a hand set of haptics_facts.md §5: "up-down" (default), "left-right", "fore-aft",
/// "soft", "stiff", "light", "none". Unknown names are refused with the list. Shared hand: the ui
/// may keep it.
[[nodiscard]] Result<std::unique_ptr<HapticDevice>> makeSimulatedPhantom(
    const std::string& model, std::shared_ptr<Hand> hand, std::uint64_t seed,
    const std::string& grip = "up-down");

}  // namespace palpate
