#pragma once
/// A simulated Phantom in a simulated hand (haptics_facts.md §5): mass, damping, Coulomb friction,
/// encoder steps, zero-order hold, one tick of latency, saturation; five-parameter hand.
///
/// Velocities are differences of encoder readings through a 100 Hz first-order filter, as a driver
/// gives them. The seed moves the encoders' zero within a step and draws the hand's tremor (three
/// sines of 8 to 12 Hz an axis, 0.05 mm together). Same seed, hand and wrenches: same bits.
/// Motors warm with the square of the force over the continuous one (first order, a minute) and
/// give no more than that once hot. Not modelled: link kinematics.

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
/// "up-down" (default), "left-right", "fore-aft", "soft", "stiff", "light", "none".
[[nodiscard]] std::vector<std::string> simulatedGrips();

/// What may differ from the model: for stability tests, and to look at what an arm would do.
struct SimulatedPhantomOptions {
  double period = 1e-3;          ///< s between reads
  std::uint32_t extraDelay = 0;  ///< Ticks of latency beyond the one, at most 30.
  double frictionScale = 1.0;    ///< Of the Coulomb friction: 0 shows limit cycles it hides.
  double tremor = 5e-5;          ///< m
  double encoderStep = 0.0;      ///< m at the tip; 0: the model's.
  /// s: standard deviation of the instant of a reading about its tick, within half a period. The
  /// wrench is held from reading to reading; the driver's velocity takes every period as even.
  double jitter = 0.0;
  double dropouts = 0.0;      ///< Share of the readings that repeat the last one.
  double amplifierLag = 0.0;  ///< s: time constant of the force behind the command.
  double thermalTime = 60.0;  ///< s: time constant of the motors' warmth; 0: they stay cold.
};

/// `grip`: a hand set of haptics_facts.md §5. Unknown names are refused with the list. Shared hand:
/// the ui may keep it.
[[nodiscard]] Result<std::unique_ptr<HapticDevice>> makeSimulatedPhantom(
    const std::string& model, std::shared_ptr<Hand> hand, std::uint64_t seed,
    const std::string& grip = "up-down", const SimulatedPhantomOptions& options = {});

}  // namespace palpate
