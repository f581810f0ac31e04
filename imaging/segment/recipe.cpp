#include "imaging/segment/recipe.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "imaging/segment/recipe_reader.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Words of an enumeration, in its order.
const std::vector<std::string> kKeep{"largest", "at-least", "picked", "not-picked"};
const std::vector<std::string> kMargins{"dilate", "erode", "open", "close"};
const std::vector<std::string> kBy{"brightness", "edges"};
const std::vector<std::string> kCombine{"add", "subtract", "intersect"};

LabelTool readThreshold(RecipeReader& step, std::optional<std::string>& preset,
                        std::string& label) {
  tool::Threshold tool;
  preset = step.optionalText("preset");
  const auto range = step.optionalRange("threshold");
  if (preset.has_value() == range.has_value()) {
    step.refuse("", "A step takes a preset or a threshold.", "exactly one");
  }
  if (range) tool.range = *range;
  tool.largestOnly = step.flag("largest", false);
  tool.minMm3 = step.number("min_mm3", 0.0, 0.0);
  label = step.text("label", "");
  if (preset && label.empty()) {  // an unknown one is refused when it is applied
    const Preset* known = presetNamed(*preset);
    label = known != nullptr ? known->label : *preset;
  }
  if (range && label.empty()) step.refuse("label", "A threshold needs a label.", "a name");
  return tool;
}

LabelTool readGrow(RecipeReader& step) {
  tool::GrowRegion tool;
  tool.seeds_mm = step.points("seeds");
  if (const auto range = step.optionalRange("threshold")) {
    tool.range = *range;
  } else {
    step.refuse("threshold", "The range is missing.", "[low, high], low <= high");
  }
  tool.reach_mm = step.number("reach_mm", 0.0, 0.0);
  return tool;
}

LabelTool readIslands(RecipeReader& step) {
  tool::Islands tool;
  tool.keep = static_cast<tool::Islands::Keep>(step.choice("keep", kKeep));
  tool.count = static_cast<std::size_t>(step.count("count", 1, 1));
  using Keep = tool::Islands::Keep;
  tool.minMm3 =
      tool.keep == Keep::AtLeast ? step.number("min_mm3", 0.0) : step.number("min_mm3", 0.0, 0.0);
  const bool picks = tool.keep == Keep::Picked || tool.keep == Keep::NotPicked;
  if (picks || step.has("picks")) tool.picks_mm = step.points("picks");
  return tool;
}

LabelTool readBox(RecipeReader& step) {
  tool::Box tool;
  tool.low_mm = step.vector<3>("low");
  tool.high_mm = step.vector<3>("high");
  tool.keepInside = step.flag("keep_inside", false);
  tool.allLabels = step.flag("all_labels", false);
  return tool;
}

LabelTool readScissors(RecipeReader& step) {
  tool::Scissors tool;
  const Eigen::Matrix<double, 12, 1> rows = step.vector<12>("view");
  for (Eigen::Index r = 0; r < 3; ++r) tool.view.row(r) = rows.segment<4>(4 * r).transpose();
  tool.outline = step.corners("outline");
  tool.keepInside = step.flag("keep_inside", false);
  if (step.has("plane")) tool.plane_mm = step.vector<4>("plane");
  tool.depth_mm = step.number("depth_mm", 0.0, 0.0);
  return tool;
}

LabelTool readBrush(RecipeReader& step) {
  tool::Brush tool;
  tool.path_mm = step.points("path");
  tool.radius_mm = step.number("radius_mm", 0.0);
  if (step.has("normal")) tool.normal = step.vector<3>("normal");
  tool.erase = step.flag("erase", false);
  return tool;
}

LabelTool readSplit(RecipeReader& step) {
  tool::Split tool;
  tool.by = static_cast<tool::Split::By>(step.has("by") ? step.choice("by", kBy) : 0);
  tool.radius_mm = step.number("radius_mm", 0.0, 0.0);
  for (RecipeReader& part : step.tables("seeds")) {
    tool.seeds.push_back({part.text("label"), part.points("points")});
    part.refuseOthers();
    step.take(part);
  }
  return tool;
}

