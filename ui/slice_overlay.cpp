#include "ui/slice_overlay.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/geometry/units.h"
#include "ui/colours.h"
#include "ui/format.h"

namespace palpate::ui {
namespace {

ImVec2 onScreen(const SliceOverlay& over, const Eigen::Vector3d& voxel) {
  const Eigen::Vector2d s = over.fit.toScreen(over.grid, over.plane, voxel);
  return {over.area.x + static_cast<float>(s.x()), over.area.y + static_cast<float>(s.y())};
}

/// Text with a dark edge, readable on any grey.
void shadowed(const SliceOverlay& over, ImVec2 at, ImU32 colour, const std::string& text) {
  const ImU32 dark = IM_COL32(0, 0, 0, 200);
  const float size = over.font->FontSize;
  for (const ImVec2 d : {ImVec2(1, 0), ImVec2(-1, 0), ImVec2(0, 1), ImVec2(0, -1)}) {
    over.list->AddText(over.font, size, {at.x + d.x, at.y + d.y}, dark, text.c_str());
  }
  over.list->AddText(over.font, size, at, colour, text.c_str());
}

ImVec2 sizeOf(const SliceOverlay& over, const std::string& text) {
  return over.font->CalcTextSizeA(over.font->FontSize, 1e6F, 0.0F, text.c_str());
}

const char* nameOf(View view) {
  return view == View::Axial ? "Axial" : view == View::Coronal ? "Coronal" : "Sagittal";
}

void drawScaleBar(const SliceOverlay& over, float inset, ImU32 colour) {
  const double mm = scaleBarLength_mm(over.fit.pixelsPerMm, static_cast<double>(over.area.w));
  const auto length = static_cast<float>(mm * over.fit.pixelsPerMm);
  const float y = over.area.bottom() - inset;
  const float x1 = over.area.right() - inset;
  const float x0 = x1 - length;
  const float tick = 4.0F * over.scale;
  for (const auto& [c, w] : {std::pair{IM_COL32(0, 0, 0, 160), 3.0F * over.scale},
                             std::pair{colour, std::max(1.0F, std::round(1.2F * over.scale))}}) {
    over.list->AddLine({x0, y}, {x1, y}, c, w);
    over.list->AddLine({x0, y - tick}, {x0, y + 1}, c, w);
    over.list->AddLine({x1, y - tick}, {x1, y + 1}, c, w);
  }
  char text[32];
  std::snprintf(text, sizeof text, mm >= 10.0 ? "%.0f mm" : "%.3g mm", mm);
  const ImVec2 size = sizeOf(over, text);
  shadowed(over, {x1 - size.x, y - tick - size.y - 1.0F}, colour, text);
}

}  // namespace

void drawCorners(const SliceOverlay& over, View view, const ViewState& state) {
  const float inset = 8.0F * over.scale;
  const ImU32 bright = IM_COL32(235, 238, 242, 255);
  const ImU32 soft = IM_COL32(168, 178, 192, 255);
  const Rect& a = over.area;
  const ImVec2 line = sizeOf(over, "Axial");

  shadowed(over, {a.x + inset, a.y + inset * 0.75F}, soft, nameOf(view));
  const Eigen::Vector3d middle =
      0.5 * Eigen::Vector3d(over.grid.dims[0] - 1, over.grid.dims[1] - 1, over.grid.dims[2] - 1);
  Eigen::Vector3d onSlice = middle;
  onSlice[over.plane.through] = over.slice;
  // The slice's place along the patient axis that it cuts, through the volume's middle.
  const int axis = view == View::Axial ? 2 : view == View::Coronal ? 1 : 0;
  const double at = millimetres(pointOf(over.grid, onSlice)[axis]);
  const char* letters = axis == 2 ? "HF" : axis == 1 ? "PA" : "LR";
  char place[64];
  std::snprintf(place, sizeof place, "%c %.1f mm", at >= 0 ? letters[0] : letters[1], std::abs(at));
  const std::string number =
      std::to_string(std::lround(over.slice) + 1) + " / " +
      std::to_string(over.grid.dims[static_cast<std::size_t>(over.plane.through)]);
  const ImVec2 size = sizeOf(over, number);
  shadowed(over, {a.right() - inset - size.x, a.y + inset * 0.75F}, soft, number);
  char window[64];
  std::snprintf(window, sizeof window, "W %.0f  L %.0f", state.window[1], state.window[0]);
  shadowed(over, {a.x + inset, a.bottom() - inset * 0.5F - line.y}, soft, window);
  shadowed(over, {a.x + inset, a.bottom() - inset * 0.5F - 2.1F * line.y}, soft, place);
  drawScaleBar(over, inset, soft);

  const auto letter = edgeLetters(over.grid, over.plane);
  const auto centred = [&](float x, float y, const std::string& text) {
    const ImVec2 s = sizeOf(over, text);
    shadowed(over, {std::round(x - 0.5F * s.x), std::round(y - 0.5F * s.y)}, bright, text);
  };
  const float cx = a.x + 0.5F * a.w;
  const float cy = a.y + 0.5F * a.h;
  const float edge = inset + 0.5F * line.y;
  centred(a.x + inset + 0.5F * sizeOf(over, letter[0]).x, cy, letter[0]);
  centred(a.right() - inset - 0.5F * sizeOf(over, letter[1]).x, cy, letter[1]);
  centred(cx, a.y + edge, letter[2]);
  centred(cx, a.bottom() - edge, letter[3]);
}

void drawCrosshair(const SliceOverlay& over, const Eigen::Vector3d& crosshair_P) {
  const ImVec2 c = onScreen(over, voxelOf(over.grid, crosshair_P));
  const ImU32 colour = packed(over.theme.accent, 0.55F);
  const float gap = 9.0F * over.scale;
  const float w = std::max(1.0F, std::round(over.scale));
  const float x = std::round(c.x) + 0.5F;
  const float y = std::round(c.y) + 0.5F;
  over.list->AddLine({over.area.x, y}, {x - gap, y}, colour, w);
  over.list->AddLine({x + gap, y}, {over.area.right(), y}, colour, w);
  over.list->AddLine({x, over.area.y}, {x, y - gap}, colour, w);
  over.list->AddLine({x, y + gap}, {x, over.area.bottom()}, colour, w);
}

void drawInstrumentOutline(const SliceOverlay& over, const PlacedMesh& tool) {
  if (tool.vertices_T == nullptr) return;
  const ImU32 dark = IM_COL32(0, 0, 0, 170);
  const ImU32 colour = packed(over.theme.accent);
  const auto segments = crossSection(tool, over.grid, over.plane.through, over.slice);
  for (const auto& [c, w] : {std::pair{dark, 3.5F}, std::pair{colour, 1.6F}}) {
    for (const auto& s : segments) {
      over.list->AddLine(onScreen(over, s[0]), onScreen(over, s[1]), c, w * over.scale);
    }
  }
  // The tip, also where the slice does not cut the instrument: hollow when it is off the slice.
  const Eigen::Vector3d tip = voxelOf(over.grid, tool.X_PT.translation());
  const double off_mm = std::abs(tip[over.plane.through] - over.slice) *
                        millimetres(over.grid.spacing[over.plane.through]);
  const ImVec2 at = onScreen(over, tip);
  const float r = 4.0F * over.scale;
  if (off_mm < 2.0) {
    over.list->AddCircleFilled(at, 2.5F * over.scale, colour, 16);
  } else {
    const float fade = static_cast<float>(std::clamp(1.0 - off_mm / 40.0, 0.25, 1.0));
    over.list->AddCircle(at, r, packed(over.theme.accent, fade), 20, 1.4F * over.scale);
  }
}

void drawSliceContacts(const SliceOverlay& over, const Snapshot& snapshot) {
  const double half = std::max(0.75e-3, 0.5 * over.grid.spacing[over.plane.through]);
  for (std::uint32_t i = 0; i < snapshot.contactsDrawn; ++i) {
    const Contact& contact = snapshot.contact_W[i];
    const Eigen::Vector3d v =
        voxelOf(over.grid, Eigen::Vector3d(contact.p[0], contact.p[1], contact.p[2]));
    const double off = (v[over.plane.through] - over.slice) * over.grid.spacing[over.plane.through];
    if (std::abs(off) > half) continue;
    const Rgb c = contactColour(contact.depth);
    over.list->AddCircleFilled(onScreen(over, v), 2.2F * over.scale,
                               ImGui::ColorConvertFloat4ToU32({c[0], c[1], c[2], 1.0F}), 10);
  }
}

}  // namespace palpate::ui
