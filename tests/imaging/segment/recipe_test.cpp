/// Recipes: what is written is read again to the last bit; what is broken is refused by its field.

#include "imaging/segment/recipe.h"

#include <bit>
#include <cmath>
#include <limits>

#include "imaging/segment/packed_labels.h"
#include "tests/imaging/demo_files.h"
#include "tests/imaging/segment/samples.h"
#include "tests/imaging/volume_samples.h"

namespace palpate::test {
namespace {

namespace fs = std::filesystem;

Result<std::vector<LabelStep>> readText(const std::string& text) {
  const TestFolder folder;
  writeBytes(folder / "recipe.toml", text);
  return readRecipe(folder / "recipe.toml");
}

// Equality to the last bit, so that -0.0 and 0.0 differ.

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same(const ThresholdRange& a, const ThresholdRange& b) {
  return same(a.low, b.low) && same(a.high, b.high);
}
template <int Rows, int Columns>
bool same(const Eigen::Matrix<double, Rows, Columns>& a,
          const Eigen::Matrix<double, Rows, Columns>& b) {
  for (Eigen::Index n = 0; n < a.size(); ++n) {
    if (!same(a.data()[n], b.data()[n])) return false;
  }
  return true;
}
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const T& x, const T& y) { return same(x, y); });
}
template <class T>
bool same(const std::optional<T>& a, const std::optional<T>& b) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}
bool same(const tool::Threshold& a, const tool::Threshold& b) {
  return same(a.range, b.range) && a.largestOnly == b.largestOnly && same(a.minMm3, b.minMm3);
}
bool same(const tool::GrowRegion& a, const tool::GrowRegion& b) {
  return same(a.seeds_mm, b.seeds_mm) && same(a.range, b.range) && same(a.reach_mm, b.reach_mm);
}
bool same(const tool::Islands& a, const tool::Islands& b) {
  return a.keep == b.keep && a.count == b.count && same(a.minMm3, b.minMm3) &&
         same(a.picks_mm, b.picks_mm);
}
bool same(const tool::FillHoles& a, const tool::FillHoles& b) {
  return same(a.maxMm3, b.maxMm3);
}
bool same(const tool::Margin& a, const tool::Margin& b) {
  return a.operation == b.operation && same(a.mm, b.mm);
}
bool same(const tool::Smooth& a, const tool::Smooth& b) {
  return same(a.mm, b.mm) && a.keepThin == b.keepThin;
}
bool same(const tool::Box& a, const tool::Box& b) {
  return same(a.low_mm, b.low_mm) && same(a.high_mm, b.high_mm) && a.keepInside == b.keepInside &&
         a.allLabels == b.allLabels;
}
bool same(const tool::Scissors& a, const tool::Scissors& b) {
  return same(a.view, b.view) && same(a.outline, b.outline) && a.keepInside == b.keepInside &&
         same(a.plane_mm, b.plane_mm) && same(a.depth_mm, b.depth_mm);
}
bool same(const tool::Brush& a, const tool::Brush& b) {
  return same(a.path_mm, b.path_mm) && same(a.radius_mm, b.radius_mm) && same(a.normal, b.normal) &&
         a.erase == b.erase;
}
bool same(const tool::Split& a, const tool::Split& b) {
  if (a.by != b.by || !same(a.radius_mm, b.radius_mm)) return false;
  if (a.seeds.size() != b.seeds.size()) return false;
  for (std::size_t n = 0; n < a.seeds.size(); ++n) {
    if (a.seeds[n].label != b.seeds[n].label) return false;
    if (!same(a.seeds[n].points_mm, b.seeds[n].points_mm)) return false;
  }
  return true;
}
bool same(const tool::Combine& a, const tool::Combine& b) {
  return a.operation == b.operation && a.other == b.other && same(a.grown_mm, b.grown_mm);
}
bool same(const tool::Remove&, const tool::Remove&) {
  return true;
}
bool same(const LabelStep& a, const LabelStep& b) {
  if (a.label != b.label || a.preset != b.preset || a.tool.index() != b.tool.index()) return false;
  if (a.limits.overOthers != b.limits.overOthers || !same(a.limits.only, b.limits.only)) {
    return false;
  }
  if (a.preset) {  // The volume decides the range.
    const auto& x = std::get<tool::Threshold>(a.tool);
    const auto& y = std::get<tool::Threshold>(b.tool);
    return x.largestOnly == y.largestOnly && same(x.minMm3, y.minMm3);
  }
  return std::visit(
      [&b](const auto& tool) { return same(tool, std::get<std::decay_t<decltype(tool)>>(b.tool)); },
      a.tool);
}

/// Numbers that lose a bit easily: all of the mantissa, whole ones, tiny, large, a negative zero.
double anyNumber(Random& random) {
  switch (random.whole(0, 7)) {
    case 0:
      return random.whole(-2000, 2000);
    case 1:
      return random.whole(-20, 20) / 10.0;
    case 2:
      return -0.0;
    case 3:
      return random.real(-1.0, 1.0) * 1e-9;
    case 4:
      return random.real(-1.0, 1.0) * 1e7;
    case 5:
      return std::nextafter(random.whole(1, 9) / 10.0, random.chance(50) ? 0.0 : 1.0);
    default:
      return random.real(-300.0, 300.0);
  }
}

