/// The steps beside a case's labels: what is written is read, and what is not all says so.

#include "imaging/segment/case_recipe.h"

#include "imaging/segment/recipe.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/segment/samples.h"
#include "tests/imaging/volume_samples.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

std::vector<LabelStep> someSteps() {
  std::vector<LabelStep> steps(3);
  steps[0] = {"bone", tool::Threshold{.range = {226, 3071}}, {}, {}};
  steps[1] = {"bone", tool::Combine{.other = "tooth", .grown_mm = 1.5}, {}, {}};
  tool::Split split;
  split.seeds = {{"bone", {{1, 2, 3}}}, {"tooth", {{4, 5, 6}}}};
  steps[2] = {"tooth", split, {true, ThresholdRange{-1, 7}}, {}};
  return steps;
}

TEST(CaseRecipe, IsReadAsItWasWritten) {
  for (const bool whole : {true, false}) {
    const TestFolder folder;
    ASSERT_TRUE(writeCaseRecipe(folder.path(), {someSteps(), whole}));
    const CaseRecipe back = readCaseRecipe(folder.path());
    EXPECT_EQ(back.whole, whole);
    EXPECT_EQ(recipeText(back.steps), recipeText(someSteps()));
    const auto asRecipe = readRecipe(folder / kCaseRecipe);
    ASSERT_TRUE(asRecipe) << sentence(asRecipe.error());
    EXPECT_EQ(recipeText(*asRecipe), recipeText(someSteps())) << "what --recipe reads";
  }
}

TEST(CaseRecipe, ACaseWithoutOneIsWholeAndEmpty) {
  const TestFolder folder;
  const CaseRecipe none = readCaseRecipe(folder.path());
  EXPECT_TRUE(none.steps.empty());
  EXPECT_TRUE(none.whole);
}

TEST(CaseRecipe, WithoutStepsTheFileGoes) {
  const TestFolder folder;
  ASSERT_TRUE(writeCaseRecipe(folder.path(), {someSteps(), true}));
  ASSERT_TRUE(fs::exists(folder / kCaseRecipe));
  ASSERT_TRUE(writeCaseRecipe(folder.path(), {}));
  EXPECT_TRUE(fs::is_empty(folder.path()));
  ASSERT_TRUE(writeCaseRecipe(folder.path(), {})) << "nor was there one";
}

TEST(CaseRecipe, WhatCannotBeReadIsNotWhole) {
  const TestFolder folder;
  for (const char* text :
       {"", "# All that made the labels of this case, in order.\n\n[[step", "x",
        "# All that made the labels of this case, in order.\n\n",
        "# All that made the labels of this case, in order.\n\n[[step]]\na = 1"}) {
    writeBytes(folder / kCaseRecipe, text);
    const CaseRecipe broken = readCaseRecipe(folder.path());
    EXPECT_TRUE(broken.steps.empty()) << text;
    EXPECT_FALSE(broken.whole) << text;
  }
  fs::remove(folder / kCaseRecipe);
  fs::create_directory(folder / kCaseRecipe);
  EXPECT_FALSE(readCaseRecipe(folder.path()).whole);
}

/// Somebody's own recipe, put there: nothing says that it is all.
TEST(CaseRecipe, StepsWithoutTheHeadingAreNotWhole) {
  const TestFolder folder;
  writeBytes(folder / kCaseRecipe, recipeText(someSteps()));
  const CaseRecipe read = readCaseRecipe(folder.path());
  EXPECT_EQ(read.steps.size(), 3U);
  EXPECT_FALSE(read.whole);
}

TEST(CaseRecipe, AFolderThatIsNotThereIsRefused) {
  const TestFolder folder;
  EXPECT_FALSE(writeCaseRecipe(folder / "none", {someSteps(), true}));
}

TEST(CaseRecipe, ALabelIsRenamedInEveryPlace) {
  std::vector<LabelStep> steps = someSteps();
  renameLabel(steps, "tooth", "molar");
  EXPECT_EQ(steps[0].label, "bone");
  EXPECT_EQ(std::get<tool::Combine>(steps[1].tool).other, "molar");
  EXPECT_EQ(steps[1].label, "bone");
  EXPECT_EQ(steps[2].label, "molar");
  const auto& seeds = std::get<tool::Split>(steps[2].tool).seeds;
  EXPECT_EQ(seeds[0].label, "bone");
  EXPECT_EQ(seeds[1].label, "molar");
  renameLabel(steps, "bone", "jaw");
  EXPECT_EQ(recipeText(steps).find("bone"), std::string::npos) << recipeText(steps);
  const std::string before = recipeText(steps);
  renameLabel(steps, "mol", "x");
  EXPECT_EQ(recipeText(steps), before) << "only whole names";
}

/// A step that names its label by its preset is still about that label.
TEST(CaseRecipe, APresetsLabelIsRenamedAndThePresetStays) {
  std::vector<LabelStep> steps(1);
  steps[0].label = "bone";
  steps[0].preset = "ct-bone";
  renameLabel(steps, "bone", "jaw");
  const TestFolder folder;
  ASSERT_TRUE(writeCaseRecipe(folder.path(), {steps, true}));
  const CaseRecipe back = readCaseRecipe(folder.path());
  ASSERT_EQ(back.steps.size(), 1U);
  EXPECT_EQ(back.steps[0].label, "jaw");
  EXPECT_EQ(back.steps[0].preset, "ct-bone");
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
  }
}

}  // namespace
}  // namespace palpate::test
