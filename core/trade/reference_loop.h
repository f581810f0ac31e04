#pragma once
/// The tool on its coupling against a reference shape: an own, slow solution of the same problem.
///
/// Shares no code with core/collision, core/dynamics or core/simulation. A rigid body on the
/// coupling of core/haptics must not enter the shape; friction is Coulomb's. Two parts a servo
/// tick; in each the velocity is found by backward Euler for the coupling and by Gauss-Seidel over
/// every point nearer than a margin for the contacts (Signorini's and Coulomb's conditions on the
/// velocity, Moreau's time stepping), to convergence. So nothing is left in, nothing is cut, no
/// contact is chosen before another.
///
/// Where the sweeps do not settle, as for a long handpiece that a hand wedges between walls, or
/// where the tool comes in through anatomy that the scan's edge cuts open, points get inside and
/// the tool may slip through a wall: such a run says so and ends there.

#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <vector>

#include "core/haptics/messages.h"
#include "core/simulation/prepared_scene.h"
#include "core/trade/reference_shape.h"

namespace palpate {

struct ReferenceTool {
  MassProperties mass;
  std::vector<Eigen::Vector3d> points_T;                            ///< The finest shell.
  double stiffness = 0, damping = 0, stiffnessR = 0, dampingR = 0;  ///< Of the coupling, SI.
  /// Coulomb's coefficient at a place of the surface, W; empty: none.
  std::function<double(const Eigen::Vector3d& p_W)> frictionAt;
};

/// The tool at the end of each tick; as many as samples, fewer where it did not settle. W.
struct ReferenceRun {
  bool settled = true;  ///< Once out, no point was more than 0.1 mm inside when a part began.
  std::vector<PlainPose> tool;
  std::vector<Eigen::Vector3d> v, w;  ///< Of T's origin, m/s and rad/s.
  std::vector<double> micros;         ///< Compute time of each tick.
};

[[nodiscard]] ReferenceRun runReference(const ReferenceTool& tool, const ReferenceShape& shape,
                                        std::span<const DeviceSample> samples);

}  // namespace palpate
