#include "imaging/segment/case_recipe.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "imaging/segment/recipe.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct CaseRecipes : testing::Test {
  CaseRecipes() {
    char name[] = "/tmp/palpate_recipe_XXXXXX";
    folder = ::mkdtemp(name);
  }
  ~CaseRecipes() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  fs::path folder;
};

std::vector<LabelStep> steps() {
  tool::Split split;
  split.seeds = {{"bone", {{1, 2, 3}}}, {"mandible", {{0.1, -2, 1e-7}}}};
  split.radius_mm = 2.0;
  return {{"bone", tool::Threshold{{226, 3071}, true, 12.5}, {}, {}},
          {"bone", split, {true, ThresholdRange{300, 2000}}, {}},
          {"mandible", tool::Combine{tool::Combine::Operation::Subtract, "bone", 1.5}, {}, {}}};
}

TEST_F(CaseRecipes, ComeBackWholeOrAsAPart) {
  for (const bool whole : {true, false}) {
    ASSERT_TRUE(writeCaseRecipe(folder, {steps(), whole}));
    const CaseRecipe read = readCaseRecipe(folder);
    EXPECT_EQ(read.whole, whole);
    EXPECT_EQ(recipeText(read.steps), recipeText(steps()));
  }
}

TEST_F(CaseRecipes, WithoutStepsThereIsNoFile) {
  ASSERT_TRUE(writeCaseRecipe(folder, {steps(), true}));
  ASSERT_TRUE(writeCaseRecipe(folder, {}));
  EXPECT_FALSE(fs::exists(folder / kCaseRecipe));
  EXPECT_TRUE(readCaseRecipe(folder).whole);
  EXPECT_TRUE(readCaseRecipe(folder).steps.empty());
}

TEST_F(CaseRecipes, WhatCannotBeReadIsNotWhole) {
  std::ofstream(folder / kCaseRecipe) << "[[step]\n";
  EXPECT_FALSE(readCaseRecipe(folder).whole);
  EXPECT_TRUE(readCaseRecipe(folder).steps.empty());
}

TEST(StrayLetters, AreRefusedByLineAndInQuotesAreWelcome) {
  const std::string step = "[[step]]\nthreshold = [1, 2]\nlabel = ";
  for (const char* label : {"\"Sch\u00e4del\"", "'Sch\u00e4del'", "\"a\\\"\u00e4\"",
                            "\"\"\"\u00e4\n\u00e4\"\"\"", "'x' # it's \u00e4 \"comment"}) {
    const auto read = parseRecipe(step + label + "\n", "r.toml");
    EXPECT_TRUE(read) << label << ": " << (read ? "" : sentence(read.error()));
  }
  for (const char* stray : {"\"x\"\n\u03dc = 1\n", "\"x\" # a\n[0, \u03dc\n"}) {
    const auto read = parseRecipe(step + stray, "r.toml");
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().field, "line 4");
    EXPECT_EQ(read.error().message,
              "The recipe is not TOML: a letter beyond ASCII is not in quotes.");
  }
}

TEST(RenameLabel, ReachesEveryPlaceThatNamesIt) {
  auto renamed = steps();
  renameLabel(renamed, "bone", "skull");
  EXPECT_EQ(renamed[0].label, "skull");
  EXPECT_EQ(std::get<tool::Split>(renamed[1].tool).seeds[0].label, "skull");
  EXPECT_EQ(std::get<tool::Split>(renamed[1].tool).seeds[1].label, "mandible");
  EXPECT_EQ(renamed[2].label, "mandible");
  EXPECT_EQ(std::get<tool::Combine>(renamed[2].tool).other, "skull");
}

}  // namespace
}  // namespace palpate
