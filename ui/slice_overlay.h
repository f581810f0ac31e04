#pragma once
/// What lies over a slice: letters, scale bar, numbers, crosshair, instrument, contacts.

#include <imgui.h>

#include "core/simulation/snapshot.h"
#include "ui/slice_geometry.h"
#include "ui/slice_view.h"
#include "ui/theme.h"
#include "ui/view_state.h"

namespace palpate::ui {

struct SliceOverlay {
  ImDrawList* list = nullptr;
  Rect area;
  const GridGeometry& grid;
  const SlicePlane& plane;
  const SliceFit& fit;
  double slice = 0;  ///< Continuous voxel index along plane.through.
  const Theme& theme;
  ImFont* font = nullptr;
  float scale = 1.0F;
};

void drawCorners(const SliceOverlay& over, View view, const ViewState& state);
void drawCrosshair(const SliceOverlay& over, const Eigen::Vector3d& crosshair_P);
void drawInstrumentOutline(const SliceOverlay& over, const PlacedMesh& tool);
/// Contacts within a slice thickness, as dots coloured by depth.
void drawSliceContacts(const SliceOverlay& over, const Snapshot& snapshot);

}  // namespace palpate::ui
