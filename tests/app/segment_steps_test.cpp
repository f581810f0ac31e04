// palpate segment --recipe and --step: all twelve tools by every way there is to run them, what a
// broken step is called, and that a refused one changes nothing.

#include <gtest/gtest.h>

#include "tests/app/ball_suite.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Every tool, each of which changes voxels of the ball (radius 12 mm around 19.5, 19.5, 19.5).
const std::vector<std::string> kSteps{
    "preset = 'ct-bone', largest = true, min_mm3 = 10",
    "tool = 'threshold', label = 'air', threshold = [-1000, -500]",
    "tool = 'grow', label = 'grown', seeds = [[19.5, 19.5, 0]], threshold = [-1000, -500], "
    "reach_mm = 5, over_others = true, only = [-1000, 0]",
    "tool = 'remove', label = 'air'",
    "tool = 'brush', label = 'bone', path = [[18, 19, 19], [21, 20, 20]], radius_mm = 2.5, "
    "erase = true",
    "tool = 'fill-holes', label = 'bone', max_mm3 = 500",
    "tool = 'margin', label = 'bone', operation = 'dilate', mm = 1.5",
    "tool = 'brush', label = 'bone', path = [[2, 2, 30]], radius_mm = 3, normal = [0, 0, 1]",
    "tool = 'islands', label = 'bone', keep = 'picked', picks = [[19.5, 19.5, 19.5]]",
    "tool = 'box', label = 'bone', low = [-1, -1, 25.5], high = [50, 50, 50]",
    "tool = 'smooth', label = 'bone', mm = 1.5, keep_thin = false",
    "tool = 'scissors', label = 'bone', view = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1], "
    "outline = [[0, 0], [12, 0], [12, 40], [0, 40]]",
    "tool = 'split', label = 'bone', by = 'edges', radius_mm = 1, seeds = "
    "[{ label = 'bone', points = [[16, 19, 19]] }, { label = 'half', points = [[28, 19, 19]] }]",
    "tool = 'combine', label = 'grown', operation = 'add', other = 'half', grown_mm = 1"};

std::string recipeOf(const std::vector<std::string>& steps) {
  std::string text;
  for (const std::string& step : steps) text += "{ " + step + " },\n";
  return "step = [\n" + text + "]\n";
}

std::vector<std::string> withSteps(const std::string& place,
                                   const std::vector<std::string>& steps) {
  std::vector<std::string> arguments{"segment", place, "--json"};
  for (const std::string& step : steps) arguments.insert(arguments.end(), {"--step", step});
  return arguments;
}

class SegmentSteps : public BallSuite {
 protected:
  /// A copy of the ball, with the label `bone` or without any.
  static std::string copy(const std::string& name, bool labelled) {
    fs::copy(*folder / "case", *folder / name, fs::copy_options::recursive);
    if (!labelled) {
      for (const char* file : {"labels.mha", "labels.toml", "segment.toml"}) {
        EXPECT_TRUE(fs::remove(*folder / name / file)) << file;
      }
    }
    return at(name);
  }
  static std::string labelsOf(const std::string& name) {
    return contentOf(*folder / name / "labels.mha") + contentOf(*folder / name / "labels.toml");
  }
};

TEST_F(SegmentSteps, AllToolsGiveTheSameByEveryWay) {
  writeText(*folder / "recipe.toml", recipeOf(kSteps));
  const ProgramRun file =
      palpate({"segment", copy("file", false), "--recipe", at("recipe.toml"), "--json"});
  ASSERT_EQ(file.exitCode, 0) << file.err;
  const json found = file.json();
  ASSERT_EQ(found["labels"].size(), 3U) << file.out;
  const char* names[] = {"bone", "grown", "half"};
  for (std::size_t i = 0; i < 3; ++i) {
    const json& row = found["labels"][i];
    EXPECT_EQ(row.size(), 4U) << row;
    EXPECT_EQ(row["name"], names[i]);
    EXPECT_GE(row["value"], 1);
    EXPECT_DOUBLE_EQ(row["mm3"], row["voxels"]);
  }
  EXPECT_GT(found["labels"][0]["voxels"], 500);
  EXPECT_EQ(found["labels"][2]["voxels"], 0) << "combine adds the other's voxels";

  const ProgramRun line = palpate(withSteps(copy("line", false), kSteps));
  ASSERT_EQ(line.exitCode, 0) << line.err;
  EXPECT_EQ(line.json(), found);
  EXPECT_EQ(labelsOf("line"), labelsOf("file"));

  // One command a step: nothing else is kept between steps than what the case holds.
  const std::string place = copy("commands", false);
  std::string before;
  for (const std::string& step : kSteps) {
    const ProgramRun one = palpate(withSteps(place, {step}));
    ASSERT_EQ(one.exitCode, 0) << step << "\n" << one.err;
    EXPECT_NE(labelsOf("commands"), before) << "changes nothing: " << step;
    before = labelsOf("commands");
  }
  EXPECT_EQ(before, labelsOf("file"));

  for (const char* made : {"file", "line", "commands"}) {
    const std::string again = std::string(made) + "-again";
    const fs::path recipe = *folder / made / "segment.toml";
    const ProgramRun run =
        palpate({"segment", copy(again, false), "--recipe", recipe.string(), "--json"});
    ASSERT_EQ(run.exitCode, 0) << run.err;
    EXPECT_EQ(labelsOf(again), labelsOf("file")) << made;
    EXPECT_EQ(contentOf(*folder / again / "segment.toml"), contentOf(recipe)) << made;
  }
}

