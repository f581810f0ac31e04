#pragma once
/// What of the anatomy goes into the tree: what lies in the scene's region and what an instrument
/// can get to. A part of prepareScene(); not for the loops.
///
/// **Region.** Voxels whose centre is outside are background: the cut is a surface like any other.
///
/// **Sealed.** Cavities without a way in (sealed_cavities.h) are filled with their wall, so that
/// their inner surface is not there: no brick, no sphere. A cavity stays where
///  - the instrument could be put into it as a whole (the device may be anywhere when a run
///    starts), or a voxel of a loose body is in it;
///  - a contact less deep than half the smallest voxel could tell (fillableCavities()).
/// So all contacts of a tool that came from outside, none of them deeper than that, have the same
/// set, depth, normal and label as without, bit for bit. Beyond, in the far half of a wall, the
/// whole anatomy would push the tool on into the cavity; with the cavity filled it is pushed back
/// out. And a tool that starts half inside a wall meets filling where the cavity would be; force
/// cannot be armed there in either case (safety.h).
///
/// **Device.** Voxels that the instrument's shell cannot get near are background: farther from the
/// device's workspace than the shell reaches, by kWorkspaceMargin, plus what depths are measured
/// over, so that all depths within are those of the whole anatomy up to saturation. A real arm goes
/// beyond its nominal box, and a session may be played on another device: this is asked for, never
/// the default.

#include <cstdint>
#include <memory>

#include "core/collision/point_shell.h"
#include "core/scene/scene.h"
#include "core/simulation/approach.h"
#include "core/voxels/label_grid.h"

namespace palpate {

/// m. Published workspaces are what a maker warrants; arms were seen to go some centimetres on.
inline constexpr double kWorkspaceMargin = 0.05;

/// What was left out, in voxels.
struct ReachSaving {
  std::size_t outsideRegion = 0;  ///< Felt voxels.
  std::size_t cavities = 0, cavityVoxels = 0;
  std::size_t cavitiesFilled = 0, filledVoxels = 0;  ///< Of those.
  std::size_t outsideDevice = 0;                     ///< Felt voxels.
};

/// Why less was left out than the scene asks for.
enum class ReachLimit : std::uint8_t {
  None,
  CutDescent,   ///< stop_level or perceptual_mm: contacts depend on the shape of the whole tree.
  NoWorkspace,  ///< The device's workspace is not known.
  LooseBodies   ///< They go where the device does not.
};

/// The grid with what is outside of the scene's region as background; the same grid where the scene
/// has none. Counts what of `felt` is gone.
[[nodiscard]] std::shared_ptr<const LabelGrid> withinRegion(std::shared_ptr<const LabelGrid> grid,
                                                            const std::optional<SceneBox>& region,
                                                            const FeltLabels& felt,
                                                            ReachSaving& saving);

struct ReachableAnatomy {
  std::shared_ptr<const LabelGrid> labels;  ///< For the tree: the grid given where all is kept.
  ReachSaving saving;
  ReachLimit limit = ReachLimit::None;
};

/// @param grid     within the region, which `saving` tells of.
/// @param anatomy  what stands still; `moves`: the labels of loose bodies.
[[nodiscard]] ReachableAnatomy reachableAnatomy(const Scene& scene,
                                                std::shared_ptr<const LabelGrid> grid,
                                                const FeltLabels& anatomy, const FeltLabels& moves,
                                                const PointShell& shell,
                                                const Eigen::Isometry3d& X_WD, ReachSaving saving);

}  // namespace palpate
