#include "ui/view_edit.h"

#include <algorithm>
#include <cmath>

#include "imaging/segment/nearest_label.h"
#include "ui/colours.h"

namespace palpate::ui {
namespace {

constexpr float kClickPixels = 4.0F;    // a press that moves less is a click
constexpr double kOutlinePixels = 3.0;  // between corners of an outline

Eigen::Vector2d mousePixel() {
  const ImVec2 p = ImGui::GetIO().MousePos;
  return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

Eigen::Vector3d clamped(const GridGeometry& grid, Eigen::Vector3d voxel) {
  for (int a = 0; a < 3; ++a) {
    const double last = grid.dims[static_cast<std::size_t>(a)] - 1;
    voxel[a] = std::clamp(voxel[a], 0.0, last);
  }
  return voxel;
}

/// P mm of the voxel under the mouse; `centre`: of its centre.
Eigen::Vector3d pointUnder(const SliceMouse& at, bool centre) {
  const Eigen::Vector2d local = mousePixel() - Eigen::Vector2d(static_cast<double>(at.area.x),
                                                               static_cast<double>(at.area.y));
  Eigen::Vector3d voxel = clamped(at.grid, at.fit.toVoxel(at.grid, at.plane, local, at.slice));
  if (centre) voxel = voxel.array().round();
  return pointOf(at.grid, voxel) * 1e3;
}

/// Row `axis` of the map from P, mm, to continuous voxel indices.
Eigen::RowVector4d voxelRow(const GridGeometry& grid, int axis) {
  const Eigen::Matrix3d R_VP = grid.X_PV.linear().transpose();
  Eigen::RowVector4d row;
  const double perMm = 1e-3 / grid.spacing[axis];
  row.head<3>() = R_VP.row(axis) * perMm;
  row[3] = -R_VP.row(axis).dot(grid.X_PV.translation()) / grid.spacing[axis];
  return row;
}

/// Escape was pressed with the button down: until it is let go, it neither draws nor turns.
bool stillAbandoned(SegmentPanelState& state) {
  if (!ImGui::IsMouseDown(0)) state.abandoned = false;
  return state.abandoned;
}

void addCorner(std::vector<Eigen::Vector2d>& outline) {
  const Eigen::Vector2d p = mousePixel();
  if (outline.empty() || (p - outline.back()).norm() >= kOutlinePixels) outline.push_back(p);
}

tool::Scissors scissorsInSlice(const SegmentPanelState& state, const SliceMouse& at) {
  tool::Scissors tool;
  tool.view.row(0) = voxelRow(at.grid, at.plane.right);
  tool.view.row(1) = voxelRow(at.grid, at.plane.down);
  tool.view.row(2) = Eigen::RowVector4d(0, 0, 0, 1);
  const Eigen::Vector2d corner(static_cast<double>(at.area.x), static_cast<double>(at.area.y));
  for (const Eigen::Vector2d& p : state.outline) {
    const Eigen::Vector3d voxel = at.fit.toVoxel(at.grid, at.plane, p - corner, at.slice);
    tool.outline.emplace_back(voxel[at.plane.right], voxel[at.plane.down]);
  }
  tool.keepInside = state.keepInside;
  if (!state.throughAll) {
    const double spacing = at.grid.spacing[at.plane.through] * 1e3;
    Eigen::RowVector4d row = voxelRow(at.grid, at.plane.through);
    row[3] -= at.slice;
    tool.plane_mm = (row * spacing).transpose();
    tool.depth_mm = 0.499 * spacing;
  }
  return tool;
}

/// Grow takes any voxel; the others mean a part of the label, which a hand may miss by a little.
void pick(SegmentPanelState& state, const Eigen::Vector3d& under, const LabelGrid* labels,
          std::uint8_t label) {
  constexpr double kMissed_mm = 4.0;
  if (state.kind == ToolKind::Grow) {
    state.picks.push_back({under, state.part});
    return;
  }
  const auto on = labels != nullptr ? nearestOf(*labels, label, under, kMissed_mm) : std::nullopt;
  state.missed = !on.has_value();
  if (on) state.picks.push_back({*on, state.part});
}

void apply(SegmentPanelState& state, LabelTool tool, Actions& actions) {
  LabelStep step = bareStep(state);
  step.tool = std::move(tool);
  if (!step.label.empty()) actions.push_back(act::ApplyStep{std::move(step)});
}

void finishStroke(SegmentPanelState& state, const SliceMouse& at, Actions& actions) {
  tool::Brush tool;
  tool.path_mm = state.stroke_mm;
  tool.radius_mm = 0.5 * static_cast<double>(state.brushMm);
  if (!state.sphere) tool.normal = at.grid.X_PV.linear().col(at.plane.through);
  tool.erase = state.kind == ToolKind::Eraser;
  apply(state, std::move(tool), actions);
}

void finish(SegmentPanelState& state, const SliceMouse& at, Gesture gesture, Actions& actions) {
  if (gesture == Gesture::Stroke && !state.stroke_mm.empty()) finishStroke(state, at, actions);
  if (gesture == Gesture::Outline && state.outline.size() >= 3) {
    apply(state, scissorsInSlice(state, at), actions);
  }
  const bool clicked = ImGui::GetIO().MouseDragMaxDistanceSqr[0] < kClickPixels * kClickPixels;
  if (gesture == Gesture::Rectangle && clicked) state.box_mm = state.boxBefore;
  state.stroke_mm.clear();
  state.outline.clear();
  state.drawingIn.reset();
}

/// The patient's axis that a slice cuts: the box lies along these.
int throughAxis(const SliceMouse& at) {
  int through = 0;
  at.grid.X_PV.linear().col(at.plane.through).cwiseAbs().maxCoeff(&through);
  return through;
}

using BoxGrip = SegmentPanelState::BoxGrip;

/// The sides under the mouse; nothing where a new box would begin.
std::optional<std::array<BoxGrip, 3>> gripUnder(const SegmentPanelState& state,
                                                const SliceMouse& at) {
  constexpr double kReach = 6.0;  // pixels
  if (!state.box_mm) return {};
  const Eigen::Vector3d p = pointUnder(at, false);
  const double reach_mm = kReach / at.fit.pixelsPerMm;
  const auto& [first, second] = *state.box_mm;
  const int through = throughAxis(at);
  std::array<BoxGrip, 3> grip{BoxGrip::None, BoxGrip::None, BoxGrip::None};
  bool any = false;
  for (int a = 0; a < 3; ++a) {
    if (a == through) continue;
    if (p[a] < std::min(first[a], second[a]) - reach_mm) return {};
    if (p[a] > std::max(first[a], second[a]) + reach_mm) return {};
    const double toFirst = std::abs(p[a] - first[a]), toSecond = std::abs(p[a] - second[a]);
    if (std::min(toFirst, toSecond) > reach_mm) continue;
    grip[static_cast<std::size_t>(a)] = toFirst < toSecond ? BoxGrip::First : BoxGrip::Second;
    any = true;
  }
  if (!any) return {};
  return grip;
}

/// The sides that are held; or a new box's two corners along the slice's axes: along the third it
/// keeps, or spans the scan.
void dragBox(SegmentPanelState& state, const SliceMouse& at, bool begins) {
  const Eigen::Vector3d p = pointUnder(at, false);
  if (begins) {
    constexpr std::array<BoxGrip, 3> kNew{BoxGrip::Both, BoxGrip::Both, BoxGrip::Both};
    state.boxGrip = gripUnder(state, at).value_or(kNew);
  }
  if (!state.box_mm) {
    Eigen::Vector3d last;
    for (int a = 0; a < 3; ++a) last[a] = at.grid.dims[static_cast<std::size_t>(a)] - 1;
    state.box_mm = {pointOf(at.grid, Eigen::Vector3d::Constant(-0.5)) * 1e3,
                    pointOf(at.grid, last + Eigen::Vector3d::Constant(0.5)) * 1e3};
  }
  const int through = throughAxis(at);
  for (int a = 0; a < 3; ++a) {
    const BoxGrip grip = state.boxGrip[static_cast<std::size_t>(a)];
    if (a == through || grip == BoxGrip::None) continue;
    if (grip == BoxGrip::First || (grip == BoxGrip::Both && begins)) (*state.box_mm)[0][a] = p[a];
    if (grip != BoxGrip::First) (*state.box_mm)[1][a] = p[a];
  }
}

}  // namespace

bool editInSlice(SegmentPanelState& state, const SliceMouse& at, Actions& actions) {
  const Gesture gesture = gestureOf(state);
  if (gesture == Gesture::None) return false;
  if (stillAbandoned(state)) return true;
  const bool mine = state.drawingIn == at.view;
  if (mine && !ImGui::IsMouseDown(0)) {
    finish(state, at, gesture, actions);
    return true;
  }
  if (gesture == Gesture::Rectangle && ImGui::IsItemHovered() && gripUnder(state, at)) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeAll);
  }
  const bool pressed = ImGui::IsItemActivated() && ImGui::IsMouseDown(0);
  if (pressed && gesture == Gesture::Pick) {
    pick(state, pointUnder(at, true), at.labels, at.label);
    return true;
  }
  if (pressed) {
    state.drawingIn = at.view;
    state.boxBefore = state.box_mm;
  }
  if (!pressed && !mine) return ImGui::IsItemActive() && ImGui::IsMouseDown(0);
  if (gesture == Gesture::Rectangle) {
    dragBox(state, at, pressed);
  } else if (gesture == Gesture::Outline) {
    addCorner(state.outline);
  } else {
    const Eigen::Vector3d p = pointUnder(at, false);
    const double apart = std::max(0.2, 0.1 * static_cast<double>(state.brushMm));
    if (state.stroke_mm.empty() || (p - state.stroke_mm.back()).norm() >= apart) {
      state.stroke_mm.push_back(p);
    }
  }
  return true;
}

