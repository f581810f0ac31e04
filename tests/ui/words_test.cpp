/// Numbers that hold still, colours that mean something, scripts that say what is wrong.

#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "ui/colours.h"
#include "ui/fonts.h"
#include "ui/format.h"
#include "ui/picture.h"
#include "ui/strip.h"
#include "ui/theme.h"
#include "ui/trade_words.h"
#include "ui/ui_script.h"
#include "ui/volume_layer.h"

namespace palpate::ui {
namespace {

/// Characters, not bytes.
std::size_t characters(const std::string& text) {
  std::size_t count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
  return count;
}

TEST(Format, EveryValueHasTheSameNumberOfCharacters) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double v : {0.0, 1.24, 99.99, -9.99, 12345.6, 1e12, -1e12, nan, 1.0 / 0.0}) {
    EXPECT_EQ(characters(fixed(v, 2, 2, "N")), characters(fixed(0.0, 2, 2, "N"))) << v;
  }
}

TEST(Format, SaysTheValueAndItsUnit) {
  EXPECT_EQ(fixed(12.345, 2, 2, "N"), "12.35 N");
  EXPECT_EQ(fixed(1.5, 2, 2, "N"),
            "\xe2\x80\x87"
            "1.50 N");
  EXPECT_EQ(fixed(250.0, 2, 2, "N"), ">9.99 N");
  EXPECT_EQ(grouped(1234567),
            "1\xe2\x80\x89"
            "234\xe2\x80\x89"
            "567");
  EXPECT_EQ(grouped(12), "12");
  EXPECT_EQ(clockText(83.46), "1:23.4");
  EXPECT_EQ(spacingText(0.957031, 0.957031, 1.5), "0.96 \xc3\x97 0.96 \xc3\x97 1.50 mm");
}

TEST(Colours, ContactsRunFromPaleYellowToDeepOrangeAndNeverRed) {
  Rgb before = contactColour(0.0);
  EXPECT_GT(before[0], 0.95F);
  EXPECT_GT(before[1], 0.9F);
  for (int i = 1; i <= 20; ++i) {
    const Rgb now = contactColour(i * 0.05e-3);
    EXPECT_LE(now[1], before[1]) << "green falls with depth";
    EXPECT_LE(now[2], before[2]) << "blue falls with depth";
    EXPECT_GT(now[1], 0.3F) << "red alone is for danger";
    before = now;
  }
  EXPECT_EQ(contactColour(0.001), contactColour(0.5));
  EXPECT_EQ(contactColour(-1.0), contactColour(0.0));
}

TEST(Theme, TextHasAContrastOfFourAndAHalfToOneOrBetter) {
  for (const Theme& t : {Theme::dark(), Theme::bright()}) {
    for (const ImVec4& ground : {t.ground, t.panel, t.raised}) {
      EXPECT_GE(contrastRatio(t.text, ground), 4.5) << t.light;
      EXPECT_GE(contrastRatio(t.secondary, ground), 4.5) << t.light;
    }
    EXPECT_GE(contrastRatio(t.onAccent, t.accent), 4.5) << t.light;
  }
  // Closed form: black on white.
  EXPECT_NEAR(contrastRatio({0, 0, 0, 1}, {1, 1, 1, 1}), 21.0, 1e-6);
}

TEST(Transfer, NeitherSkinNorSoftTissueOfACtIsSeen) {
  const auto points = transferFor("CT", {400, 2000});
  const int count = 4096;
  const double low = -1024;
  const double high = 3071;
  const auto table = transferTable(points, low, high, count);
  for (int i = 0; i < count; ++i) {
    const double hu = low + (high - low) * (i + 0.5) / count;
    const int alpha = table[static_cast<std::size_t>(i) * 4 + 3];
    EXPECT_TRUE(hu >= 180 || alpha == 0) << hu;
    EXPECT_TRUE(hu <= 500 || alpha > 90) << hu;
  }
}

TEST(Script, RefusesALineThatIsNoCommandByItsNumber) {
  const auto script = UiScript::parse("wait 2\n# a comment\nclikc 1 2\n", "test.txt");
  ASSERT_FALSE(script);
  EXPECT_EQ(script.error().field, "line 3");
  EXPECT_EQ(script.error().found, "clikc 1 2");
}

TEST(Script, AClickIsAMoveAPressAndARelease) {
  auto script = UiScript::parse("click-item Start now", "test.txt");
  ASSERT_TRUE(script);
  const std::map<std::string, Rect> items{{"Start now", {10, 20, 100, 40}}};
  const auto move = script->next(items, true);
  ASSERT_TRUE(move);
  EXPECT_EQ(move->moveTo, std::make_pair(60.0F, 40.0F));
  EXPECT_EQ(script->next(items, true)->button, std::make_pair(0, true));
  EXPECT_EQ(script->next(items, true)->button, std::make_pair(0, false));
  EXPECT_TRUE(script->finished());
}