double anyLength(Random& random) {
  switch (random.whole(0, 3)) {
    case 0:
      return random.whole(1, 9);
    case 1:
      return std::nextafter(random.whole(1, 50) / 10.0, random.chance(50) ? 0.0 : 9.0);
    default:
      return random.real(0.1, 10.0);
  }
}

Eigen::Vector3d anyPoint(Random& random) {
  const double x = anyNumber(random);
  const double y = anyNumber(random);
  return {x, y, anyNumber(random)};
}

std::vector<Eigen::Vector3d> anyPoints(Random& random) {
  std::vector<Eigen::Vector3d> points(static_cast<std::size_t>(random.whole(1, 5)));
  for (auto& point : points) point = anyPoint(random);
  return points;
}

ThresholdRange anyRange(Random& random) {
  const double a = anyNumber(random);
  const double b = anyNumber(random);
  return {std::min(a, b), std::max(a, b)};
}

std::string anyLabel(Random& random) {
  static const std::vector<std::string> names{"bone",       "nerve \"VII\"",
                                              "it's",       "C:\\teeth\\new",
                                              "Zähne ⅓ 歯", "#1 = [x]",
                                              "a'''b",      "\"\"\"",
                                              " spaced ",   "[[step]]",
                                              "{label}",    "true",
                                              "x\ty",       "0",
                                              "\\u0041",    "''"};
  return names[static_cast<std::size_t>(random.whole(0, static_cast<int>(names.size()) - 1))];
}

tool::Islands anyIslands(Random& random) {
  tool::Islands tool{.keep = static_cast<tool::Islands::Keep>(random.whole(0, 3))};
  if (tool.keep == tool::Islands::Keep::Largest) {
    tool.count = static_cast<std::size_t>(random.whole(1, 1000));
  } else if (tool.keep == tool::Islands::Keep::AtLeast) {
    tool.minMm3 = anyLength(random);
  } else {
    tool.picks_mm = anyPoints(random);
  }
  return tool;
}

tool::Scissors anyScissors(Random& random) {
  tool::Scissors tool{.keepInside = random.chance(50)};
  for (Eigen::Index n = 0; n < 12; ++n) tool.view.data()[n] = anyNumber(random);
  for (int n = random.whole(3, 12); n > 0; --n) {
    const double u = anyNumber(random);
    tool.outline.emplace_back(u, anyNumber(random));
  }
  if (random.chance(50)) {
    const double w = anyNumber(random);
    const Eigen::Vector3d normal = random.point(-1, 1).normalized();
    tool.plane_mm = Eigen::Vector4d(normal.x(), normal.y(), normal.z(), w);
    tool.depth_mm = anyLength(random);
  }
  return tool;
}

tool::Split anySplit(Random& random) {
  tool::Split tool{.by = static_cast<tool::Split::By>(random.whole(0, 1))};
  if (random.chance(50)) tool.radius_mm = anyLength(random);
  for (int n = random.whole(1, 4); n > 0; --n) {
    tool.seeds.push_back({anyLabel(random) + std::to_string(n), anyPoints(random)});
  }
  return tool;
}

LabelTool anyTool(Random& random, std::size_t kind) {
  switch (kind) {
    case 0:
      return tool::Threshold{.range = anyRange(random),
                             .largestOnly = random.chance(50),
                             .minMm3 = random.chance(50) ? anyLength(random) : 0.0};
    case 1:
      return tool::GrowRegion{.seeds_mm = anyPoints(random),
                              .range = anyRange(random),
                              .reach_mm = random.chance(50) ? anyLength(random) : 0.0};
    case 2:
      return anyIslands(random);
    case 3:
      return tool::FillHoles{.maxMm3 = random.chance(50) ? anyLength(random) : 0.0};
    case 4:
      return tool::Margin{.operation = static_cast<tool::Margin::Operation>(random.whole(0, 3)),
                          .mm = anyLength(random)};
    case 5:
      return tool::Smooth{.mm = anyLength(random), .keepThin = random.chance(50)};
    case 6: {
      const Eigen::Vector3d a = anyPoint(random);
      const Eigen::Vector3d b = anyPoint(random);
      return tool::Box{.low_mm = a.cwiseMin(b),
                       .high_mm = a.cwiseMax(b),
                       .keepInside = random.chance(50),
                       .allLabels = random.chance(50)};
    }
    case 7:
      return anyScissors(random);
    case 8: {
      tool::Brush tool{.path_mm = anyPoints(random), .radius_mm = anyLength(random)};
      if (random.chance(50)) tool.normal = random.point(-1, 1).normalized();
      tool.erase = random.chance(50);
      return tool;
    }
    case 9:
      return anySplit(random);
    case 10:
      return tool::Combine{.operation = static_cast<tool::Combine::Operation>(random.whole(0, 2)),
                           .other = anyLabel(random) + "!",
                           .grown_mm = random.chance(50) ? anyLength(random) : 0.0};
    default:
      return tool::Remove{};
  }
}

