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
