#include "ui/scene_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace palpate::ui {

void drawOrientationCube(ImDrawList& list, const Camera& camera, ImVec2 centre, float radius,
                         const Theme& theme, ImFont* font) {
  struct End {
    const char* letter;
    Eigen::Vector3d direction;
  };
  const std::array<End, 6> ends{{{"L", {1, 0, 0}},
                                 {"R", {-1, 0, 0}},
                                 {"P", {0, 1, 0}},
                                 {"A", {0, -1, 0}},
                                 {"H", {0, 0, 1}},
                                 {"F", {0, 0, -1}}}};
  struct Seen {
    const char* letter;
    float x, y, z;
  };
  std::vector<Seen> seen;
  for (const End& end : ends) {
    const Eigen::Vector3d c = camera.q_PC.conjugate() * end.direction;
    seen.push_back({end.letter, static_cast<float>(c.x()), static_cast<float>(-c.y()),
                    static_cast<float>(c.z())});
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const Seen& a, const Seen& b) { return a.z < b.z; });
  list.AddCircleFilled(centre, radius * 1.32F, packed(theme.ground, theme.light ? 0.55F : 0.45F),
                       48);
  for (const Seen& s : seen) {
    const float alpha = 0.35F + 0.65F * std::clamp(0.5F + 0.5F * s.z, 0.0F, 1.0F);
    const ImVec2 tip(centre.x + radius * s.x, centre.y + radius * s.y);
    list.AddLine(centre, {centre.x + 0.62F * radius * s.x, centre.y + 0.62F * radius * s.y},
                 packed(theme.secondary, alpha * 0.8F), 1.5F);
    const ImVec2 size = font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, s.letter);
    list.AddText(font, font->FontSize,
                 {std::round(tip.x - 0.5F * size.x), std::round(tip.y - 0.5F * size.y)},
                 packed(s.z > -0.2F ? theme.text : theme.secondary, alpha), s.letter);
  }
}

Eigen::Vector3d handMotion(const Camera& camera, double dxPixels, double dyPixels,
                           double towardsScene_mm, double viewHeight) {
  const double s = camera.millimetresPerPixel(viewHeight);
  return 1e-3 * (camera.q_PC * Eigen::Vector3d(dxPixels * s, -dyPixels * s, -towardsScene_mm));
}

bool interactWithScene(Camera& camera, const Rect& area, bool holding, Actions& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto dx = static_cast<double>(io.MouseDelta.x);
  const auto dy = static_cast<double>(io.MouseDelta.y);
  const auto height = static_cast<double>(area.h);
  const bool hovered = ImGui::IsItemHovered();
  if (hovered && !holding && ImGui::IsMouseDoubleClicked(0)) return true;
  if (holding) {
    const bool turning = ImGui::IsItemActive() && ImGui::IsMouseDown(1);
    // Both ends of the motion: coming in from the panel is no push.
    const bool over =
        area.contains(io.MousePos.x, io.MousePos.y) &&
        area.contains(io.MousePos.x - io.MouseDelta.x, io.MousePos.y - io.MouseDelta.y);
    if (ImGui::IsItemActive() && ImGui::IsMouseDown(2)) {
      const double turn = 3.2 / std::max(1.0, height);
      camera.orbit(dx * turn, -dy * turn);
      return false;
    }
    if (turning && (dx != 0.0 || dy != 0.0)) {
      constexpr double kTurn = 0.006;  // rad a pixel
      actions.push_back(act::TurnHand{camera.q_PC * Eigen::Vector3d(dy * kTurn, dx * kTurn, 0.0)});
    } else if (over && (dx != 0.0 || dy != 0.0 || io.MouseWheel != 0.0F)) {
      // A notch of the wheel is 1 mm into the scene.
      actions.push_back(
          act::MoveHand{handMotion(camera, dx, dy, static_cast<double>(io.MouseWheel), height)});
    }
    return false;
  }
  if (hovered && io.MouseWheel != 0.0F) camera.zoom(static_cast<double>(io.MouseWheel));
  if (!ImGui::IsItemActive()) return false;
  if (ImGui::IsMouseDown(0) && (dx != 0.0 || dy != 0.0)) {
    const double turn = 3.2 / std::max(1.0, height);  // half a turn a view's height
    camera.orbit(dx * turn, -dy * turn);
  }
  if (ImGui::IsMouseDown(1)) camera.zoom(-dy * 0.06);
  if (ImGui::IsMouseDown(2) && (dx != 0.0 || dy != 0.0)) camera.pan(dx, dy, height);
  return false;
}

}  // namespace palpate::ui
