#pragma once
/// What lies over the 3D view, and what the mouse does there.

#include <imgui.h>

#include "ui/actions.h"
#include "ui/camera.h"
#include "ui/layout.h"
#include "ui/theme.h"

namespace palpate::ui {

/// A small cube of axes with R/L, A/P and H/F at their ends, turned with the camera; letters that
/// point away are fainter.
void drawOrientationCube(ImDrawList& list, const Camera& camera, ImVec2 centre, float radius,
                         const Theme& theme, ImFont* font);

/// World motion (m) of the hand for a motion of the mouse in the view, and into the view.
[[nodiscard]] Eigen::Vector3d handMotion(const Camera& camera, double dxPixels, double dyPixels,
                                         double towardsScene_mm, double viewHeight);

/// Reads the mouse over the view's own button (the last item). `holding`: the mouse moves the hand
/// instead of the camera (a left drag
/// still turns the camera, a right drag the instrument). True when it was double-clicked.
bool interactWithScene(Camera& camera, const Rect& area, bool holding, Actions& actions);

}  // namespace palpate::ui