/// A step that is refused, and the field that says where.
struct Broken {
  const char* step;
  const char* field;  ///< After "step[2].".
  int exitCode;       ///< As --step; in a file it is always 3.
};

const std::vector<Broken> kBroken{
    // Refused as it is read.
    {"preset = 'ct-bone', colour = 3", "colour", 2},
    {"label = 'a', threshold = [3, 1]", "threshold", 2},
    {"tool = 'grow', label = 'a', seeds = [[1, 2]], threshold = [1, 2]", "seeds[0]", 2},
    {"tool = 'islands', label = 'bone', keep = 'small'", "keep", 2},
    {"tool = 'fill-holes', label = 'bone', max_mm3 = 'all'", "max_mm3", 2},
    {"tool = 'margin', label = 'bone', operation = 'close', mm = -2", "mm", 2},
    {"tool = 'smooth', label = 'bone', mm = 1, keep_thin = 1", "keep_thin", 2},
    {"tool = 'box', label = 'bone', low = [0, 0, 0]", "high", 2},
    {"tool = 'scissors', label = 'bone', view = [1, 2, 3], outline = [[0, 0], [1, 0], [1, 1]]",
     "view", 2},
    {"tool = 'brush', label = 'bone', path = [], radius_mm = 2", "path", 2},
    {"tool = 'split', label = 'bone', seeds = [{ label = 'b', points = [[20, 20, 20]] }, "
     "{ label = 'c', points = [[20, 20]] }]",
     "seeds[1].points[0]", 2},
    {"tool = 'combine', label = 'bone', operation = 'add'", "other", 2},
    {"tool = 'remove'", "label", 2},
    {"tool = 'melt', label = 'bone'", "tool", 2},
    {"tool = 'remove', label = 'bone', only = [2, 1]", "only", 2},
    // Refused as it is carried out.
    {"preset = 'ct-wood'", "preset", 2},
    {"label = 'a', threshold = [2000, 3000]", "threshold", 3},
    {"tool = 'grow', label = 'a', seeds = [[20, 20, 99]], threshold = [1, 2]", "seeds[0]", 3},
    {"tool = 'islands', label = 'bone', keep = 'picked', picks = [[0, 0, 0]]", "picks[0]", 3},
    {"tool = 'fill-holes', label = 'nerve'", "label", 3},
    {"tool = 'margin', label = 'bone', operation = 'close', mm = 5000", "mm", 2},
    {"tool = 'margin', label = 'bone', operation = 'erode', mm = 30", "label", 3},
    {"tool = 'box', label = 'bone', low = [9, 9, 9], high = [0, 0, 0]", "low", 2},
    {"tool = 'split', label = 'bone', seeds = [{ label = 'b', points = [[0, 0, 0]] }]",
     "seeds[0].points[0]", 3},
    {"tool = 'combine', label = 'bone', operation = 'add', other = 'nerve'", "other", 3},
    {"tool = 'remove', label = 'nerve'", "label", 3},
};

TEST_F(SegmentSteps, ABrokenLaterStepIsNamedAndNothingChanges) {
  const std::string place = copy("broken", true);
  const std::string recipe = contentOf(*folder / "broken/segment.toml");
  const std::string labels = labelsOf("broken");
  const std::vector<std::string> files = listing(*folder / "broken");
  const auto expectKept = [&](const ProgramRun& run, int exitCode, const Broken& broken) {
    expectRefused(run, exitCode, exitCode == 2 ? "usage" : "input-refused");
    EXPECT_EQ(run.json()["error"]["field"], "step[2]." + std::string(broken.field)) << run.out;
    EXPECT_EQ(labelsOf("broken"), labels);
    EXPECT_EQ(contentOf(*folder / "broken/segment.toml"), recipe);
    EXPECT_EQ(listing(*folder / "broken"), files);
  };
  for (const Broken& broken : kBroken) {
    SCOPED_TRACE(broken.step);
    const std::vector<std::string> steps{
        "label = 'air', threshold = [-1000, -500]",
        "tool = 'margin', label = 'bone', operation = 'erode', mm = 1", broken.step,
        "tool = 'remove', label = 'air'"};
    expectKept(palpate(withSteps(place, steps)), broken.exitCode, broken);
    writeText(*folder / "broken.toml", recipeOf(steps));
    const ProgramRun run = palpate({"segment", place, "--recipe", at("broken.toml"), "--json"});
    expectKept(run, 3, broken);
    EXPECT_EQ(run.json()["error"]["file"], at("broken.toml"));
  }
}

TEST_F(SegmentSteps, WhatIsNoStepIsAUsageError) {
  const std::string place = copy("none", true);
  const std::string labels = labelsOf("none");
  for (const char* step :
       {"", "tool", "tool = 'remove', label = 'bone' }, { tool = 'remove'",
        "tool = 'remove', label = 'bone'\n", "tool = \xe2\x80\x99remove\xe2\x80\x99",
        "\xc3\xa9 = 1", "tool = 'remove', label = 'bone', \xf0\x9d\x92\x9c = 1"}) {
    SCOPED_TRACE(step);
    expectRefused(palpate(withSteps(place, {step})), 2, "usage");
    EXPECT_EQ(labelsOf("none"), labels);
  }
}

}  // namespace
}  // namespace palpate::test
