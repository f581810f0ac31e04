#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "app/command.h"
#include "app/commands.h"
#include "app/segment_from_file.h"
#include "app/segment_recipe.h"
#include "app/text_table.h"
#include "core/base/whole_file.h"
#include "imaging/case_folder.h"
#include "imaging/segmentation.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Label of a threshold without --label.
constexpr const char* kUnnamedLabel = "selection";

/// Okabe–Ito, for labels that no preset names.
constexpr std::array<std::array<std::uint8_t, 3>, 7> kLabelColours{{{86, 180, 233},
                                                                    {230, 159, 0},
                                                                    {0, 158, 115},
                                                                    {240, 228, 66},
                                                                    {0, 114, 178},
                                                                    {213, 94, 0},
                                                                    {204, 121, 167}}};

struct SegmentOptions {
  fs::path caseFolder;
  std::string preset;
  std::vector<double> threshold;
  fs::path recipe;
  fs::path from;
  std::string label;
  bool largest = false;
  double minMm3 = 0.0;
};

const Preset* presetNamed(const std::string& name) {
  const std::vector<Preset>& presets = segmentationPresets();
  const auto it =
      std::find_if(presets.begin(), presets.end(), [&](const Preset& p) { return p.name == name; });
  return it == presets.end() ? nullptr : &*it;
}

Result<std::vector<SegmentStep>> stepsOf(const SegmentOptions& options) {
  if (!options.recipe.empty()) {
    if (!options.label.empty() || options.largest || options.minMm3 > 0.0) {
      return fail(usageError("--label, --largest and --min-mm3 do not go with --recipe.")
                      .advise("Write them into the recipe's steps."));
    }
    return readSegmentRecipe(options.recipe);
  }
  SegmentStep step;
  if (options.threshold.size() == 2) {
    step.threshold = ThresholdRange{options.threshold[0], options.threshold[1]};
    if (!(step.threshold->low <= step.threshold->high)) {
      return fail(
          usageError("The threshold's low end is above its high end.")
              .inField("--threshold")
              .butFound(decimal(step.threshold->low, 3) + " to " + decimal(step.threshold->high, 3))
              .wants("LO <= HI")
              .advise("Swap the two numbers."));
    }
  } else {
    step.preset = options.preset;
  }
  step.label = options.label;
  step.largest = options.largest;
  step.minMm3 = options.minMm3;
  return std::vector<SegmentStep>{step};
}

/// The row of the label, added with the lowest free value where it is new.
Result<LabelInfo> rowFor(const std::string& name, const Preset* preset, LabelTable& table) {
  const auto named = [&](const LabelInfo& row) { return row.name == name; };
  if (const auto it = std::find_if(table.begin(), table.end(), named); it != table.end()) {
    return *it;
  }
  std::set<int> used;
  for (const LabelInfo& row : table) used.insert(row.value);
  int value = 1;
  while (used.contains(value)) ++value;
  if (value > 255) {
    return fail(inputRefused("The case has no room for another label.")
                    .inField("label")
                    .butFound("255 labels")
                    .wants("at most 255")
                    .advise("Segment into one of the labels that are there."));
  }
  LabelInfo row;
  row.name = name;
  row.value = static_cast<std::uint8_t>(value);
  row.colour = preset != nullptr
                   ? preset->colour
                   : kLabelColours[static_cast<std::size_t>(value - 1) % kLabelColours.size()];
  if (preset != nullptr && !preset->material.empty()) row.material = preset->material;
  table.push_back(row);
  return row;
}

/// A preset lends its colour and material also to a threshold into its label.
const Preset* presetOfLabel(const std::string& label) {
  for (const Preset& preset : segmentationPresets()) {
    if (preset.label == label) return &preset;
  }
  return nullptr;
}

struct Work {
  const Volume& volume;
  std::optional<LabelGrid> labels;
  LabelTable table;
  std::vector<std::string> warnings;
};

Result<void> applyStep(const SegmentStep& step, Work& work, const Progress& progress) {
  SegmentRequest request;
  request.largestOnly = step.largest;
  request.minMm3 = step.minMm3;
  const Preset* preset = step.preset ? presetNamed(*step.preset) : nullptr;
  if (step.preset) {
    const Result<ThresholdRange> range = presetRange(*step.preset, work.volume);
    if (!range) return fail(range.error());
    request.range = *range;
    const std::string& modality = work.volume.modality;
    if (preset != nullptr && !modality.empty() && !preset->modality.empty() &&
        preset->modality != modality) {
      work.warnings.push_back("The preset " + preset->name + " is made for " + preset->modality +
                              ", this scan is " + modality + "; check the result by eye.");
    }
  } else {
    request.range = *step.threshold;
  }
  std::string name = step.label;
  if (name.empty()) name = preset != nullptr ? preset->label : kUnnamedLabel;
  const Result<LabelInfo> row =
      rowFor(name, preset != nullptr ? preset : presetOfLabel(name), work.table);
  if (!row) return fail(row.error());
  Result<LabelGrid> made =
      segment(work.volume, work.labels ? &*work.labels : nullptr, row->value, request, progress);
  if (!made) return fail(made.error());
  work.labels = std::move(*made);
  return {};
}

