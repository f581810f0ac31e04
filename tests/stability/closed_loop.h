#pragma once
/// The closed loop under test: simulated Phantom and hand, ServoLoop, ToolBody and ContactResolver
/// as shipped, on a virtual clock. Analytic shapes stand in for the voxel contacts, so that this
/// runs in microseconds a tick and depends on nothing else.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/devices/hand.h"
#include "core/devices/simulated_phantom.h"
#include "core/dynamics/tool_body.h"
#include "core/haptics/servo_loop.h"

namespace palpate::stability {

/// Depth (> 0 inside) and outward normal of the anatomy at a point, frame D.
struct Inside {
  double depth = 0.0;
  Eigen::Vector3d n = Eigen::Vector3d::UnitY();
};
using Shape = std::function<Inside(const Eigen::Vector3d& p_D)>;

[[nodiscard]] Shape wall();
[[nodiscard]] Shape ball(double radius);  ///< Its top at the origin of D.
/// Two walls that meet below the origin of D, each `halfAngle` from the vertical.
[[nodiscard]] Shape wedge(double halfAngle, double depth);
/// A floor with a round hole along -y of D at its origin, open below.
[[nodiscard]] Shape hole(double radius);
[[nodiscard]] Shape nothing();

struct LoopCase {
  std::string model = "touch-x";
  std::string grip = "up-down";
  SimulatedPhantomOptions arm;  ///< Period, delay, friction, encoders, jitter, lag, dropouts.
  std::uint32_t stepTicks = 1;  ///< of the simulation; its result comes this late
  double mass = 0.05;           ///< kg of the tool
  double toolFriction = 0.2;    ///< Coulomb, of the anatomy
  double gain = 1.0;            ///< Of the recommended coupling stiffness.
  double stiffness = 0.0;       ///< N/m instead, where above 0.
  double damping = -1.0;        ///< N·s/m instead of the recommended, where not below 0.
  double maxTravel = 1e-3;      ///< m a step, of any point of the tool
  double seconds = 5.0;
  double faraway = 0.0;  ///< m: the whole scene moved off the origin of W.
  std::uint64_t seed = 1;
  Shape shape = wall();
  std::shared_ptr<Hand> hand;  ///< Empty: the searching hand.
  /// Puts another device before the simulated one; may be empty.
  std::function<std::unique_ptr<HapticDevice>(std::unique_ptr<HapticDevice>)> wrap;
  /// Between the ticks, for stalls and faults: false = the simulation does not step.
  std::function<bool(std::uint64_t tick, ServoLoop& servo)> meddle;
};

struct LoopResult {
  std::vector<ServoSample> samples;
  Eigen::Isometry3d X_WD = Eigen::Isometry3d::Identity();
  SafetyLimits limits;
  double deepest = 0.0;  ///< m, of any contact
  std::uint64_t stepsInContact = 0;
  std::uint64_t capsReached = 0;
  double largestTurn = 0.0;             ///< rad, between tool and stylus
  std::vector<Eigen::Vector3d> tool_D;  ///< The tool's origin after each step, in D.
};

[[nodiscard]] LoopResult runLoop(const LoopCase& loop);

}  // namespace palpate::stability