LabelStep anyStep(Random& random, std::size_t kind) {
  LabelStep step;
  step.label = anyLabel(random);
  step.tool = anyTool(random, kind);
  step.limits.overOthers = random.chance(50);
  if (random.chance(50)) step.limits.only = anyRange(random);
  if (kind == 0 && random.chance(40)) {
    step.preset = segmentationPresets()[static_cast<std::size_t>(random.whole(0, 5))].name;
  }
  return step;
}

TEST(Recipe, ReadsWhatItWroteToTheLastBit) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    std::vector<LabelStep> steps;
    for (int n = random.whole(1, 6); n > 0; --n) {
      const int last = static_cast<int>(std::variant_size_v<LabelTool>) - 1;
      steps.push_back(anyStep(random, static_cast<std::size_t>(random.whole(0, last))));
    }
    const std::string text = recipeText(steps);
    const auto back = readText(text);
    ASSERT_TRUE(back) << sentence(back.error()) << "\n" << text;
    ASSERT_EQ(back->size(), steps.size()) << text;
    for (std::size_t n = 0; n < steps.size(); ++n) {
      EXPECT_TRUE(same(steps[n], (*back)[n])) << "step " << n << " of\n" << text;
    }
    EXPECT_EQ(recipeText(*back), text);
    if (HasFailure()) return;
  }
}

TEST(Recipe, EachToolAloneIsReadAgain) {
  for (std::size_t kind = 0; kind < std::variant_size_v<LabelTool>; ++kind) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
      Random random(seed);
      const std::vector<LabelStep> steps{anyStep(random, kind)};
      ASSERT_EQ(steps[0].tool.index(), kind) << "the test lost a tool";
      const std::string text = recipeText(steps);
      const auto back = readText(text);
      ASSERT_TRUE(back) << sentence(back.error()) << "\n" << text;
      ASSERT_EQ(back->size(), 1U);
      ASSERT_TRUE(same(steps[0], (*back)[0])) << text;
    }
  }
}

template <std::size_t... Kinds>
std::vector<LabelTool> defaultTools(std::index_sequence<Kinds...>) {
  return {LabelTool(std::in_place_index<Kinds>)...};
}

TEST(Recipe, ATitleAWordAndAReaderForEveryToolAsItsTypeMakesIt) {
  const std::vector<LabelTool> tools =
      defaultTools(std::make_index_sequence<std::variant_size_v<LabelTool>>());
  for (const LabelTool& tool : tools) {
    EXPECT_FALSE(toolTitle(tool).empty());
    LabelStep step;
    step.label = "a";
    step.tool = tool;
    // What a user has to give before the step says anything.
    if (auto* grow = std::get_if<tool::GrowRegion>(&step.tool)) grow->seeds_mm = {{1, 2, 3}};
    if (auto* brush = std::get_if<tool::Brush>(&step.tool)) brush->path_mm = {{1, 2, 3}};
    if (auto* cut = std::get_if<tool::Scissors>(&step.tool))
      cut->outline = {{0, 0}, {1, 0}, {0, 1}};
    if (auto* split = std::get_if<tool::Split>(&step.tool)) split->seeds = {{"b", {{1, 2, 3}}}};
    if (auto* combine = std::get_if<tool::Combine>(&step.tool)) combine->other = "b";
    const std::string text = recipeText({step});
    EXPECT_TRUE(tool.index() == 0 || text.find("tool = ") != std::string::npos) << text;
    const auto back = readText(text);
    ASSERT_TRUE(back) << sentence(back.error()) << "\n" << text;
    ASSERT_EQ(back->size(), 1U);
    EXPECT_TRUE(same(step, back->front())) << text;
  }
}

/// One step of a recipe, which must be readable.
LabelStep stepOf(const std::string& text) {
  const auto steps = readText("[[step]]\n" + text);
  EXPECT_TRUE(steps) << sentence(steps.error()) << "\n" << text;
  EXPECT_TRUE(!steps || steps->size() == 1);
  return steps && !steps->empty() ? steps->front() : LabelStep{};
}

template <class Tool>
Tool toolOf(const std::string& text) {
  const LabelStep step = stepOf(text);
  const Tool* tool = std::get_if<Tool>(&step.tool);
  EXPECT_NE(tool, nullptr) << text << "\nis another tool";
  return tool != nullptr ? *tool : Tool{};
}

