#include <imgui.h>

#include <algorithm>
#include <cmath>

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

/// Cut with an ellipsis to what fits into so many lines.
std::string shortenedTo(int lines, const std::string& text, ImFont* font, float width) {
  const float most = (static_cast<float>(lines) + 0.5F) * font->FontSize;
  const auto fits = [&](const std::string& s) {
    return font->CalcTextSizeA(font->FontSize, 1e6F, width, s.c_str()).y < most;
  };
  if (fits(text)) return text;
  std::string cut = text;
  std::size_t space = std::string::npos;
  while ((space = cut.find_last_of(' ')) != std::string::npos) {
    cut.resize(space);
    if (fits(cut + " \xe2\x80\xa6")) break;
  }
  return cut + " \xe2\x80\xa6";
}

/// Grid, spacing and size, or why it cannot be imported, in three lines.
void drawSeriesDetails(const Painter& paint, const SeriesRow& series, ImVec2 at, float room) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  ImFont* small = paint.fonts.secondary;
  const float line = paint.px(16.0F);
  const auto put = [&](int row, const std::string& text) {
    list->AddText(small, small->FontSize, {at.x, at.y + static_cast<float>(row) * line},
                  packed(paint.theme.secondary), shortened(text, small, room).c_str());
  };
  if (series.importable) {
    put(0, series.grid);
    put(1, series.spacing);
    put(2, series.size);
    return;
  }
  const std::string reason = shortenedTo(3, series.reason, small, room);
  list->AddText(small, small->FontSize, at, packed(paint.theme.attention), reason.c_str(), nullptr,
                room);
  const float height = small->CalcTextSizeA(small->FontSize, 1e6F, room, reason.c_str()).y;
  const auto lines = static_cast<int>(std::lround(height / small->FontSize));
  if (lines < 3) put(lines, series.size);
}

void explainSeries(const Painter& paint, const SeriesRow& series) {
  std::string text = series.title;
  if (!series.reason.empty()) text += "\n" + series.reason + ".";
  for (const std::string* part : {&series.grid, &series.spacing, &series.size}) {
    if (!part->empty()) text += "\n" + *part;
  }
  if (series.repairable) {
    text += "\nIt can be resampled to a regular grid: choose it to be asked.";
  }
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(paint.px(320.0F));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

/// Picture, title and three lines; all of it in full on pointing at it.
bool seriesRow(const Painter& paint, const SeriesRow& series, Thumbnails& thumbnails) {
  const bool enabled = series.importable || series.repairable;
  const float side = paint.px(static_cast<float>(kThumbnailSide));
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
  const float left = a.x + side + paint.px(14.0F);
  const float room = b.x - left - paint.px(4.0F);
  list->AddText({left, a.y + paint.px(4.0F)},
                packed(enabled ? paint.theme.text : paint.theme.secondary),
                shortened(series.title, paint.fonts.body, room).c_str());
  drawSeriesDetails(paint, series, {left, a.y + paint.px(24.0F)}, room);
  if (pointed) explainSeries(paint, series);
  return pressed && enabled;
}

void studyHeading(const Painter& paint, const std::string& study) {
  space(paint, 4.0F);
  const std::string fits = shortened(study, ImGui::GetFont(), ImGui::GetContentRegionAvail().x);
  ImGui::TextUnformatted(fits.c_str());
  if (fits != study && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", study.c_str());
}

}  // namespace

void drawSeriesList(const Painter& paint, const LibraryModel& library, Thumbnails& thumbnails) {
  section(paint, "SERIES IN THERE");
  const bool any = std::any_of(library.series.begin(), library.series.end(),
                               [](const auto& s) { return s.importable || s.repairable; });
  sentence(paint, any ? "Choose the one to make a case of."
                      : "None of them can become a volume; each says why.");
  if (button(paint, icon::kClose, any ? "Import none" : "Close the list", Emphasis::Normal)) {
    paint.actions.push_back(act::CloseSeriesList{});
  }
  std::optional<std::size_t> study;
  for (const SeriesRow& series : library.series) {
    if (series.studyNumber != study) {
      study = series.studyNumber;
      studyHeading(paint, series.study);
    }
    ImGui::PushID(series.uid.c_str());
    if (seriesRow(paint, series, thumbnails)) {
      paint.actions.push_back(act::ImportSeries{library.seriesPath, series.uid});
    }
    ImGui::PopID();
  }
}

}  // namespace palpate::ui
