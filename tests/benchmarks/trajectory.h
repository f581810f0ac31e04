#pragma once
/// Poses of the drill over the synthetic bone, the same for every peer.

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/benchmarks/dense_field.h"

namespace palpate::bench {

struct Trajectory {
  std::string name;
  std::vector<Eigen::Isometry3d> X_VT;
};

/// - slide: the burr is drawn over the upper face, pressed in by `press` metres.
/// - approach: from 10 mm above the tool, nearly flat, sinks in by up to `press`.
/// - flat: the tool lies on the face and is pressed in by `press`.
/// - random50: fifty approaches from random directions, to a depth of `press`.
/// - teleport: every step somewhere else: out of reach, sliding, or pressed in.
/// - away: out of reach.
/// Same arguments, same poses. An unknown name gives an empty trajectory.
[[nodiscard]] Trajectory makeTrajectory(const std::string& name, double press, std::size_t steps,
                                        std::uint64_t seed);

/// Sliding over any world: the burr follows the surface around the grid's centre, met from outside
/// and sunk in by `press` metres; the shaft leans 0.5 rad from the way out.
[[nodiscard]] Trajectory slideAround(const DenseField& field, double press, std::size_t steps);

/// The depth at which a shell of so many points has the contacts of the table that is compared
/// with: sliding 100/300/1000 for 1k/10k/100k points, up to a tenth of the points approaching.
[[nodiscard]] double usualPress(const std::string& name, std::size_t points);

}  // namespace palpate::bench