TEST(Recipe, KeysAndDefaultsAreThoseOfTheManual) {
  EXPECT_TRUE(same(toolOf<tool::Threshold>("tool = 'threshold'\nthreshold = [1, 2]\nlabel = 'a'"),
                   tool::Threshold{.range = {1, 2}}));
  EXPECT_TRUE(same(toolOf<tool::GrowRegion>("tool = 'grow'\nlabel = 'a'\nthreshold = [-1, 2.5]\n"
                                            "seeds = [[1, 2, 3], [4.5, -5, 6]]"),
                   tool::GrowRegion{.seeds_mm = {{1, 2, 3}, {4.5, -5, 6}}, .range = {-1, 2.5}}));
  EXPECT_TRUE(same(toolOf<tool::GrowRegion>("tool = 'grow'\nlabel = 'a'\nthreshold = [-1, 2.5]\n"
                                            "seeds = [[1, 2, 3]]\nreach_mm = 7"),
                   tool::GrowRegion{.seeds_mm = {{1, 2, 3}}, .range = {-1, 2.5}, .reach_mm = 7}));
  using Islands = tool::Islands;
  EXPECT_TRUE(same(toolOf<Islands>("tool = 'islands'\nlabel = 'a'\nkeep = 'largest'"),
                   Islands{.keep = Islands::Keep::Largest, .count = 1}));
  EXPECT_TRUE(same(toolOf<Islands>("tool = 'islands'\nlabel = 'a'\nkeep = 'largest'\ncount = 4"),
                   Islands{.keep = Islands::Keep::Largest, .count = 4}));
  EXPECT_TRUE(
      same(toolOf<Islands>("tool = 'islands'\nlabel = 'a'\nkeep = 'at-least'\nmin_mm3 = 2.5"),
           Islands{.keep = Islands::Keep::AtLeast, .minMm3 = 2.5}));
  EXPECT_TRUE(
      same(toolOf<Islands>("tool = 'islands'\nlabel = 'a'\nkeep = 'picked'\npicks = [[1, 2, 3]]"),
           Islands{.keep = Islands::Keep::Picked, .picks_mm = {{1, 2, 3}}}));
  EXPECT_TRUE(same(
      toolOf<Islands>("tool = 'islands'\nlabel = 'a'\nkeep = 'not-picked'\npicks = [[1, 2, 3]]"),
      Islands{.keep = Islands::Keep::NotPicked, .picks_mm = {{1, 2, 3}}}));
  EXPECT_TRUE(same(toolOf<tool::FillHoles>("tool = 'fill-holes'\nlabel = 'a'"), tool::FillHoles{}));
  EXPECT_TRUE(same(toolOf<tool::FillHoles>("tool = 'fill-holes'\nlabel = 'a'\nmax_mm3 = 3"),
                   tool::FillHoles{.maxMm3 = 3}));
  using Margin = tool::Margin;
  for (const auto& [word, operation] :
       {std::pair{"dilate", Margin::Operation::Dilate},
        std::pair{"erode", Margin::Operation::Erode}, std::pair{"open", Margin::Operation::Open},
        std::pair{"close", Margin::Operation::Close}}) {
    EXPECT_TRUE(same(toolOf<Margin>("tool = 'margin'\nlabel = 'a'\nmm = 2\noperation = '" +
                                    std::string(word) + "'"),
                     Margin{.operation = operation, .mm = 2}))
        << word;
  }
  EXPECT_TRUE(same(toolOf<tool::Smooth>("tool = 'smooth'\nlabel = 'a'\nmm = 0.7"),
                   tool::Smooth{.mm = 0.7, .keepThin = true}));
  EXPECT_TRUE(same(toolOf<tool::Smooth>("tool = 'smooth'\nlabel = 'a'\nmm = 2\nkeep_thin = false"),
                   tool::Smooth{.mm = 2, .keepThin = false}));
  EXPECT_TRUE(
      same(toolOf<tool::Box>("tool = 'box'\nlabel = 'a'\nlow = [1, 2, 3]\nhigh = [4, 5, 6]"),
           tool::Box{.low_mm = {1, 2, 3}, .high_mm = {4, 5, 6}}));
  EXPECT_TRUE(same(
      toolOf<tool::Box>("tool = 'box'\nlabel = 'a'\nlow = [1, 2, 3]\nhigh = [4, 5, 6]\n"
                        "keep_inside = true\nall_labels = true"),
      tool::Box{.low_mm = {1, 2, 3}, .high_mm = {4, 5, 6}, .keepInside = true, .allLabels = true}));
}

TEST(Recipe, KeysOfTheDrawnToolsAreThoseOfTheManual) {
  tool::Scissors scissors;
  scissors.view << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
  scissors.outline = {{0, 1}, {2, 3}, {4, -5.5}};
  const std::string cut =
      "tool = 'scissors'\nlabel = 'a'\nview = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"
      "outline = [[0, 1], [2, 3], [4, -5.5]]\n";
  EXPECT_TRUE(same(toolOf<tool::Scissors>(cut), scissors)) << "the view goes row by row";
  scissors.plane_mm = Eigen::Vector4d(0, 0, 1, -7);
  scissors.depth_mm = 2.5;
  scissors.keepInside = true;
  EXPECT_TRUE(same(toolOf<tool::Scissors>(cut + "plane = [0, 0, 1, -7]\ndepth_mm = 2.5\n"
                                                "keep_inside = true"),
                   scissors));
  const std::string stroke =
      "tool = 'brush'\nlabel = 'a'\npath = [[1, 2, 3], [4, 5, 6]]\nradius_mm = 1.5\n";
  tool::Brush brush{.path_mm = {{1, 2, 3}, {4, 5, 6}}, .radius_mm = 1.5};
  EXPECT_TRUE(same(toolOf<tool::Brush>(stroke), brush));
  brush.normal = Eigen::Vector3d(0, 1, 0);
  brush.erase = true;
  EXPECT_TRUE(same(toolOf<tool::Brush>(stroke + "normal = [0, 1, 0]\nerase = true"), brush));
  for (const auto& [word, by] : {std::pair{"brightness", tool::Split::By::Brightness},
                                 std::pair{"edges", tool::Split::By::Edges}}) {
    EXPECT_TRUE(same(toolOf<tool::Split>("tool = 'split'\nlabel = 'a'\nby = '" + std::string(word) +
                                         "'\n[[step.seeds]]\nlabel = 'b'\npoints = [[1, 2, 3]]\n"
                                         "[[step.seeds]]\nlabel = 'a'\npoints = [[4, 5, 6]]"),
                     tool::Split{.seeds = {{"b", {{1, 2, 3}}}, {"a", {{4, 5, 6}}}}, .by = by}))
        << word;
  }
  using Combine = tool::Combine;
  for (const auto& [word, operation] : {std::pair{"add", Combine::Operation::Add},
                                        std::pair{"subtract", Combine::Operation::Subtract},
                                        std::pair{"intersect", Combine::Operation::Intersect}}) {
    const std::string text =
        "tool = 'combine'\nlabel = 'a'\nother = 'b'\noperation = '" + std::string(word) + "'";
    EXPECT_TRUE(same(toolOf<Combine>(text), Combine{.operation = operation, .other = "b"})) << word;
    EXPECT_TRUE(same(toolOf<Combine>(text + "\ngrown_mm = 2"),
                     Combine{.operation = operation, .other = "b", .grown_mm = 2}))
        << word;
  }
  toolOf<tool::Remove>("tool = 'remove'\nlabel = 'a'");
}

