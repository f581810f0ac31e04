#include <imgui.h>

#include <algorithm>

#include "ui/gl_api.h"
#include "ui/icons.h"
#include "ui/panels.h"

namespace palpate::ui {
namespace {

GlTexture textureOf(const GreyPicture& picture) {
  std::vector<std::uint8_t> rgba;
  rgba.reserve(picture.grey.size() * 4);
  for (const std::uint8_t g : picture.grey) rgba.insert(rgba.end(), {g, g, g, 255});
  GlTexture texture =
      makeTexture2D(picture.width, picture.height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, picture.width, picture.height, GL_RGBA, GL_UNSIGNED_BYTE,
                  rgba.data());
  return texture;
}

/// The middle slice, or an icon where there is no picture, in a black square.
void drawThumbnail(const Painter& paint, const SeriesRow& series, Thumbnails& thumbnails,
                   ImVec2 corner, float side, bool enabled) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(corner, {corner.x + side, corner.y + side}, IM_COL32(0, 0, 0, 255),
                      paint.px(4.0F));
  if (series.picture.width == 0) {
    const ImVec2 size = ImGui::CalcTextSize(icon::kFile);
    list->AddText({corner.x + 0.5F * (side - size.x), corner.y + 0.5F * (side - size.y)},
                  packed(paint.theme.secondary, 0.6F), icon::kFile);
    return;
  }
  auto known = thumbnails.find(series.uid);
  if (known == thumbnails.end()) {
    known = thumbnails.emplace(series.uid, textureOf(series.picture)).first;
  }
  const float scale =
      side / static_cast<float>(std::max(series.picture.width, series.picture.height));
  const float w = scale * static_cast<float>(series.picture.width);
  const float h = scale * static_cast<float>(series.picture.height);
  const ImVec2 a{corner.x + 0.5F * (side - w), corner.y + 0.5F * (side - h)};
  list->AddImage(reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(known->second.id())), a,
                 {a.x + w, a.y + h}, {0.0F, 0.0F}, {1.0F, 1.0F},
                 IM_COL32(255, 255, 255, enabled ? 255 : 110));
}

/// Picture, title, size of the grid, files; what cannot be imported says why on pointing at it.
bool seriesRow(const Painter& paint, const SeriesRow& series, Thumbnails& thumbnails) {
  const bool enabled = series.importable || series.repairable;
  const float side = paint.px(56.0F);
  const float height = side + paint.px(12.0F);
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::BeginDisabled(!enabled);
  const bool pressed = ImGui::InvisibleButton("series", {width, height});
  ImGui::EndDisabled();
  paint.note(series.title);
  const ImVec2 a = ImGui::GetItemRectMin();
  const ImVec2 b = ImGui::GetItemRectMax();
  const bool pointed = ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (enabled && pointed) {
    list->AddRectFilled(a, b, packed(paint.theme.hover), paint.px(Measures::kCorner));
  }
  drawThumbnail(paint, series, thumbnails, {a.x + paint.px(6.0F), a.y + paint.px(6.0F)}, side,
                enabled);
  const float left = a.x + side + paint.px(16.0F);
  const float room = b.x - left - paint.px(4.0F);
  const float alpha = enabled ? 1.0F : 0.55F;
  ImFont* small = paint.fonts.secondary;
  list->AddText({left, a.y + paint.px(7.0F)}, packed(paint.theme.text, alpha),
                shortened(series.title, paint.fonts.body, room).c_str());
  const std::string second = series.importable ? series.detail : series.reason;
  list->AddText(small, small->FontSize, {left, a.y + paint.px(28.0F)},
                packed(series.importable ? paint.theme.secondary : paint.theme.attention, alpha),
                shortened(second, small, room).c_str());
  list->AddText(small, small->FontSize, {left, a.y + paint.px(46.0F)},
                packed(paint.theme.secondary, alpha), shortened(series.size, small, room).c_str());
  if (pointed) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(paint.px(320.0F));
    ImGui::TextUnformatted((series.title + "\n" + second + "\n" + series.size).c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
  return pressed && enabled;
}

}  // namespace

void drawSeriesList(const Painter& paint, const LibraryModel& library, Thumbnails& thumbnails) {
  section(paint, "SERIES IN THERE");
  sentence(paint, "Choose the one to make a case of.");
  if (button(paint, icon::kClose, "Import none", Emphasis::Normal)) {
    paint.actions.push_back(act::CloseSeriesList{});
  }
  std::string study;
  for (const SeriesRow& series : library.series) {
    if (series.study != study) {
      study = series.study;
      space(paint, 4.0F);
      ImGui::TextUnformatted(
          shortened(study, ImGui::GetFont(), ImGui::GetContentRegionAvail().x).c_str());
    }
    ImGui::PushID(series.uid.c_str());
    if (seriesRow(paint, series, thumbnails)) {
      paint.actions.push_back(act::ImportSeries{library.seriesPath, series.uid});
    }
    ImGui::PopID();
  }
}

}  // namespace palpate::ui
