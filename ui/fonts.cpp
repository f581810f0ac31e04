#include "ui/fonts.h"

#include <imgui_internal.h>  // ImTextCharFromUtf8

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::ui {
namespace {

// With the digits: figure space, figure dash and minus sign, which stand in for one.
constexpr std::array<ImWchar, 11> kDigits{'0',    '9',    '>',    '>',    0x2007, 0x2007,
                                          0x2012, 0x2012, 0x2212, 0x2212, 0};
// Latin, Greek, Cyrillic (µ is Latin-1; Δ, σ), punctuation, superscripts, arrows, mathematical
// signs.
constexpr std::array<ImWchar, 17> kText{0x20,   0x2f,   0x3a,   0x17f,  0x370,  0x52f,
                                        0x2000, 0x200b, 0x2010, 0x2044, 0x2070, 0x209f,
                                        0x2190, 0x21ff, 0x2200, 0x22ff, 0};
// A folder with names of every script must not fill the atlas: a page of text has some hundred.
constexpr std::size_t kMostRare = 4096;
constexpr std::array<ImWchar, 3> kIcons{0xf000, 0xf2e0, 0};

// Dear ImGui's size is ascent plus descent, a designer's size is the em: 1.21 in Inter.
constexpr float kLinePerEm = 1.21F;

template <std::size_t N>
bool within(const std::array<ImWchar, N>& ranges, unsigned int c) {
  for (std::size_t i = 0; i + 1 < N; i += 2) {
    if (c >= ranges[i] && c <= ranges[i + 1]) return true;
  }
  return false;
}

struct FontFiles {
  std::filesystem::path icons, fallback;
  std::vector<ImWchar> rare;  ///< Lives until the atlas is built.
};

/// Every digit as wide as the widest ('0' in Inter, 0.64 em): numbers hold still.
ImFont* addTabular(ImFontAtlas& atlas, const std::filesystem::path& text, const FontFiles& files,
                   float em) {
  const float size = std::round(em * kLinePerEm);
  ImFontConfig digits;
  digits.OversampleH = 2;
  digits.GlyphMinAdvanceX = digits.GlyphMaxAdvanceX = std::round(em * 0.63F);
  ImFont* font = atlas.AddFontFromFileTTF(text.c_str(), size, &digits, kDigits.data());
  ImFontConfig rest;
  rest.OversampleH = 2;
  rest.MergeMode = true;
  atlas.AddFontFromFileTTF(text.c_str(), size, &rest, kText.data());
  // The first font that has a character gives it: Inter knows some of the rare ones.
  if (files.rare.size() > 1) {
    atlas.AddFontFromFileTTF(text.c_str(), size, &rest, files.rare.data());
    if (!files.fallback.empty()) {
      atlas.AddFontFromFileTTF(files.fallback.c_str(), size, &rest, files.rare.data());
    }
  }
  ImFontConfig symbols;
  symbols.MergeMode = true;
  symbols.GlyphMinAdvanceX = symbols.GlyphMaxAdvanceX = std::round(em * 1.3F);
  symbols.GlyphOffset = ImVec2(0.0F, std::round(em * 0.08F));
  atlas.AddFontFromFileTTF(files.icons.c_str(), em * 1.08F, &symbols, kIcons.data());
  return font;
}

Result<void> present(const std::filesystem::path& file, const char* package) {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored)) return {};
  return fail(machineError("A font of the window is missing.")
                  .inFile(file.string())
                  .advise(std::string("Install the package ") + package + "."));
}

}  // namespace

bool RareCharacters::add(const std::string& utf8) {
  bool fresh = false;
  const char* at = utf8.data();
  const char* end = at + utf8.size();
  while (at < end) {
    if ((static_cast<unsigned char>(*at) & 0x80U) == 0) {
      ++at;
      continue;
    }
    unsigned int c = 0;
    at += std::max(1, ImTextCharFromUtf8(&c, at, end));
    // Beyond the plane that ImGui holds it gives "invalid", whose sign is no letter of a name.
    if (c < 0x80 || c >= IM_UNICODE_CODEPOINT_INVALID) continue;
    if (within(kText, c) || within(kDigits, c) || within(kIcons, c)) continue;
    if (characters_.size() >= kMostRare) return fresh;
    fresh = characters_.insert(static_cast<ImWchar>(c)).second || fresh;
  }
  return fresh;
}

std::vector<ImWchar> RareCharacters::ranges() const {
  std::vector<ImWchar> ranges;
  for (const ImWchar c : characters_) {
    if (!ranges.empty() && ranges.back() + 1 == c) {
      ranges.back() = c;
    } else {
      ranges.insert(ranges.end(), {c, c});
    }
  }
  ranges.push_back(0);
  return ranges;
}

Result<Fonts> loadFonts(const std::filesystem::path& folder, float scale,
                        const RareCharacters& rare) {
  const auto regular = folder / "opentype/inter/Inter-Regular.otf";
  const auto semibold = folder / "opentype/inter/Inter-SemiBold.otf";
  FontFiles files;
  files.icons = folder / "truetype/font-awesome/fontawesome-webfont.ttf";
  for (const auto& text : {regular, semibold}) {
    if (auto ok = present(text, "fonts-inter"); !ok) return fail(ok.error());
  }
  if (auto ok = present(files.icons, "fonts-font-awesome"); !ok) return fail(ok.error());
  files.fallback = folder / "truetype/wqy/wqy-microhei.ttc";
  std::error_code ignored;
  if (!std::filesystem::exists(files.fallback, ignored)) files.fallback.clear();
  files.rare = rare.ranges();

  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  Fonts fonts;
  fonts.body = addTabular(atlas, regular, files, 15.0F * scale);
  fonts.secondary = addTabular(atlas, regular, files, 13.0F * scale);
  fonts.strong = addTabular(atlas, semibold, files, 15.0F * scale);
  fonts.heading = addTabular(atlas, semibold, files, 20.0F * scale);
  atlas.Build();
  return fonts;
}

}  // namespace palpate::ui