TEST(Recipe, LimitsGoWithEveryTool) {
  const LabelStep with =
      stepOf("tool = 'fill-holes'\nlabel = 'a b'\nover_others = true\nonly = [-7, 8.5]");
  EXPECT_EQ(with.label, "a b");
  EXPECT_TRUE(with.limits.overOthers);
  ASSERT_TRUE(with.limits.only.has_value());
  EXPECT_TRUE(same(*with.limits.only, ThresholdRange{-7, 8.5}));
  const LabelStep without = stepOf("tool = 'fill-holes'\nlabel = 'a'");
  EXPECT_FALSE(without.limits.overOthers);
  EXPECT_FALSE(without.limits.only.has_value());
}

TEST(Recipe, OldRecipesAreStillRead) {
  const auto steps = readText(
      "[[step]]\nthreshold = [-200, 225]\nlabel = \"soft\"\n\n"
      "[[step]]\npreset = \"ct-bone\"\nlargest = true\nmin_mm3 = 10\n\n"
      "[[step]]\npreset = \"ct-bone\"\nlabel = \"skull\"\n");
  ASSERT_TRUE(steps) << sentence(steps.error());
  ASSERT_EQ(steps->size(), 3U);
  LabelStep soft;
  soft.label = "soft";
  soft.tool = tool::Threshold{.range = {-200, 225}};
  EXPECT_TRUE(same((*steps)[0], soft));
  const auto& bone = std::get<tool::Threshold>((*steps)[1].tool);
  EXPECT_EQ((*steps)[1].preset, "ct-bone");
  EXPECT_TRUE(bone.largestOnly);
  EXPECT_EQ(bone.minMm3, 10.0);
  EXPECT_EQ((*steps)[2].label, "skull");

  Sample s = plainSample({4, 1, 1}, {4, 4, 4});
  s.before = {};
  s.volume.int16 = {0, 300, 226, 100};
  LabelState state;
  for (const LabelStep& step : *steps) {
    const auto after = applyStep(s.volume, state, step);
    ASSERT_TRUE(after) << sentence(after.error());
    state = *after;
  }
  ASSERT_EQ(state.table.size(), 3U);
  EXPECT_EQ(state.table[1].name, "bone") << "the preset's label, where the step names none";
  EXPECT_EQ(state.labels.labels, (Mask{1, 3, 3, 1}));
}

struct BrokenRow {
  std::string step;   ///< The keys of the second step.
  std::string field;  ///< Where the error is, or begins.
};

/// Reads the row as a second step after one that is right.
void expectBroken(const BrokenRow& row) {
  SCOPED_TRACE(row.step);
  const TestFolder folder;
  const fs::path file = folder / "recipe.toml";
  writeBytes(file, "[[step]]\npreset = 'ct-bone'\n[[step]]\n" + row.step + "\n");
  const auto steps = readRecipe(file);
  ASSERT_FALSE(steps) << "was read";
  const Error& error = steps.error();
  EXPECT_EQ(error.kind, ErrorKind::InputRefused) << sentence(error);
  EXPECT_EQ(error.file, file.string());
  ASSERT_TRUE(error.field.has_value()) << sentence(error);
  EXPECT_EQ(*error.field, row.field) << sentence(error);
  EXPECT_TRUE(error.expected.has_value() && !error.expected->empty()) << sentence(error);
}

const std::string kMargin = "tool = 'margin'\nlabel = 'a'\noperation = 'close'\n";