LabelTool readCombine(RecipeReader& step) {
  tool::Combine tool;
  tool.operation = static_cast<tool::Combine::Operation>(step.choice("operation", kCombine));
  tool.other = step.text("other");
  tool.grown_mm = step.number("grown_mm", 0.0, 0.0);
  return tool;
}

const std::vector<std::string> kTools{"threshold", "grow",   "islands", "fill-holes",
                                      "margin",    "smooth", "box",     "scissors",
                                      "brush",     "split",  "combine", "remove"};
static_assert(std::variant_size_v<LabelTool> == 12, "a tool needs a name, a reader and a writer");

LabelTool readTool(RecipeReader& step, LabelStep& into) {
  const std::size_t kind = step.has("tool") ? step.choice("tool", kTools) : 0;
  if (kind == 0) return readThreshold(step, into.preset, into.label);
  into.label = step.text("label");
  switch (kind) {
    case 1:
      return readGrow(step);
    case 2:
      return readIslands(step);
    case 3:
      return tool::FillHoles{step.number("max_mm3", 0.0, 0.0)};
    case 4: {
      const auto operation =
          static_cast<tool::Margin::Operation>(step.choice("operation", kMargins));
      return tool::Margin{operation, step.number("mm", 0.0)};
    }
    case 5:
      return tool::Smooth{step.number("mm", 0.0), step.flag("keep_thin", true)};
    case 6:
      return readBox(step);
    case 7:
      return readScissors(step);
    case 8:
      return readBrush(step);
    case 9:
      return readSplit(step);
    case 10:
      return readCombine(step);
    default:
      return tool::Remove{};
  }
}

LabelStep readStep(RecipeReader& step) {
  LabelStep read;
  read.tool = readTool(step, read);
  read.limits.overOthers = step.flag("over_others", false);
  read.limits.only = step.optionalRange("only");
  step.refuseOthers();
  return read;
}

Result<std::vector<LabelStep>> stepsOf(const toml::table& root, const fs::path& file) {
  RecipeReader reader(root, file, "");
  std::vector<LabelStep> steps;
  for (RecipeReader& step : reader.tables("step")) {
    steps.push_back(readStep(step));
    reader.take(step);
  }
  reader.refuseOthers();
  if (reader.error()) return fail(*reader.error());
  return steps;
}

/// A tool's keys in a table.
struct Writer {
  toml::table& out;

