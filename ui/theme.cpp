#include "ui/theme.h"

#include <cmath>

namespace palpate::ui {
namespace {

ImVec4 hex(std::uint32_t rgb) {
  return ImVec4(static_cast<float>((rgb >> 16U) & 255U) / 255.0F,
                static_cast<float>((rgb >> 8U) & 255U) / 255.0F,
                static_cast<float>(rgb & 255U) / 255.0F, 1.0F);
}

double linear(float channel) {
  const double c = static_cast<double>(channel);
  return c <= 0.03928 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

double luminance(const ImVec4& c) {
  return 0.2126 * linear(c.x) + 0.7152 * linear(c.y) + 0.0722 * linear(c.z);
}

ImVec4 withAlpha(ImVec4 colour, float alpha) {
  colour.w = alpha;
  return colour;
}

}  // namespace

Theme Theme::dark() {
  Theme t;
  t.light = false;
  t.ground = hex(0x14171C);
  t.panel = hex(0x1B1F26);
  t.raised = hex(0x242A33);
  t.hover = hex(0x2E3540);
  t.text = hex(0xE6E9EE);
  t.secondary = hex(0x9AA4B2);
  t.line = hex(0x2E3540);
  t.accent = hex(0x4FB3A9);
  t.onAccent = hex(0x0D1B1A);
  t.attention = hex(0xE0A93B);
  t.danger = hex(0xE5594F);
  return t;
}

Theme Theme::bright() {
  Theme t;
  t.light = true;
  t.ground = hex(0xF4F6F8);
  t.panel = hex(0xFFFFFF);
  t.raised = hex(0xEBEEF2);
  t.hover = hex(0xDDE2E8);
  t.text = hex(0x1B1F26);
  t.secondary = hex(0x556070);
  t.line = hex(0xD5DBE2);
  t.accent = hex(0x187A71);
  t.onAccent = hex(0xFFFFFF);
  t.attention = hex(0x8A5A00);
  t.danger = hex(0xB3261E);
  return t;
}

double contrastRatio(const ImVec4& a, const ImVec4& b) {
  const double la = luminance(a);
  const double lb = luminance(b);
  return (std::max(la, lb) + 0.05) / (std::min(la, lb) + 0.05);
}

ImU32 packed(const ImVec4& colour, float alpha) {
  return ImGui::ColorConvertFloat4ToU32(withAlpha(colour, alpha));
}

void applyTheme(const Theme& theme, float scale) {
  ImGuiStyle style;
  style.WindowPadding = ImVec2(Measures::kPadding, Measures::kPadding);
  style.FramePadding = ImVec2(10.0F, 7.0F);
  style.ItemSpacing = ImVec2(8.0F, 8.0F);
  style.ItemInnerSpacing = ImVec2(8.0F, 4.0F);
  style.ScrollbarSize = 8.0F;
  style.GrabMinSize = 14.0F;
  style.WindowRounding = style.ChildRounding = style.FrameRounding = style.PopupRounding =
      style.GrabRounding = style.ScrollbarRounding = Measures::kCorner;
  style.WindowBorderSize = style.ChildBorderSize = style.FrameBorderSize = 0.0F;
  style.PopupBorderSize = Measures::kHairline;
  style.WindowMinSize = ImVec2(8.0F, 8.0F);
  style.ScaleAllSizes(scale);

  ImVec4* c = style.Colors;
  c[ImGuiCol_Text] = theme.text;
  c[ImGuiCol_TextDisabled] = theme.secondary;
  c[ImGuiCol_WindowBg] = theme.ground;
  c[ImGuiCol_ChildBg] = withAlpha(theme.panel, 0.0F);
  c[ImGuiCol_PopupBg] = theme.raised;
  c[ImGuiCol_Border] = theme.line;
  c[ImGuiCol_FrameBg] = theme.raised;
  c[ImGuiCol_FrameBgHovered] = theme.hover;
  c[ImGuiCol_FrameBgActive] = theme.hover;
  c[ImGuiCol_ScrollbarBg] = withAlpha(theme.panel, 0.0F);
  c[ImGuiCol_ScrollbarGrab] = theme.raised;  // quiet until it is looked for
  c[ImGuiCol_ScrollbarGrabHovered] = c[ImGuiCol_ScrollbarGrabActive] = theme.hover;
  c[ImGuiCol_CheckMark] = theme.accent;
  c[ImGuiCol_SliderGrab] = c[ImGuiCol_SliderGrabActive] = theme.accent;
  c[ImGuiCol_Button] = theme.raised;
  c[ImGuiCol_ButtonHovered] = c[ImGuiCol_ButtonActive] = theme.hover;
  c[ImGuiCol_Header] = theme.raised;
  c[ImGuiCol_HeaderHovered] = c[ImGuiCol_HeaderActive] = theme.hover;
  c[ImGuiCol_Separator] = theme.line;
  c[ImGuiCol_TextSelectedBg] = withAlpha(theme.accent, 0.35F);
  c[ImGuiCol_NavHighlight] = theme.accent;
  c[ImGuiCol_ModalWindowDimBg] = ImVec4(0.0F, 0.0F, 0.0F, 0.55F);
  ImGui::GetStyle() = style;
}

}  // namespace palpate::ui
