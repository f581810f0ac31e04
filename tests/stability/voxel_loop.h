#pragma once
/// The whole program's loop on voxels of known shape: Runner on the virtual clock, as shipped.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/devices/hand.h"
#include "core/scene/instrument.h"
#include "core/simulation/runner.h"

namespace palpate::stability {

struct VoxelCase {
  double voxel = 1e-3;  ///< m, edge
  std::array<std::int32_t, 3> dims{48, 48, 48};
  /// Solid where true: metres from the origin of D, y up; four voxels of air are above it.
  std::function<bool(double x, double y, double z)> solid;
  std::shared_ptr<Hand> hand;            ///< In D.
  std::optional<Instrument> instrument;  ///< Empty: the ball burr.
  double seconds = 3.0;
  std::uint64_t seed = 1;
};

struct VoxelResult {
  std::vector<ServoSample> samples;
  std::vector<StepRecord> steps;
  std::vector<Eigen::Vector3d> tip_D;  ///< After each step.
  SafetyLimits limits;
  RunReport report;
};

[[nodiscard]] VoxelResult runOnVoxels(const VoxelCase& c);

}  // namespace palpate::stability
