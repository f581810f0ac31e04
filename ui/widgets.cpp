#include "ui/widgets.h"

#include <algorithm>
#include <cmath>

#include "ui/icons.h"

namespace palpate::ui {
namespace {

struct ButtonColours {
  ImVec4 ground, hover, text;
};

ImVec4 mixed(const ImVec4& a, const ImVec4& b, float f) {
  return {a.x + f * (b.x - a.x), a.y + f * (b.y - a.y), a.z + f * (b.z - a.z), 1.0F};
}

ButtonColours coloursOf(const Theme& t, Emphasis emphasis) {
  switch (emphasis) {
    case Emphasis::Primary:
      return {t.accent, mixed(t.accent, t.text, 0.18F), t.onAccent};
    case Emphasis::Danger:
      return {mixed(t.panel, t.danger, 0.22F), mixed(t.panel, t.danger, 0.38F), t.text};
    case Emphasis::Quiet:
      return {t.panel, t.raised, t.secondary};
    case Emphasis::Normal:
      break;
  }
  return {t.raised, t.hover, t.text};
}

void tooltipOf(const char* text) {
  if (text == nullptr || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22.0F);
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace

void Painter::note(const std::string& label) const {
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  items[label] = {a.x, a.y, b.x - a.x, b.y - a.y};
}

bool button(const Painter& paint, const char* icon, const std::string& label, Emphasis emphasis,
            float width, bool enabled, const char* tooltip) {
  const ButtonColours c = coloursOf(paint.theme, emphasis);
  const std::string shown = icon == nullptr ? label : std::string(icon) + "  " + label;
  const float height = paint.px(Measures::kControl);
  float w = width;
  if (w < 0.0F) w = ImGui::GetContentRegionAvail().x;
  if (w == 0.0F) w = ImGui::CalcTextSize(shown.c_str()).x + paint.px(24.0F);
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::InvisibleButton(label.c_str(), {w, height});
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  const bool hot = enabled && ImGui::IsItemHovered();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float alpha = enabled ? 1.0F : 0.42F;
  list->AddRectFilled(a, b, packed(hot ? c.hover : c.ground, alpha), paint.px(Measures::kCorner));
  const std::string fits = shortened(shown, ImGui::GetFont(), w - paint.px(12.0F));
  const ImVec2 size = ImGui::CalcTextSize(fits.c_str());
  list->AddText({std::round(a.x + 0.5F * (w - size.x)), std::round(a.y + 0.5F * (height - size.y))},
                packed(c.text, alpha), fits.c_str());
  ImGui::EndDisabled();
  tooltipOf(tooltip);
  paint.note(label);
  return pressed && enabled;
}

bool iconButton(const Painter& paint, const char* icon, const std::string& label, bool on,
                bool enabled) {
  const float side = paint.px(28.0F);
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::InvisibleButton(label.c_str(), {side, side});
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const bool hot = enabled && ImGui::IsItemHovered();
  if (hot || on) {
    list->AddRectFilled(a, b, packed(hot ? paint.theme.hover : paint.theme.raised),
                        paint.px(Measures::kCorner));
  }
  const ImVec2 size = ImGui::CalcTextSize(icon);
  list->AddText(
      {std::round(a.x + 0.5F * (side - size.x)), std::round(a.y + 0.5F * (side - size.y))},
      packed(on ? paint.theme.accent : paint.theme.secondary, enabled ? 1.0F : 0.4F), icon);
  ImGui::EndDisabled();
  tooltipOf(label.c_str());
  paint.note(label);
  return pressed && enabled;
}

std::size_t segmented(const Painter& paint, const char* id, const std::vector<std::string>& labels,
                      std::size_t chosen, bool enabled) {
  const float height = paint.px(Measures::kControl);
  const float total = ImGui::GetContentRegionAvail().x;
  const float each =
      std::floor(total / static_cast<float>(std::max<std::size_t>(1, labels.size())));
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(origin, {origin.x + total, origin.y + height}, packed(paint.theme.raised),
                      paint.px(Measures::kCorner));
  ImGui::PushID(id);
  ImGui::BeginDisabled(!enabled);
  std::size_t result = chosen;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const ImVec2 a(origin.x + static_cast<float>(i) * each, origin.y);
    ImGui::SetCursorScreenPos(a);
    if (ImGui::InvisibleButton(labels[i].c_str(), {each, height})) result = i;
    paint.note(labels[i]);
    const bool on = i == chosen;
    const float in = paint.px(3.0F);
    if (on || ImGui::IsItemHovered()) {
      list->AddRectFilled({a.x + in, a.y + in}, {a.x + each - in, a.y + height - in},
                          on ? packed(paint.theme.accent, 0.22F) : packed(paint.theme.hover),
                          paint.px(Measures::kCorner - 2.0F));
    }
    const std::string fits = shortened(labels[i], ImGui::GetFont(), each - 2.0F * in);
    const ImVec2 size = ImGui::CalcTextSize(fits.c_str());
    list->AddText(
        {std::round(a.x + 0.5F * (each - size.x)), std::round(a.y + 0.5F * (height - size.y))},
        packed(on ? paint.theme.text : paint.theme.secondary, enabled ? 1.0F : 0.45F),
        fits.c_str());
  }
  ImGui::EndDisabled();
  ImGui::PopID();
  ImGui::SetCursorScreenPos({origin.x, origin.y + height + ImGui::GetStyle().ItemSpacing.y});
  return result;
}

bool toggle(const Painter& paint, const std::string& label, bool& on, bool enabled,
            const std::string& instead) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = paint.px(26.0F);
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::InvisibleButton(label.c_str(), {width, height});
  ImGui::EndDisabled();
  if (pressed && enabled) on = !on;
  const ImVec2 a = ImGui::GetItemRectMin();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float alpha = enabled ? 1.0F : 0.45F;
  const float h = paint.px(16.0F);
  const float w = paint.px(30.0F);
  ImFont* font = instead.empty() ? paint.fonts.body : paint.fonts.secondary;
  const std::string words =
      shortened(instead.empty() ? label : instead, font, width - w - paint.px(6.0F));
  list->AddText(font, font->FontSize, {a.x, std::round(a.y + 0.5F * (height - font->FontSize))},
                packed(instead.empty() ? paint.theme.text : paint.theme.secondary, alpha),
                words.c_str());
  if (!instead.empty() && words != instead && ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s", instead.c_str());
  }
  const ImVec2 track(a.x + width - w, std::round(a.y + 0.5F * (height - h)));
  list->AddRectFilled(track, {track.x + w, track.y + h},
                      packed(on ? paint.theme.accent : paint.theme.hover, alpha), 0.5F * h);
  const float x = on ? track.x + w - 0.5F * h : track.x + 0.5F * h;
  list->AddCircleFilled({x, track.y + 0.5F * h}, 0.5F * h - paint.px(2.0F),
                        packed(on ? paint.theme.onAccent : paint.theme.secondary, alpha), 24);
  paint.note(label);
  return pressed && enabled;
}

bool slider(const Painter& paint, const std::string& label, int& value, int low, int high) {
  keyValue(paint, label, std::to_string(value));
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = paint.px(16.0F);
  ImGui::InvisibleButton(label.c_str(), {width, height});
  paint.note(label);
  const ImVec2 a = ImGui::GetItemRectMin();
  const float knob = paint.px(6.0F);
  bool changed = false;
  if (ImGui::IsItemActive()) {
    const float f = (ImGui::GetIO().MousePos.x - a.x - knob) / std::max(1.0F, width - 2.0F * knob);
    const auto span = static_cast<float>(high - low);
    const int wanted = low + static_cast<int>(std::lround(std::clamp(f, 0.0F, 1.0F) * span));
    changed = wanted != value;
    value = wanted;
  }
  const float f = static_cast<float>(value - low) / static_cast<float>(std::max(1, high - low));
  const float y = std::round(a.y + 0.5F * height);
  const float x = a.x + knob + f * (width - 2.0F * knob);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float r = paint.px(2.0F);
  list->AddRectFilled({a.x, y - r}, {a.x + width, y + r}, packed(paint.theme.hover), r);
  list->AddRectFilled({a.x, y - r}, {x, y + r}, packed(paint.theme.accent), r);
  list->AddCircleFilled({x, y}, knob, packed(paint.theme.accent), 24);
  return changed;
}

void heading(const Painter& paint, const std::string& text) {
  ImGui::PushFont(paint.fonts.heading);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopFont();
  space(paint, 2.0F);
}

void section(const Painter& paint, const std::string& text) {
  space(paint, 6.0F);
  ImGui::PushFont(paint.fonts.secondary);
  ImGui::TextColored(paint.theme.secondary, "%s", text.c_str());
  ImGui::PopFont();
}

void sentence(const Painter& paint, const std::string& text) {
  ImGui::PushFont(paint.fonts.secondary);
  ImGui::PushStyleColor(ImGuiCol_Text, paint.theme.secondary);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
  ImGui::PopFont();
}

void keyValue(const Painter& paint, const std::string& key, const std::string& value) {
  ImGui::PushFont(paint.fonts.secondary);
  const float width = ImGui::GetContentRegionAvail().x;
  const float keyWidth = ImGui::CalcTextSize(key.c_str()).x + paint.px(12.0F);
  const float x = ImGui::GetCursorPosX();
  ImGui::TextColored(paint.theme.secondary, "%s", key.c_str());
  const std::string fits = shortened(value, paint.fonts.secondary, width - keyWidth);
  ImGui::SameLine(x + width - ImGui::CalcTextSize(fits.c_str()).x);
  ImGui::TextUnformatted(fits.c_str());
  ImGui::PopFont();
}

void notice(const Painter& paint, MessageModel::Kind kind, const std::string& text) {
  const Theme& t = paint.theme;
  const ImVec4 colour = kind == MessageModel::Kind::Problem   ? t.danger
                        : kind == MessageModel::Kind::Warning ? t.attention
                                                              : t.accent;
  const char* icon = kind == MessageModel::Kind::Information ? icon::kInfo : icon::kWarning;
  ImGui::PushFont(paint.fonts.secondary);
  const float width = ImGui::GetContentRegionAvail().x;
  const float in = paint.px(10.0F);
  const float left = in + paint.px(22.0F);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, width - left - in);
  const ImVec2 a = ImGui::GetCursorScreenPos();
  const ImVec2 b(a.x + width, a.y + size.y + 2.0F * in);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(a, b, packed(t.raised), paint.px(Measures::kCorner));
  list->AddRectFilled(a, {a.x + paint.px(3.0F), b.y}, packed(colour), paint.px(2.0F));
  list->AddText({a.x + in, a.y + in}, packed(colour), icon);
  list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), {a.x + left, a.y + in}, packed(t.text),
                text.c_str(), nullptr, width - left - in);
  ImGui::PopFont();
  ImGui::Dummy({width, b.y - a.y});
}