  void operator()(const tool::Threshold& t) const {
    if (!out.contains("preset")) out.insert("threshold", recipe::range(t.range));
    if (t.largestOnly) out.insert("largest", true);
    if (t.minMm3 > 0.0) out.insert("min_mm3", t.minMm3);
  }
  void operator()(const tool::GrowRegion& t) const {
    out.insert("seeds", recipe::vectors(t.seeds_mm));
    out.insert("threshold", recipe::range(t.range));
    out.insert("reach_mm", t.reach_mm);
  }
  void operator()(const tool::Islands& t) const {
    out.insert("keep", kKeep[static_cast<std::size_t>(t.keep)]);
    out.insert("count", static_cast<std::int64_t>(t.count));
    out.insert("min_mm3", t.minMm3);
    if (!t.picks_mm.empty()) out.insert("picks", recipe::vectors(t.picks_mm));
  }
  void operator()(const tool::FillHoles& t) const { out.insert("max_mm3", t.maxMm3); }
  void operator()(const tool::Margin& t) const {
    out.insert("operation", kMargins[static_cast<std::size_t>(t.operation)]);
    out.insert("mm", t.mm);
  }
  void operator()(const tool::Smooth& t) const {
    out.insert("mm", t.mm);
    out.insert("keep_thin", t.keepThin);
  }
  void operator()(const tool::Box& t) const {
    out.insert("low", recipe::vector(t.low_mm));
    out.insert("high", recipe::vector(t.high_mm));
    out.insert("keep_inside", t.keepInside);
    out.insert("all_labels", t.allLabels);
  }
  void operator()(const tool::Scissors& t) const {
    Eigen::Matrix<double, 12, 1> rows;
    for (Eigen::Index r = 0; r < 3; ++r) rows.segment<4>(4 * r) = t.view.row(r).transpose();
    out.insert("view", recipe::vector(rows));
    out.insert("outline", recipe::vectors(t.outline));
    out.insert("keep_inside", t.keepInside);
    if (t.plane_mm) out.insert("plane", recipe::vector(*t.plane_mm));
    out.insert("depth_mm", t.depth_mm);
  }
  void operator()(const tool::Brush& t) const {
    out.insert("path", recipe::vectors(t.path_mm));
    out.insert("radius_mm", t.radius_mm);
    if (t.normal) out.insert("normal", recipe::vector(*t.normal));
    out.insert("erase", t.erase);
  }
  void operator()(const tool::Split& t) const {
    out.insert("by", kBy[static_cast<std::size_t>(t.by)]);
    out.insert("radius_mm", t.radius_mm);
    toml::array parts;
    for (const tool::Split::Seeds& seeds : t.seeds) {
      parts.push_back(
          toml::table{{"label", seeds.label}, {"points", recipe::vectors(seeds.points_mm)}});
    }
    out.insert("seeds", std::move(parts));
  }
  void operator()(const tool::Combine& t) const {
    out.insert("operation", kCombine[static_cast<std::size_t>(t.operation)]);
    out.insert("other", t.other);
    out.insert("grown_mm", t.grown_mm);
  }
  void operator()(const tool::Remove&) const {}
};

}  // namespace

Result<std::vector<LabelStep>> readRecipe(const fs::path& file) {
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  if (!fs::is_regular_file(file, error) || !in) {
    return fail(inputRefused("There is no recipe of that name.")
                    .inFile(file.string())
                    .wants("a TOML file with [[step]] tables")
                    .advise("Check the path."));
  }
  return parseRecipe({std::istreambuf_iterator<char>(in), {}}, file);
}

Result<std::vector<LabelStep>> parseRecipe(const std::string& text, const fs::path& file) {
  try {
    return stepsOf(toml::parse(text), file);
  } catch (const toml::parse_error& problem) {
    return fail(recipeRefused(file, "line " + std::to_string(problem.source().begin.line),
                              "The recipe is not TOML: " + std::string(problem.description()) + ".",
                              "TOML"));
  }
}

Result<std::vector<LabelStep>> readSteps(const std::vector<std::string>& inlineTables) {
  const auto notToml = [](const std::string& why) {
    return usageError("A step is not TOML: " + why + ".")
        .inField("--step")
        .wants("tool = 'margin', label = 'bone', operation = 'close', mm = 2")
        .advise("Correct the step and run the command again.");
  };
  std::string text = "step = [\n";
  for (const std::string& table : inlineTables) text += "{ " + table + " },\n";
  try {
    auto steps = stepsOf(toml::parse(text + "]\n"), {});
    if (steps) return steps;
    Error error = steps.error();
    error.kind = ErrorKind::Usage;
    return fail(std::move(error).advise("Correct the step and run the command again."));
  } catch (const toml::parse_error& problem) {
    return fail(notToml(std::string(problem.description())));
  }
}

std::string recipeText(const std::vector<LabelStep>& steps) {
  toml::array list;
  for (const LabelStep& step : steps) {
    toml::table out;
    if (step.tool.index() > 0) out.insert("tool", kTools[step.tool.index()]);
    if (!step.label.empty()) out.insert("label", step.label);
    if (step.preset) out.insert("preset", *step.preset);
    std::visit(Writer{out}, step.tool);
    if (step.limits.overOthers) out.insert("over_others", true);
    if (step.limits.only) out.insert("only", recipe::range(*step.limits.only));
    list.push_back(std::move(out));
  }
  toml::table root;
  root.insert("step", std::move(list));
  std::ostringstream text;
  text << root << "\n";
  return text.str();
}

}  // namespace palpate