/// A wrong name in a recipe is a wrong file, not a wrong command line.
Error fromRecipe(Error error, const fs::path& recipe) {
  if (recipe.empty() || error.kind != ErrorKind::Usage) return error;
  error.kind = ErrorKind::InputRefused;
  error.file = recipe.string();
  return error;
}

CommandOutput reportLabels(const Work& work) {
  CommandOutput output;
  output.json["labels"] = nlohmann::ordered_json::array();
  TextTable table({"label", "value", "voxels", "mm³"});
  for (const LabelCount& count : countLabels(*work.labels, work.table)) {
    nlohmann::ordered_json row;
    row["name"] = count.name;
    row["value"] = count.value;
    row["voxels"] = count.voxels;
    row["mm3"] = count.mm3;
    output.json["labels"].push_back(row);
    table.add({count.name, std::to_string(count.value), std::to_string(count.voxels),
               decimal(count.mm3, 1)});
  }
  output.text = table.text();
  output.warnings = work.warnings;
  return output;
}

Result<CommandOutput> runSegment(const SegmentOptions& options, const CommandContext& context) {
  if (!options.from.empty()) {
    const bool partOptions = options.largest || options.minMm3 > 0.0;
    return segmentFromFile({options.caseFolder, options.from, options.label, partOptions}, context);
  }
  const Result<std::vector<SegmentStep>> steps = stepsOf(options);
  if (!steps) return fail(steps.error());
  context.progress(0.0, "Reading the case");
  const Result<Volume> volume = readCaseVolume(options.caseFolder);
  if (!volume) return fail(volume.error());
  if (const Result<void> writable = checkWritable(options.caseFolder); !writable) {
    return fail(writable.error());
  }
  Work work{*volume, {}, {}, {}};
  if (caseHasLabels(options.caseFolder)) {
    Result<LabelGrid> labels = readCaseLabels(options.caseFolder);
    if (!labels) return fail(labels.error());
    work.labels = std::move(*labels);
    Result<LabelTable> table = readCaseLabelTable(options.caseFolder);
    if (!table) return fail(table.error());
    work.table = std::move(*table);
  }
  for (const SegmentStep& step : *steps) {
    const Result<void> applied = applyStep(step, work, context.progress);
    if (!applied) return fail(fromRecipe(applied.error(), options.recipe));
  }
  if (context.progress.cancelled()) return fail(cancelled());
  if (const Result<void> written = writeCaseLabels(options.caseFolder, *work.labels, work.table);
      !written) {
    return fail(written.error());
  }
  context.progress(1.0, "Segmented");
  return reportLabels(work);
}

std::string presetList() {
  std::string list;
  for (const Preset& preset : segmentationPresets()) {
    list += (list.empty() ? "" : ", ") + preset.name;
  }
  return list;
}

}  // namespace

void addSegmentCommand(CommandSet& commands) {
  const auto options = std::make_shared<SegmentOptions>();
  CLI::App* sub = commands.add(
      "segment", "Replaces one label of a case, leaves the others",
      [options](const CommandContext& context) { return runSegment(*options, context); });
  sub->add_option("CASE", options->caseFolder, "The case's folder")->required();
  CLI::Option_group* how = sub->add_option_group("How", "Exactly one of these");
  how->add_option("--preset", options->preset, "One of " + presetList());
  how->add_option("--threshold", options->threshold, "Lowest and highest value, inclusive (HU)")
      ->expected(2);
  how->add_option("--recipe", options->recipe, "TOML file of [[step]] tables");
  how->add_option("--from", options->from,
                  "Labels of a file: DICOM SEG, MetaImage, NRRD, STL, PLY or OBJ");
  how->require_option(1);
  sub->add_option("--label", options->label, "Label to replace (default: the preset's)");
  sub->add_flag("--largest", options->largest, "Keep only the largest connected part");
  sub->add_option("--min-mm3", options->minMm3, "Drop connected parts smaller than this")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace palpate