namespace {

/// What the overlays of a slice draw with.
struct SlicePen {
  const SliceOverlay& over;

  [[nodiscard]] ImVec2 at(const Eigen::Vector3d& p_mm) const {
    const Eigen::Vector2d p =
        over.fit.toScreen(over.grid, over.plane, voxelOf(over.grid, p_mm * 1e-3));
    return {over.area.x + static_cast<float>(p.x()), over.area.y + static_cast<float>(p.y())};
  }
  /// Voxels from the slice that is shown.
  [[nodiscard]] double off(const Eigen::Vector3d& p_mm) const {
    return voxelOf(over.grid, p_mm * 1e-3)[over.plane.through] - over.slice;
  }
};

void drawPick(const SlicePen& pen, const SegmentPanelState& state,
              const SegmentPanelState::Pick& pick) {
  const double off = std::abs(pen.off(pick.at_mm));
  if (off > 6.0) return;
  const float alpha = off < 0.6 ? 1.0F : 0.35F;
  const ImVec2 p = pen.at(pick.at_mm);
  const float r = 4.5F * pen.over.scale;
  const ImU32 colour = pickColour(state, pick.part);
  const ImU32 faded = (colour & 0x00ffffffU) | (static_cast<ImU32>(alpha * 255.0F) << 24U);
  pen.over.list->AddCircleFilled(p, r, faded, 20);
  pen.over.list->AddCircle(p, r + 1.0F, IM_COL32(0, 0, 0, static_cast<int>(200 * alpha)), 20,
                           1.5F * pen.over.scale);
}

void drawBox(const SlicePen& pen, const SegmentPanelState& state) {
  if (!state.box_mm) return;
  const ImVec2 a = pen.at((*state.box_mm)[0]), b = pen.at((*state.box_mm)[1]);
  const ImVec2 low(std::min(a.x, b.x), std::min(a.y, b.y));
  const ImVec2 high(std::max(a.x, b.x), std::max(a.y, b.y));
  pen.over.list->AddRectFilled(low, high, packed(pen.over.theme.accent, 0.12F));
  pen.over.list->AddRect(low, high, packed(pen.over.theme.accent), 0.0F, 0, 1.5F * pen.over.scale);
}

void drawBrush(const SlicePen& pen, const SegmentPanelState& state, View view) {
  const auto pixels = static_cast<float>(pen.over.fit.pixelsPerMm) * 0.5F * state.brushMm;
  const bool erase = state.kind == ToolKind::Eraser;
  const ImVec4& tint = erase ? pen.over.theme.attention : pen.over.theme.accent;
  if (state.drawingIn == view) {
    for (std::size_t i = 0; i < state.stroke_mm.size(); ++i) {
      const ImVec2 p = pen.at(state.stroke_mm[i]);
      pen.over.list->AddCircleFilled(p, pixels, packed(tint, 0.45F));
      if (i > 0) {
        pen.over.list->AddLine(pen.at(state.stroke_mm[i - 1]), p, packed(tint, 0.45F),
                               2.0F * pixels);
      }
    }
  }
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (pen.over.area.contains(mouse.x, mouse.y)) {
    pen.over.list->AddCircle(mouse, pixels, packed(tint), 48, 1.5F * pen.over.scale);
  }
}

void drawOutline(ImDrawList& list, const std::vector<Eigen::Vector2d>& outline, const Theme& theme,
                 float scale) {
  if (outline.size() < 2) return;
  std::vector<ImVec2> corners;
  for (const Eigen::Vector2d& p : outline) {
    corners.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  list.AddPolyline(corners.data(), static_cast<int>(corners.size()), packed(theme.attention),
                   ImDrawFlags_Closed, 2.0F * scale);
}

}  // namespace

void drawEditInSlice(const SegmentPanelState& state, const SliceOverlay& over, View view) {
  const SlicePen pen{over};
  const Gesture gesture = gestureOf(state);
  if (gesture == Gesture::Pick) {
    for (const auto& pick : state.picks) drawPick(pen, state, pick);
  }
  if (gesture == Gesture::Rectangle) drawBox(pen, state);
  if (gesture == Gesture::Stroke) drawBrush(pen, state, view);
  if (gesture == Gesture::Outline && state.drawingIn == view) {
    drawOutline(*over.list, state.outline, over.theme, over.scale);
  }
}

Eigen::Matrix<double, 3, 4> sceneView(const Camera& camera) {
  Eigen::Matrix3d R_CP = camera.q_PC.toRotationMatrix().transpose();
  R_CP.row(2) *= -1.0;  // C looks along -z: the depth in front of the eye is positive
  Eigen::Matrix<double, 3, 4> view;
  view.leftCols<3>() = R_CP;
  view.col(3) = -R_CP * camera.eye_mm();
  return view;
}

Eigen::Vector2d sceneAngles(const Camera& camera, const Rect& area, const Eigen::Vector2d& pixel) {
  const double half = 0.5 * static_cast<double>(area.h);
  const double tangent = std::tan(0.5 * camera.fieldOfView);
  const Eigen::Vector2d centre(static_cast<double>(area.x) + 0.5 * static_cast<double>(area.w),
                               static_cast<double>(area.y) + half);
  return {(pixel.x() - centre.x()) / half * tangent, (centre.y() - pixel.y()) / half * tangent};
}

std::optional<Eigen::Vector3d> firstLabelled(const LabelGrid& labels,
                                             const std::vector<std::uint8_t>& hidden,
                                             const Eigen::Vector3d& eye_mm,
                                             const Eigen::Vector3d& direction_P) {
  const GridGeometry& g = labels.geometry;
  const Eigen::Isometry3d X_VP = g.X_PV.inverse();
  const Eigen::Vector3d from = X_VP * (eye_mm * 1e-3);
  const Eigen::Vector3d along = (X_VP.linear() * direction_P).normalized();
  // Where the ray is in the grid's box at all.
  double near = 0.0, far = 1e3;
  for (int a = 0; a < 3; ++a) {
    const double low = -0.5 * g.spacing[a];
    const double high = (g.dims[static_cast<std::size_t>(a)] - 0.5) * g.spacing[a];
    if (along[a] == 0.0) {
      if (from[a] < low || from[a] >= high) return {};
      continue;
    }
    const double t0 = (low - from[a]) / along[a], t1 = (high - from[a]) / along[a];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  const double step = 0.25 * g.spacing.minCoeff();
  for (double t = near; t <= far; t += step) {
    const auto v = g.voxelAt(from + t * along);
    if (!g.contains(v[0], v[1], v[2])) continue;
    const std::uint8_t label = labels.at(v[0], v[1], v[2]);
    if (label == 0 || std::find(hidden.begin(), hidden.end(), label) != hidden.end()) continue;
    return Eigen::Vector3d(g.X_PV * g.centre_V(v[0], v[1], v[2]) * 1e3);
  }
  return {};
}

bool editInScene(SegmentPanelState& state, const Camera& camera, const Rect& area,
                 const ScenePicks& picks, Actions& actions) {
  const Gesture gesture = gestureOf(state);
  const ImGuiIO& io = ImGui::GetIO();
  if (gesture != Gesture::None && stillAbandoned(state)) return true;
  if (gesture == Gesture::Pick && picks.seen != nullptr) {
    const bool click = ImGui::IsItemDeactivated() && ImGui::IsMouseReleased(0) &&
                       io.MouseDragMaxDistanceSqr[0] < kClickPixels * kClickPixels;
    if (!click) return false;
    const Eigen::Vector2d uv = sceneAngles(camera, area, mousePixel());
    const Eigen::Vector3d ray = camera.q_PC * Eigen::Vector3d(uv.x(), uv.y(), -1.0);
    const auto hit = firstLabelled(*picks.seen, picks.hidden, camera.eye_mm(), ray);
    state.missed = !hit.has_value();
    if (hit) pick(state, *hit, picks.labels, picks.label);
    return true;
  }
  if (gesture != Gesture::Outline) return false;
  const bool mine = state.drawingIn == View::Scene;
  if (mine && !ImGui::IsMouseDown(0)) {
    if (state.outline.size() >= 3) {
      tool::Scissors tool;
      tool.view = sceneView(camera);
      for (const auto& p : state.outline) tool.outline.push_back(sceneAngles(camera, area, p));
      tool.keepInside = state.keepInside;
      apply(state, std::move(tool), actions);
    }
    state.outline.clear();
    state.drawingIn.reset();
    return true;
  }
  if (ImGui::IsItemActivated() && ImGui::IsMouseDown(0) && !io.KeyCtrl) {
    state.drawingIn = View::Scene;
  }
  if (state.drawingIn != View::Scene) return false;
  addCorner(state.outline);
  return true;
}

void drawEditInScene(const SegmentPanelState& state, const Camera& camera, const Rect& area,
                     const ScenePicks& picks, const Theme& theme, float scale) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->PushClipRect({area.x, area.y}, {area.right(), area.bottom()}, true);
  if (state.drawingIn == View::Scene) drawOutline(*list, state.outline, theme, scale);
  if (gestureOf(state) == Gesture::Pick) {
    const Eigen::Matrix<double, 3, 4> view = sceneView(camera);
    const double half = 0.5 * static_cast<double>(area.h) / std::tan(0.5 * camera.fieldOfView);
    for (const auto& pick : state.picks) {
      const Eigen::Vector3d seen = view * pick.at_mm.homogeneous();
      if (seen.z() <= 0.0) continue;
      const ImVec2 p(area.x + 0.5F * area.w + static_cast<float>(seen.x() / seen.z() * half),
                     area.y + 0.5F * area.h - static_cast<float>(seen.y() / seen.z() * half));
      // Behind the anatomy it is a ring: it does not lie on what hides it.
      constexpr double kBehind_mm = 4.0;
      const Eigen::Vector3d ray = pick.at_mm - camera.eye_mm();
      const auto first = picks.seen != nullptr
                             ? firstLabelled(*picks.seen, picks.hidden, camera.eye_mm(), ray)
                             : std::nullopt;
      const bool behind = first && (*first - camera.eye_mm()).norm() < ray.norm() - kBehind_mm;
      const ImU32 colour = pickColour(state, pick.part);
      if (behind) {
        list->AddCircle(p, 4.5F * scale, IM_COL32(0, 0, 0, 140), 20, 3.0F * scale);
        list->AddCircle(p, 4.5F * scale, colour, 20, 1.5F * scale);
        continue;
      }
      list->AddCircleFilled(p, 5.0F * scale, colour, 20);
      list->AddCircle(p, 6.0F * scale, IM_COL32(0, 0, 0, 200), 20, 1.5F * scale);
    }
  }
  list->PopClipRect();
}

ImU32 pickColour(const SegmentPanelState& state, std::size_t part) {
  if (state.kind == ToolKind::Split && part < state.partColours.size()) {
    return state.partColours[part];
  }
  const auto c = labelColour(part);
  return IM_COL32(c[0], c[1], c[2], 255);
}

}  // namespace palpate::ui
