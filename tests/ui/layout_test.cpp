#include "ui/layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace palpate::ui {
namespace {

std::vector<Rect> parts(const Layout& layout) {
  std::vector<Rect> all{layout.header, layout.panel, layout.strip};
  for (const Rect& view : layout.view) all.push_back(view);
  return all;
}

struct Size {
  float width, height, scale;
};

class LayoutTest : public ::testing::TestWithParam<Size> {};

TEST_P(LayoutTest, NothingOverlapsAndNothingSticksOut) {
  const auto [width, height, scale] = GetParam();
  const auto all = parts(computeLayout(width, height, scale, std::nullopt));
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_GT(all[i].w, 0.0F) << i;
    EXPECT_GT(all[i].h, 0.0F) << i;
    EXPECT_GE(all[i].x, 0.0F) << i;
    EXPECT_GE(all[i].y, 0.0F) << i;
    EXPECT_LE(all[i].right(), width) << i;
    EXPECT_LE(all[i].bottom(), height) << i;
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      EXPECT_FALSE(all[i].overlaps(all[j])) << i << " and " << j;
    }
  }
}

TEST_P(LayoutTest, TheThreeDimensionalViewIsTheLargest) {
  const auto [width, height, scale] = GetParam();
  const Layout layout = computeLayout(width, height, scale, std::nullopt);
  for (std::size_t i = 1; i < kViews; ++i) {
    EXPECT_GT(layout.view[0].w * layout.view[0].h, 2.0F * layout.view[i].w * layout.view[i].h);
  }
  EXPECT_FLOAT_EQ(layout.panel.w, std::round(300.0F * scale));
}

INSTANTIATE_TEST_SUITE_P(Sizes, LayoutTest,
                         ::testing::Values(Size{1280, 800, 1}, Size{1920, 1080, 1},
                                           Size{2560, 1600, 2}, Size{1920, 1200, 1.5F},
                                           Size{3840, 2160, 2}));

TEST(Layout, AFilledViewTakesThePlaceOfPanelAndViews) {
  for (std::size_t v = 0; v < kViews; ++v) {
    const Layout layout = computeLayout(1280, 800, 1, static_cast<View>(v));
    for (std::size_t i = 0; i < kViews; ++i) {
      if (i == v) continue;
      EXPECT_EQ(layout.view[i].w * layout.view[i].h, 0.0F);
    }
    EXPECT_EQ(layout.view[v].w, 1280.0F);
    EXPECT_FLOAT_EQ(layout.view[v].h, layout.strip.y - layout.header.bottom());
  }
}

TEST(Layout, ATinyWindowNeverGivesNegativeSizes) {
  const Layout layout = computeLayout(200, 60, 1, std::nullopt);
  for (const Rect& view : layout.view) {
    EXPECT_GE(view.w, 0.0F);
    EXPECT_GE(view.h, 0.0F);
  }
}

}  // namespace
}  // namespace palpate::ui