void progressBar(const Painter& paint, double fraction, float height) {
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 a = ImGui::GetCursorScreenPos();
  const float h = paint.px(height);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(a, {a.x + width, a.y + h}, packed(paint.theme.hover), 0.5F * h);
  const auto f = static_cast<float>(std::clamp(fraction, 0.0, 1.0));
  if (f > 0.0F) {
    list->AddRectFilled(a, {a.x + std::max(h, width * f), a.y + h}, packed(paint.theme.accent),
                        0.5F * h);
  }
  ImGui::Dummy({width, h});
}

void space(const Painter& paint, float pixels) {
  ImGui::Dummy({1.0F, paint.px(pixels)});
}

std::string shortened(const std::string& text, ImFont* font, float width) {
  const auto wide = [&](const std::string& s) {
    return font->CalcTextSizeA(font->FontSize, 1e6F, 0.0F, s.c_str()).x;
  };
  if (wide(text) <= width) return text;
  std::string cut = text;
  while (!cut.empty() && wide(cut + "\xe2\x80\xa6") > width) {
    // Whole UTF-8 characters only.
    while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0U) == 0x80U)
      cut.pop_back();
    if (!cut.empty()) cut.pop_back();
  }
  return cut + "\xe2\x80\xa6";
}

}  // namespace palpate::ui
