#include "ui/slice_view.h"

#include <algorithm>
#include <cmath>

#include <imgui.h>

#include <imgui_internal.h>  // after imgui.h: items that lie over others

#include "core/geometry/units.h"
#include "ui/slice_overlay.h"

namespace palpate::ui {
namespace {

Eigen::Vector3f voxelStep(const GridGeometry& grid, int axis, bool flipped, double pixelsPerMm) {
  Eigen::Vector3f step = Eigen::Vector3f::Zero();
  step[axis] =
      static_cast<float>((flipped ? -1.0 : 1.0) / (millimetres(grid.spacing[axis]) * pixelsPerMm));
  return step;
}

}  // namespace

std::vector<std::array<Eigen::Vector3d, 2>> crossSection(const PlacedMesh& mesh,
                                                         const GridGeometry& grid, int axis,
                                                         double slice) {
  std::vector<std::array<Eigen::Vector3d, 2>> segments;
  std::vector<Eigen::Vector3d> voxel;
  voxel.reserve(mesh.vertices_T->size());
  for (const auto& p : *mesh.vertices_T) voxel.push_back(voxelOf(grid, mesh.X_PT * p));
  for (const auto& t : *mesh.triangles) {
    std::array<Eigen::Vector3d, 2> cut;
    std::size_t found = 0;
    for (std::size_t e = 0; e < 3 && found < 2; ++e) {
      const Eigen::Vector3d& a = voxel[t[e]];
      const Eigen::Vector3d& b = voxel[t[(e + 1) % 3]];
      const double da = a[axis] - slice;
      const double db = b[axis] - slice;
      // Half-open, so that a vertex on the plane counts for one of its two edges.
      if ((da < 0.0) == (db < 0.0)) continue;
      cut[found++] = a + (b - a) * (da / (da - db));
    }
    if (found == 2) segments.push_back(cut);
  }
  return segments;
}

void SliceView::render(const Inputs& inputs, const VolumeTextures& textures,
                       const GlProgram& program, const SlicePlane& plane, const SliceFit& fit,
                       const Theme& theme) {
  picture_.resize(inputs.width, inputs.height);
  picture_.bind();
  program.use();
  textures.bindVolume(program, 0, inputs.interpolate);
  textures.bindLabels(program, 1, 2);
  const auto level = static_cast<float>(inputs.window[0]);
  const auto half = static_cast<float>(0.5 * inputs.window[1]);
  program.set("windowRange", Eigen::Vector2f(level - half, level + half));
  program.set("preview", Eigen::Vector2f(static_cast<float>(inputs.preview[0]),
                                         static_cast<float>(inputs.preview[1])));
  program.set("previewColour", Eigen::Vector3f(theme.accent.x, theme.accent.y, theme.accent.z));
  program.set("labelOpacity", inputs.opacity);
  program.set("edgeOpacity", inputs.edge);
  program.set("viewSize",
              Eigen::Vector2f(static_cast<float>(inputs.width), static_cast<float>(inputs.height)));
  const GridGeometry& grid = textures.grid();
  program.set("voxelOrigin",
              Eigen::Vector3f(
                  fit.toVoxel(grid, plane, Eigen::Vector2d::Zero(), inputs.slice).cast<float>()));
  program.set("voxelRight", voxelStep(grid, plane.right, plane.rightFlipped, fit.pixelsPerMm));
  program.set("voxelDown", voxelStep(grid, plane.down, plane.downFlipped, fit.pixelsPerMm));
  drawFullScreen();
  ++rendered_;
}

bool SliceView::interact(const Rect& area, const VolumeTextures& textures, ViewState& state,
                         const SlicePlane& plane, const SliceFit& fit, bool taken, float scale) {
  const GridGeometry& grid = textures.grid();
  ImGuiIO& io = ImGui::GetIO();
  SliceState& own = state.slice[static_cast<std::size_t>(view_)];
  const Eigen::Vector2d mouse(static_cast<double>(io.MousePos.x - area.x),
                              static_cast<double>(io.MousePos.y - area.y));
  const double slice = voxelOf(grid, state.crosshair_P)[plane.through];
  if (ImGui::IsItemHovered()) {
    if (!taken && ImGui::IsMouseDoubleClicked(0)) return true;
    if (io.MouseWheel != 0.0F && io.KeyCtrl) {
      // What is under the mouse stays there; the whole slice lies in the middle again.
      const double before = own.zoom;
      own.zoom =
          std::clamp(own.zoom * std::pow(1.15, static_cast<double>(io.MouseWheel)), 0.5, 20.0);
      own.pan += (mouse - fit.centre) * (1.0 - own.zoom / before);
      if (own.zoom <= 1.0) own.pan.setZero();
    } else if (io.MouseWheel != 0.0F) {
      const double last = grid.dims[static_cast<std::size_t>(plane.through)] - 1;
      Eigen::Vector3d v = voxelOf(grid, state.crosshair_P);
      const double steps = static_cast<double>(io.MouseWheel > 0 ? std::ceil(io.MouseWheel)
                                                                 : std::floor(io.MouseWheel));
      v[plane.through] = std::clamp(std::round(slice) + steps, 0.0, last);
      state.crosshair_P = pointOf(grid, v);
    }
  }
  if (!ImGui::IsItemActive()) return false;
  if (ImGui::IsMouseDown(0) && !taken) {
    Eigen::Vector3d v = fit.toVoxel(grid, plane, mouse, slice);
    for (int a = 0; a < 3; ++a) {
      v[a] = std::clamp(v[a], 0.0, static_cast<double>(grid.dims[static_cast<std::size_t>(a)] - 1));
    }
    state.crosshair_P = pointOf(grid, v);
  } else if (ImGui::IsMouseDown(1)) {
    // A tenth of a view's width doubles nothing: the step follows the width, so that CT and MR
    // answer alike.
    const double step = state.window[1] / (350.0 * static_cast<double>(scale));
    state.window[1] = std::max(1e-3, state.window[1] + static_cast<double>(io.MouseDelta.x) * step);
    state.window[0] += static_cast<double>(io.MouseDelta.y) * step;
  } else if (ImGui::IsMouseDown(2)) {
    own.pan +=
        Eigen::Vector2d(static_cast<double>(io.MouseDelta.x), static_cast<double>(io.MouseDelta.y));
  }
  return false;
}

bool SliceView::draw(const Rect& area, const VolumeTextures& textures, const GlProgram& program,
                     ViewState& state, const PlacedMesh& tool, const Snapshot* snapshot,
                     const SliceTool& edit, const Theme& theme, ImFont* small, float scale) {
  if (area.w < 1.0F || area.h < 1.0F) return false;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 low(area.x, area.y);
  const ImVec2 high(area.right(), area.bottom());
  list->AddRectFilled(low, high, IM_COL32(0, 0, 0, 255));
  if (!textures.loaded()) return false;

  ImGui::SetCursorScreenPos(low);
  ImGui::PushID(static_cast<int>(view_));
  // Under the button that enlarges it: what is pressed there does not reach the tools.
  ImGui::InvisibleButton("slice", {area.w, area.h},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle |
                             static_cast<int>(ImGuiButtonFlags_AllowItemOverlap));
  ImGui::SetItemAllowOverlap();
  ImGui::PopID();
  const GridGeometry& grid = textures.grid();
  const SlicePlane plane = slicePlane(grid, view_);
  const SliceState& own = state.slice[static_cast<std::size_t>(view_)];
  const auto fitNow = [&] {
    return fitSlice(grid, plane, static_cast<double>(area.w), static_cast<double>(area.h), own.zoom,
                    own.pan);
  };
  SliceFit fit = fitNow();
  const auto sliceNow = [&] {
    // Whole slices: between two the scanner measured nothing.
    return std::clamp(std::round(voxelOf(grid, state.crosshair_P)[plane.through]), 0.0,
                      static_cast<double>(grid.dims[static_cast<std::size_t>(plane.through)] - 1));
  };
  const bool taken = edit.takes && edit.takes(area, plane, fit, sliceNow());
  const bool doubled = interact(area, textures, state, plane, fit, taken, scale);
  fit = fitNow();

  Inputs inputs;
  inputs.textures = textures.version();
  inputs.width = static_cast<int>(area.w);
  inputs.height = static_cast<int>(area.h);
  inputs.slice = sliceNow();
  inputs.zoom = own.zoom;
  inputs.pan = own.pan;
  inputs.window = state.window;
  if (state.preview) inputs.preview = {state.preview->low, state.preview->high};
  inputs.opacity = state.labelOpacity;
  inputs.edge = state.edgeOpacity;
  inputs.interpolate = state.interpolate;
  if (!(inputs == last_) || rendered_ == 0) {
    render(inputs, textures, program, plane, fit, theme);
    last_ = inputs;
  }
  list->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(picture_.colour())), low,
                 high);
  list->PushClipRect(low, high, true);
  const SliceOverlay over{list, area, grid, plane, fit, inputs.slice, theme, small, scale};
  drawCrosshair(over, state.crosshair_P);
  drawInstrumentOutline(over, tool);
  if (snapshot != nullptr) drawSliceContacts(over, *snapshot);
  if (edit.draws) edit.draws(over);
  drawCorners(over, view_, state);
  list->PopClipRect();
  return doubled;
}

}  // namespace palpate::ui