TEST(Script, APhaseIsNamedInTheFrameThatBeginsIt) {
  auto script = UiScript::parse("phase undo and redo\nwait 1", "test.txt");
  ASSERT_TRUE(script);
  EXPECT_EQ(script->next({}, true)->phase, "undo and redo");
  EXPECT_EQ(script->next({}, true)->phase, std::nullopt);
}

TEST(Script, AControlThatIsNotThereIsAnError) {
  auto script = UiScript::parse("click-item Nowhere", "test.txt");
  ASSERT_TRUE(script);
  const auto input = script->next({}, true);
  ASSERT_FALSE(input);
  EXPECT_EQ(input.error().kind, ErrorKind::CheckFailed);
  EXPECT_EQ(input.error().found, "Nowhere");
}

TEST(Script, WaitIdleEndsWhenNoJobRuns) {
  auto script = UiScript::parse("wait-idle\nquit", "test.txt");
  ASSERT_TRUE(script);
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(script->next({}, false)->quit);
  int frames = 0;
  while (!script->next({}, true)->quit) ASSERT_LT(++frames, 10);
}

TEST(Pictures, CountOnlyPixelsBeyondTwoPerCent) {
  Picture a{10, 10, std::vector<std::uint8_t>(400, 100)};
  Picture b = a;
  b.rgba[0] = 105;   // 5 of 255: not beyond
  b.rgba[41] = 106;  // beyond
  const PictureDifference d = compare(a, b);
  EXPECT_EQ(d.pixelsBeyond, 1U);
  EXPECT_DOUBLE_EQ(d.share, 0.01);
  EXPECT_EQ(d.image.rgba[40], 255);
  EXPECT_EQ(compare(a, Picture{5, 20, b.rgba}).share, 1.0);
}

TEST(Pictures, ComeBackFromAFileAsTheyWere) {
  Picture a{3, 2, {}};
  for (int i = 0; i < 24; ++i)
    a.rgba.push_back(static_cast<std::uint8_t>(i % 4 == 3 ? 255 : i * 9));
  const auto file = std::filesystem::temp_directory_path() / "palpate_picture_test.png";
  ASSERT_TRUE(writePng(a, file));
  const auto b = readPng(file);
  ASSERT_TRUE(b) << sentence(b.error());
  EXPECT_EQ(b->rgba, a.rgba);
  std::filesystem::remove(file);
  const auto refused = writePng(a, "/nowhere/at/all.png");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::Machine);
}

// A name of the DICOM standard: Yamada Tarou, and Hong Gildong.
constexpr const char* kYamada = "\xe5\xb1\xb1\xe7\x94\xb0\xe3\x81\x9f";
constexpr const char* kHong = "\xed\x99\x8d";

class FontsTest : public ::testing::Test {
 protected:
  void SetUp() override { ImGui::CreateContext(); }
  void TearDown() override { ImGui::DestroyContext(); }
  static bool has(const Fonts& fonts, ImWchar c) {
    return fonts.body->FindGlyphNoFallback(c) != nullptr &&
           fonts.secondary->FindGlyphNoFallback(c) != nullptr;
  }
};

TEST_F(FontsTest, NamesInOtherScriptsAreLoadedWhenTheyAreNeeded) {
  RareCharacters rare;
  auto fonts = loadFonts("/usr/share/fonts", 1.0F, rare);
  ASSERT_TRUE(fonts) << sentence(fonts.error());
  EXPECT_FALSE(has(*fonts, 0x5c71)) << "at the start only what every window needs";
  EXPECT_TRUE(rare.add(kYamada));
  EXPECT_TRUE(rare.add(kHong));
  fonts = loadFonts("/usr/share/fonts", 1.0F, rare);
  ASSERT_TRUE(fonts) << sentence(fonts.error());
  for (const char16_t c : {u'\u5c71', u'\u7530', u'\u305f', u'\ud64d'}) {
    EXPECT_TRUE(has(*fonts, c)) << static_cast<int>(c);
  }
  EXPECT_FALSE(has(*fonts, 0x5c72)) << "and no others";
  EXPECT_EQ(fonts->body->FindGlyph('0')->AdvanceX, fonts->body->FindGlyph('1')->AdvanceX);
}