TEST(BrokenRecipe, ValuesOutOfRange) {
  for (const char* mm : {"-1", "-0.001", "nan", "inf", "-inf"}) {
    const std::string value = mm;
    expectBroken({kMargin + "mm = " + value, "step[1].mm"});
    expectBroken({"tool = 'smooth'\nlabel = 'a'\nmm = " + value, "step[1].mm"});
    expectBroken({"tool = 'brush'\nlabel = 'a'\npath = [[1, 2, 3]]\nradius_mm = " + value,
                  "step[1].radius_mm"});
    expectBroken(
        {"tool = 'grow'\nlabel = 'a'\nthreshold = [1, 2]\nseeds = [[1, 2, 3]]\n"
         "reach_mm = " +
             value,
         "step[1].reach_mm"});
    expectBroken({"tool = 'fill-holes'\nlabel = 'a'\nmax_mm3 = " + value, "step[1].max_mm3"});
    expectBroken({"tool = 'islands'\nlabel = 'a'\nkeep = 'at-least'\nmin_mm3 = " + value,
                  "step[1].min_mm3"});
    expectBroken({"preset = 'ct-bone'\nmin_mm3 = " + value, "step[1].min_mm3"});
    expectBroken(
        {"tool = 'combine'\nlabel = 'a'\nother = 'b'\noperation = 'add'\ngrown_mm = " + value,
         "step[1].grown_mm"});
    expectBroken(
        {"tool = 'scissors'\nlabel = 'a'\nview = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"
         "outline = [[0, 1], [2, 3], [4, 5]]\nplane = [0, 0, 1, 0]\ndepth_mm = " +
             value,
         "step[1].depth_mm"});
  }
  expectBroken({"tool = 'islands'\nlabel = 'a'\nkeep = 'largest'\ncount = 0", "step[1].count"});
  expectBroken({"tool = 'islands'\nlabel = 'a'\nkeep = 'largest'\ncount = -3", "step[1].count"});
  for (const char* range : {"[3, 2]", "[nan, 2]", "[1, nan]"}) {
    const std::string value = range;
    expectBroken({"label = 'a'\nthreshold = " + value, "step[1].threshold"});
    expectBroken({"preset = 'ct-bone'\nonly = " + value, "step[1].only"});
    expectBroken({"tool = 'grow'\nlabel = 'a'\nseeds = [[1, 2, 3]]\nthreshold = " + value,
                  "step[1].threshold"});
  }
}

TEST(BrokenRecipe, WrongTypes) {
  for (const char* wrong : {"'two'", "true", "[2]", "{x = 2}", "1979-05-27"}) {
    const std::string value = wrong;
    expectBroken({kMargin + "mm = " + value, "step[1].mm"});
    expectBroken({"preset = 'ct-bone'\nmin_mm3 = " + value, "step[1].min_mm3"});
  }
  for (const char* wrong : {"7", "true", "['a']"}) {
    const std::string value = wrong;
    expectBroken({"tool = 'fill-holes'\nlabel = " + value, "step[1].label"});
    expectBroken({"preset = " + value, "step[1].preset"});
    expectBroken({"label = 'a'\ntool = " + value, "step[1].tool"});
    expectBroken(
        {"tool = 'margin'\nlabel = 'a'\nmm = 1\noperation = " + value, "step[1].operation"});
    expectBroken(
        {"tool = 'combine'\nlabel = 'a'\noperation = 'add'\nother = " + value, "step[1].other"});
  }
  for (const char* wrong : {"1", "'true'", "[true]"}) {
    const std::string value = wrong;
    expectBroken({"preset = 'ct-bone'\nlargest = " + value, "step[1].largest"});
    expectBroken({"preset = 'ct-bone'\nover_others = " + value, "step[1].over_others"});
    expectBroken(
        {"tool = 'smooth'\nlabel = 'a'\nmm = 1\nkeep_thin = " + value, "step[1].keep_thin"});
  }
  for (const char* wrong : {"7", "[1]", "[1, 2, 3]", "['a', 'b']", "'1 to 2'"}) {
    const std::string value = wrong;
    expectBroken({"label = 'a'\nthreshold = " + value, "step[1].threshold"});
    expectBroken({"preset = 'ct-bone'\nonly = " + value, "step[1].only"});
  }
  expectBroken({"tool = 'islands'\nlabel = 'a'\nkeep = 'largest'\ncount = 1.5", "step[1].count"});
  expectBroken({"tool = 'box'\nlabel = 'a'\nlow = [1, 2]\nhigh = [4, 5, 6]", "step[1].low"});
  expectBroken({"tool = 'box'\nlabel = 'a'\nlow = [1, 2, 3]\nhigh = 4", "step[1].high"});
  expectBroken(
      {"tool = 'scissors'\nlabel = 'a'\nview = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11]\n"
       "outline = [[0, 1], [2, 3], [4, 5]]",
       "step[1].view"});
  expectBroken({"tool = 'brush'\nlabel = 'a'\npath = [[1, 2, 3]]\nradius_mm = 1\nnormal = [1, 2]",
                "step[1].normal"});
}

