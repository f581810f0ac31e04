#pragma once
/// One setting put through a trajectory, and how far it is from another.

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "core/base/error.h"
#include "core/collision/contact.h"
#include "core/geometry/pose.h"
#include "core/haptics/messages.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/tradeoff.h"

namespace palpate {

/// What a setting did along the trajectory.
struct Pass {
  std::vector<Eigen::Vector3d> force_W;      ///< Of the coupling on the device, a step. N.
  std::vector<PlainPose> tool;               ///< X_WT a step.
  std::vector<double> micros;                ///< Compute time a step: median of three runs.
  std::vector<std::vector<Contact>> probed;  ///< Contacts at each probing pose, V.
};

/// The closed loop, for forces and times.
[[nodiscard]] Pass runPass(const std::shared_ptr<const PreparedScene>& scene,
                           std::span<const DeviceSample> samples);

/// The contacts alone, at `probes` (X_WT), into pass.probed.
void probe(const PreparedScene& scene, std::span<const Eigen::Isometry3d> probes, Pass& pass);

/// Poses to compare contacts at: every `stride`-th of the tool's, pressed a little deeper towards
/// the device, as a rigid tool rests with next to no depth.
[[nodiscard]] std::vector<Eigen::Isometry3d> probingPoses(const Pass& pass,
                                                          std::span<const DeviceSample> samples,
                                                          std::size_t stride);

/// Fills errors and times. `spacing` and `referenceSpacing`: of the two shells, m.
void measure(const Pass& pass, const Pass& reference, double spacing, double referenceSpacing,
             TradePoint& point);

}  // namespace palpate