TEST_F(FontsTest, WithoutTheFontOfOtherScriptsTheRestStillLoads) {
  char name[] = "/tmp/palpate_fonts_XXXXXX";
  const std::filesystem::path folder = ::mkdtemp(name);
  std::filesystem::create_directory(folder / "truetype");
  std::filesystem::create_directory_symlink("/usr/share/fonts/opentype", folder / "opentype");
  std::filesystem::create_directory_symlink("/usr/share/fonts/truetype/font-awesome",
                                            folder / "truetype/font-awesome");
  RareCharacters rare;
  EXPECT_TRUE(rare.add(kYamada));
  const auto fonts = loadFonts(folder, 1.0F, rare);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(fonts) << sentence(fonts.error());
  EXPECT_FALSE(has(*fonts, 0x5c71));
  EXPECT_TRUE(has(*fonts, 'a'));
  EXPECT_EQ(fonts->body->FallbackChar, '?');
}

TEST(RareCharacters, AreWhatTheFontsDoNotAlwaysHold) {
  RareCharacters rare;
  EXPECT_FALSE(rare.add("Doe \xc2\xb7 256 \xc3\x97 256, \xd0\x9b\xd1\x8e, \xce\x94"))
      << "Latin, Cyrillic, Greek, signs";
  EXPECT_FALSE(rare.add("\xff\xfe\xe5\xb1")) << "broken UTF-8";
  EXPECT_FALSE(rare.add("\xf0\xa0\x80\x80")) << "beyond the plane that ImGui knows";
  EXPECT_TRUE(rare.add(kYamada));
  EXPECT_FALSE(rare.add(kYamada)) << "known by now";
  EXPECT_TRUE(rare.add("\xe5\xb1\xb2")) << "the one behind the first";
  EXPECT_EQ(rare.ranges(),
            (std::vector<ImWchar>{0x305f, 0x305f, 0x5c71, 0x5c72, 0x7530, 0x7530, 0}));
}

class StripTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ImGui::CreateContext();
    auto fonts = loadFonts("/usr/share/fonts", 1.0F);
    if (!fonts) GTEST_SKIP() << sentence(fonts.error());
    fonts_ = *fonts;
  }
  void TearDown() override { ImGui::DestroyContext(); }
  Fonts fonts_;
};

TEST_F(StripTest, ColumnsStayWhereTheyAreWhateverTheNumbers) {
  Model model;
  Snapshot small;
  Snapshot large;
  large.felt.force[1] = 43.21;
  large.contacts = 99999;
  large.depth = 0.0123;
  large.stepTime = {8765, 98765, 0, 0};
  large.tickTime = {1111, 11111, 0, 0};
  large.ticksMissed = 9999;
  model.simulate.trade.rows = {{"default", 0.12, 0.05, 90, 310, true}};
  std::vector<std::vector<StripColumn>> all;
  for (const Snapshot* s :
       {static_cast<const Snapshot*>(nullptr), static_cast<const Snapshot*>(&small),
        static_cast<const Snapshot*>(&large)}) {
    model.snapshot = s;
    all.push_back(stripColumns(model, 14, 1266, 1.0F, fonts_.secondary));
  }
  ASSERT_EQ(all[0].size(), 8U);
  for (std::size_t i = 0; i < all[0].size(); ++i) {
    EXPECT_FLOAT_EQ(all[0][i].x, all[1][i].x) << all[1][i].text;
    EXPECT_FLOAT_EQ(all[1][i].x, all[2][i].x) << all[2][i].text;
    const float before = i > 0 ? all[2][i - 1].x + all[2][i - 1].width : 0.0F;
    EXPECT_GE(all[2][i].x, before) << "overlap";
    EXPECT_LE(all[2][i].x + all[2][i].width, 1266.0F);
  }
}

TEST(TradeWords, SettingsReadAsSentencesDo) {
  EXPECT_EQ(settingWords("default"), "as the scene says");
  EXPECT_EQ(settingWords("shell=1.00mm"), "a point every 1.00 mm");
  EXPECT_EQ(settingWords("iterations=20"), "20 impulses a step");
  EXPECT_EQ(settingWords("leaf=voxel"), "voxel leaves");
  EXPECT_EQ(settingWords("rate=500Hz"), "500 Hz");
  EXPECT_EQ(settingWords("something=new"), "something=new");
  EXPECT_EQ(settingWords("shell=1.00mm iterations=20"),
            "a point every 1.00 mm, 20 impulses a step");
}

TEST(TradeWords, NumbersAreThoseOfTheChosenRow) {
  TradeModel trade;
  EXPECT_EQ(errorText(trade), "error not measured");
  trade.rows = {{"default", 0.1, 0.5, 9, 20, true}, {"shell=1.00mm", 0.12, 0.05, 90, 310, true}};
  trade.chosen = 1;
  EXPECT_EQ(numbersText(trade.rows[1]), "0.12 mm, 0.05 N, 310 \xc2\xb5s");
  EXPECT_EQ(errorText(trade),
            "\xc2\xb1"
            "0.12 mm  \xc2\xb1"
            "0.05 N");
}

}  // namespace
}  // namespace palpate::ui