TEST(BrokenRecipe, MissingKeys) {
  expectBroken({kMargin, "step[1].mm"});
  expectBroken({"tool = 'margin'\noperation = 'close'\nmm = 1", "step[1].label"});
  expectBroken({"tool = 'margin'\nlabel = 'a'\nmm = 1", "step[1].operation"});
  expectBroken({"tool = 'smooth'\nlabel = 'a'", "step[1].mm"});
  expectBroken({"threshold = [1, 2]", "step[1].label"});
  expectBroken({"tool = 'grow'\nlabel = 'a'\nthreshold = [1, 2]", "step[1].seeds"});
  expectBroken({"tool = 'grow'\nlabel = 'a'\nseeds = [[1, 2, 3]]", "step[1].threshold"});
  expectBroken({"tool = 'islands'\nlabel = 'a'", "step[1].keep"});
  expectBroken({"tool = 'islands'\nlabel = 'a'\nkeep = 'picked'", "step[1].picks"});
  expectBroken({"tool = 'islands'\nlabel = 'a'\nkeep = 'at-least'", "step[1].min_mm3"});
  expectBroken({"tool = 'box'\nlabel = 'a'\nhigh = [4, 5, 6]", "step[1].low"});
  expectBroken({"tool = 'box'\nlabel = 'a'\nlow = [4, 5, 6]", "step[1].high"});
  expectBroken(
      {"tool = 'scissors'\nlabel = 'a'\noutline = [[0, 1], [2, 3], [4, 5]]", "step[1].view"});
  expectBroken({"tool = 'scissors'\nlabel = 'a'\nview = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]",
                "step[1].outline"});
  expectBroken({"tool = 'brush'\nlabel = 'a'\nradius_mm = 1", "step[1].path"});
  expectBroken({"tool = 'brush'\nlabel = 'a'\npath = [[1, 2, 3]]", "step[1].radius_mm"});
  expectBroken({"tool = 'split'\nlabel = 'a'\nby = 'edges'", "step[1].seeds"});
  expectBroken({"tool = 'combine'\nlabel = 'a'\noperation = 'add'", "step[1].other"});
  expectBroken({"tool = 'combine'\nlabel = 'a'\nother = 'b'", "step[1].operation"});
  expectBroken({"tool = 'remove'", "step[1].label"});
  expectBroken({"label = 'a'", "step[1]"});
  expectBroken({"preset = 'ct-bone'\nthreshold = [1, 2]", "step[1]"});
}

TEST(BrokenRecipe, ListsOfPoints) {
  // The field ends at the list or goes on into it.
  const auto begins = [](const std::string& text, const std::string& field) {
    SCOPED_TRACE(text);
    const auto steps = readText("[[step]]\npreset = 'ct-bone'\n[[step]]\n" + text + "\n");
    ASSERT_FALSE(steps) << "was read";
    EXPECT_EQ(steps.error().kind, ErrorKind::InputRefused);
    EXPECT_TRUE(steps.error().field.value_or("").starts_with(field)) << sentence(steps.error());
    EXPECT_TRUE(steps.error().expected.has_value()) << sentence(steps.error());
  };
  for (const char* wrong : {"[]", "[1, 2, 3]", "[[1, 2]]", "[[1, 2, 3, 4]]", "[[1, 2, 3], 4]",
                            "[[1, 2, 'x']]", "[[1, nan, 3]]", "[[1, 2, inf]]", "'all'"}) {
    const std::string value = wrong;
    begins("tool = 'grow'\nlabel = 'a'\nthreshold = [1, 2]\nseeds = " + value, "step[1].seeds");
    begins("tool = 'islands'\nlabel = 'a'\nkeep = 'picked'\npicks = " + value, "step[1].picks");
    begins("tool = 'brush'\nlabel = 'a'\nradius_mm = 1\npath = " + value, "step[1].path");
    begins(
        "tool = 'split'\nlabel = 'a'\nby = 'edges'\n[[step.seeds]]\nlabel = 'b'\npoints = " + value,
        "step[1].seeds[0].points");
  }
  for (const char* wrong : {"[]", "[[0, 1], [2, 3]]", "[[0, 1], [2, 3], [4]]", "[0, 1, 2, 3, 4, 5]",
                            "[[0, 1], [2, 3], [4, nan]]"}) {
    begins(
        "tool = 'scissors'\nlabel = 'a'\nview = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"
        "outline = " +
            std::string(wrong),
        "step[1].outline");
  }
  const std::string split = "tool = 'split'\nlabel = 'a'\nby = 'edges'\n";
  begins(split + "[[step.seeds]]\npoints = [[1, 2, 3]]", "step[1].seeds[0].label");
  begins(split + "[[step.seeds]]\nlabel = 'a'\npoints = [[1, 2, 3]]\n[[step.seeds]]\nlabel = 'b'",
         "step[1].seeds[1].points");
  begins(split + "[[step.seeds]]\nlabel = 'a'\npoints = [[1, 2, 3]]\ncolour = 'red'",
         "step[1].seeds[0].colour");
  begins(split + "seeds = [[1, 2, 3]]", "step[1].seeds");
  begins(split + "seeds = []", "step[1].seeds");
}

