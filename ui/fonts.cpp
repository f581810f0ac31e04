#include "ui/fonts.h"

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
constexpr std::array<ImWchar, 3> kIcons{0xf000, 0xf2e0, 0};

// Dear ImGui's size is ascent plus descent, a designer's size is the em: 1.21 in Inter.
constexpr float kLinePerEm = 1.21F;

/// Every digit as wide as the widest ('0' in Inter, 0.64 em): numbers hold still.
ImFont* addTabular(ImFontAtlas& atlas, const std::filesystem::path& text,
                   const std::filesystem::path& icons, float em) {
  const float size = std::round(em * kLinePerEm);
  ImFontConfig digits;
  digits.OversampleH = 2;
  digits.GlyphMinAdvanceX = digits.GlyphMaxAdvanceX = std::round(em * 0.63F);
  ImFont* font = atlas.AddFontFromFileTTF(text.c_str(), size, &digits, kDigits.data());
  ImFontConfig rest;
  rest.OversampleH = 2;
  rest.MergeMode = true;
  atlas.AddFontFromFileTTF(text.c_str(), size, &rest, kText.data());
  ImFontConfig symbols;
  symbols.MergeMode = true;
  symbols.GlyphMinAdvanceX = symbols.GlyphMaxAdvanceX = std::round(em * 1.3F);
  symbols.GlyphOffset = ImVec2(0.0F, std::round(em * 0.08F));
  atlas.AddFontFromFileTTF(icons.c_str(), em * 1.08F, &symbols, kIcons.data());
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

Result<Fonts> loadFonts(const std::filesystem::path& folder, float scale) {
  const auto regular = folder / "opentype/inter/Inter-Regular.otf";
  const auto semibold = folder / "opentype/inter/Inter-SemiBold.otf";
  const auto icons = folder / "truetype/font-awesome/fontawesome-webfont.ttf";
  for (const auto& text : {regular, semibold}) {
    if (auto ok = present(text, "fonts-inter"); !ok) return fail(ok.error());
  }
  if (auto ok = present(icons, "fonts-font-awesome"); !ok) return fail(ok.error());

  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  Fonts fonts;
  fonts.body = addTabular(atlas, regular, icons, 15.0F * scale);
  fonts.secondary = addTabular(atlas, regular, icons, 13.0F * scale);
  fonts.strong = addTabular(atlas, semibold, icons, 15.0F * scale);
  fonts.heading = addTabular(atlas, semibold, icons, 20.0F * scale);
  atlas.Build();
  return fonts;
}

}  // namespace palpate::ui
