#pragma once
/// What the four views share: the crosshair, window and level, what is shown. Kept by the window,
/// not by the case.

#include <Eigen/Core>
#include <array>
#include <optional>

#include "imaging/segmentation.h"
#include "imaging/volume.h"
#include "ui/camera.h"
#include "ui/layout.h"

namespace palpate::ui {

struct SliceState {
  double zoom = 1.0;
  Eigen::Vector2d pan{0, 0};  ///< Pixels.
};

struct ViewState {
  Camera camera;
  Eigen::Vector3d crosshair_P =
      Eigen::Vector3d::Zero();                  ///< Metres; every slice passes through it.
  std::array<double, 2> window{400.0, 2000.0};  ///< Level (centre), width.
  std::array<SliceState, kViews> slice;         ///< [0] unused.
  std::optional<View> filled;
  bool volumeRendering = false;
  bool interpolate = true;
  bool followTool = true;  ///< Slices pass through the instrument's tip while it is held.
  float labelOpacity = 0.28F;
  float edgeOpacity = 0.0F;  ///< Of the labels' outlines in the slices.
  std::optional<ThresholdRange> preview;
};

/// Level and width to start with: bone and soft tissue for CT, 1st to 99th percentile otherwise.
[[nodiscard]] std::array<double, 2> startingWindow(const Volume& volume);
/// Camera on all of the volume, crosshair in its middle.
void resetViews(ViewState& state, const GridGeometry& grid, const std::array<double, 2>& window,
                double sceneAspect);

}  // namespace palpate::ui