TEST(BrokenRecipe, UnknownKeysNameTheKnownOnes) {
  const auto refusal = [](const std::string& text, const std::string& field) {
    expectBroken({text, field});
    const auto steps = readText("[[step]]\npreset = 'ct-bone'\n[[step]]\n" + text + "\n");
    return steps ? std::string() : steps.error().expected.value_or("");
  };
  const auto expectWords = [](const std::string& text, std::initializer_list<const char*> words) {
    for (const char* word : words)
      EXPECT_NE(text.find(word), std::string::npos) << word << " in " << text;
  };
  expectWords(refusal(kMargin + "mm = 1\ncolour = 3", "step[1].colour"),
              {"label", "over_others", "only", "operation", "mm"});
  expectWords(refusal("preset = 'ct-bone'\nsmoothness = 3", "step[1].smoothness"),
              {"preset", "threshold", "label", "largest", "min_mm3"});
  refusal("tool = 'fill-holes'\nlabel = 'a'\nmm = 1", "step[1].mm");
  refusal("preset = 'ct-bone'\nmm = 1", "step[1].mm");
  refusal(kMargin + "mm = 1\nlargest = true", "step[1].largest");
  refusal("tool = 'remove'\nlabel = 'a'\nmm = 1", "step[1].mm");
  expectWords(refusal("label = 'a'\ntool = 'chisel'", "step[1].tool"),
              {"threshold", "grow", "islands", "fill-holes", "margin", "smooth", "box", "scissors",
               "brush", "split", "combine", "remove"});
  expectWords(
      refusal("tool = 'margin'\nlabel = 'a'\nmm = 1\noperation = 'grow'", "step[1].operation"),
      {"dilate", "erode", "open", "close"});
  expectWords(refusal("tool = 'islands'\nlabel = 'a'\nkeep = 'all'", "step[1].keep"),
              {"largest", "at-least", "picked", "not-picked"});
  expectWords(
      refusal("tool = 'combine'\nlabel = 'a'\nother = 'b'\noperation = 'xor'", "step[1].operation"),
      {"add", "subtract", "intersect"});
  expectWords(refusal("tool = 'split'\nlabel = 'a'\nby = 'luck'\n[[step.seeds]]\nlabel = 'a'\n"
                      "points = [[1, 2, 3]]",
                      "step[1].by"),
              {"brightness", "edges"});
}

TEST(BrokenRecipe, FilesThatAreNone) {
  const TestFolder folder;
  const auto missing = readRecipe(folder / "none.toml");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::InputRefused);
  EXPECT_EQ(missing.error().file, (folder / "none.toml").string());
  EXPECT_FALSE(readRecipe(folder.path()));
  for (const char* text : {"", "[[step]\n", "[step]\npreset = 'ct-bone'\n", "step = []\n",
                           "step = 3\n", "step = ['ct-bone']\n", "steps = 1\n",
                           "name = 'x'\n[[step]]\npreset = 'ct-bone'\n", "\xff\xfe\x00"}) {
    SCOPED_TRACE(text);
    const auto steps = readText(text);
    ASSERT_FALSE(steps);
    EXPECT_EQ(steps.error().kind, ErrorKind::InputRefused);
    EXPECT_TRUE(steps.error().file.has_value());
  }
}

TEST(BrokenRecipe, AnEmptyLabelIsNoLabel) {
  expectBroken({"tool = 'fill-holes'\nlabel = ''", "step[1].label"});
  expectBroken({"threshold = [1, 2]\nlabel = ''", "step[1].label"});
  expectBroken({"tool = 'combine'\nlabel = 'a'\noperation = 'add'\nother = ''", "step[1].other"});
}

TEST(InlineSteps, AreReadLikeThoseOfAFile) {
  const auto steps = readSteps({"preset = 'ct-bone', largest = true",
                                "tool = 'margin', label = 'bone', operation = 'close', mm = 2"});
  ASSERT_TRUE(steps) << sentence(steps.error());
  ASSERT_EQ(steps->size(), 2U);
  const auto file = readText(
      "[[step]]\npreset = 'ct-bone'\nlargest = true\n"
      "[[step]]\ntool = 'margin'\nlabel = 'bone'\noperation = 'close'\nmm = 2\n");
  ASSERT_TRUE(file);
  for (std::size_t n = 0; n < 2; ++n) EXPECT_TRUE(same((*steps)[n], (*file)[n]));
}

TEST(InlineSteps, AreRefusedByStepAndKey) {
  const auto broken = readSteps(
      {"preset = 'ct-bone'", "tool = 'margin', label = 'bone', operation = 'close', mm = -2"});
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().field, "step[1].mm") << sentence(broken.error());
  EXPECT_EQ(broken.error().kind, ErrorKind::Usage);
  for (const char* text : {"", "tool", "tool = 'margin', colour = 1", "a = 1 } , { b = 2",
                           "preset = 'ct-bone' }\n[[step]]\npreset = 'ct-air'\nx = { y = 1",
                           "preset = 'ct-bone'\nlargest = true ]", "\xc3\xa9 = 1",
                           "preset = \xe2\x80\x99"
                           "ct-bone\xe2\x80\x99"}) {
    const auto refused = readSteps({text});
    ASSERT_FALSE(refused) << text;
    EXPECT_EQ(refused.error().kind, ErrorKind::Usage) << text;
  }
  EXPECT_TRUE(readSteps({"tool = 'remove', label = 'Z\xc3\xa4hne'"}));
}

TEST(PackedLabels, UnpackToTheLastVoxel) {
  forSamples(60, [](Random&, Sample& s) {
    const auto packed = PackedLabels::pack(s.before.labels);
    ASSERT_TRUE(packed);
    const auto back = packed->unpack();
    ASSERT_TRUE(back);
    EXPECT_TRUE(sameLabels(s.before.labels, *back));
  });
  EXPECT_TRUE(PackedLabels().unpack()->labels.empty());
  EXPECT_TRUE(PackedLabels::pack(LabelGrid{})->unpack()->labels.empty());
}

}  // namespace
}  // namespace palpate::test
