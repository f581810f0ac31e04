#pragma once
/// What a hand would feel along a trajectory, and what each step cost.

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "core/haptics/virtual_coupling.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/reference_loop.h"
#include "core/trade/trajectory.h"

namespace palpate {

/// A row a servo tick, W. Between states of the simulation the servo moves the tool on by its
/// velocity (core/haptics/servo_loop.h); so does this.
struct Felt {
  std::vector<Eigen::Vector3d> force_W;   ///< N, on the hand.
  std::vector<Eigen::Vector3d> torque_W;  ///< N·m, about T's origin.
  std::vector<Eigen::Vector3d> tool_W;    ///< Of T's origin, m.
};

struct Pass {
  Felt felt;
  bool settled = true;               ///< Of the reference loop: else it ends early.
  std::vector<double> micros;        ///< Compute time a step: the median of the repeats.
  std::vector<double> slowest;       ///< The longest of the repeats.
  std::vector<std::uint32_t> tests;  ///< Sphere and leaf tests a step.
  std::vector<std::uint32_t> contacts;
};

/// The closed loop of core/simulation.
/// @param gains  of the device; softened for the scene's step by the caller (recommendedGains).
[[nodiscard]] Pass runPass(const std::shared_ptr<const PreparedScene>& scene,
                           const CouplingGains& gains, const Trajectory& trajectory, int repeats);

/// The reference loop with the points of a shell.
[[nodiscard]] Pass runReferencePass(const PreparedScene& scene, const PointShell& shell,
                                    const CouplingGains& gains, const ReferenceShape& shape,
                                    const Trajectory& trajectory, ReferenceRun* poses = nullptr);

}  // namespace palpate
