#pragma once
/// Tools in the views: what the left mouse button picks, paints and draws, and how that shows.
///
/// Main thread, within the frame, right after the view's own button (ImGui's last item).

#include <vector>

#include "core/voxels/label_grid.h"
#include "imaging/segment/tools.h"
#include "ui/camera.h"
#include "ui/segment_state.h"
#include "ui/slice_overlay.h"
#include "ui/widgets.h"

namespace palpate::ui {

/// A slice under the mouse.
struct SliceMouse {
  /// As they are, not as a preview shows them, for steps start from these. Null: nothing is
  /// labelled. `label`: the value that the tools work on, 0: none.
  const LabelGrid* labels = nullptr;
  std::uint8_t label = 0;
  View view = View::Axial;
  const Rect& area;
  const GridGeometry& grid;
  const SlicePlane& plane;
  const SliceFit& fit;
  double slice = 0;  ///< Continuous voxel index along plane.through.
};

/// True where the chosen tool took the left button: the crosshair stays where it is. Finished
/// strokes and outlines become act::ApplyStep.
bool editInSlice(SegmentPanelState& state, const SliceMouse& at, Actions& actions);
/// Picks, the box, the stroke or outline being drawn, and the brush under the mouse.
void drawEditInSlice(const SegmentPanelState& state, const SliceOverlay& over, View view);

/// What can be picked in the 3D view.
struct ScenePicks {
  const LabelGrid* seen = nullptr;    ///< As drawn, a preview too; null: nothing.
  const LabelGrid* labels = nullptr;  ///< As they are (SliceMouse::labels).
  std::uint8_t label = 0;             ///< That the tools work on, 0: none.
  std::vector<std::uint8_t> hidden;   ///< Labels that are not drawn.
};
/// As editInSlice(), for the 3D view.
bool editInScene(SegmentPanelState& state, const Camera& camera, const Rect& area,
                 const ScenePicks& picks, Actions& actions);
void drawEditInScene(const SegmentPanelState& state, const Camera& camera, const Rect& area,
                     const ScenePicks& picks, const Theme& theme, float scale);

/// From P, mm, to (u w, v w, w) of the 3D view, where u and v are tangents of the angle to the
/// right and upwards (tool::Scissors::view).
[[nodiscard]] Eigen::Matrix<double, 3, 4> sceneView(const Camera& camera);
/// (u, v) of a point of the view, framebuffer pixels.
[[nodiscard]] Eigen::Vector2d sceneAngles(const Camera& camera, const Rect& area,
                                          const Eigen::Vector2d& pixel);
/// Centre, P mm, of the first labelled voxel on a ray from the eye; nothing where it meets none.
[[nodiscard]] std::optional<Eigen::Vector3d> firstLabelled(const LabelGrid& labels,
                                                           const std::vector<std::uint8_t>& hidden,
                                                           const Eigen::Vector3d& eye_mm,
                                                           const Eigen::Vector3d& direction_P);

/// Of a pick: of the part it is a seed of, else the accent of picks.
[[nodiscard]] ImU32 pickColour(const SegmentPanelState& state, std::size_t part);

}  // namespace palpate::ui
