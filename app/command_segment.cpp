#include <algorithm>
#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/label_report.h"
#include "app/program_paths.h"
#include "app/segment_from_file.h"
#include "app/text_table.h"
#include "core/base/whole_file.h"
#include "core/scene/anatomy.h"
#include "imaging/case_folder.h"
#include "imaging/segment/apply.h"
#include "imaging/segment/case_recipe.h"
#include "imaging/segment/recipe.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Label of a threshold without --label.
constexpr const char* kUnnamedLabel = "selection";

struct SegmentOptions {
  fs::path caseFolder;
  std::string preset;
  std::vector<double> threshold;
  fs::path recipe;
  std::vector<std::string> steps;
  fs::path from;
  std::string label;
  bool largest = false;
  double minMm3 = 0.0;
};

/// The one step of --preset and --threshold.
Result<LabelStep> singleStep(const SegmentOptions& options) {
  tool::Threshold threshold;
  threshold.largestOnly = options.largest;
  threshold.minMm3 = options.minMm3;
  LabelStep step;
  if (options.threshold.size() == 2) {
    threshold.range = ThresholdRange{options.threshold[0], options.threshold[1]};
    if (!(threshold.range.low <= threshold.range.high)) {
      return fail(
          usageError("The threshold's low end is above its high end.")
              .inField("--threshold")
              .butFound(decimal(threshold.range.low, 3) + " to " + decimal(threshold.range.high, 3))
              .wants("LO <= HI")
              .advise("Swap the two numbers."));
    }
  } else {
    step.preset = options.preset;
  }
  step.tool = threshold;
  step.label = options.label;
  return step;
}

Result<std::vector<LabelStep>> stepsOf(const SegmentOptions& options) {
  const bool many = !options.recipe.empty() || !options.steps.empty();
  if (many && (!options.label.empty() || options.largest || options.minMm3 > 0.0)) {
    return fail(usageError("--label, --largest and --min-mm3 do not go with --recipe or --step.")
                    .advise("Write them into the steps."));
  }
  if (!options.recipe.empty()) return readRecipe(options.recipe);
  if (!options.steps.empty()) return readSteps(options.steps);
  const auto step = singleStep(options);
  if (!step) return fail(step.error());
  return std::vector<LabelStep>{*step};
}

struct Work {
  Volume volume;
  LabelState state;
  CaseRecipe recipe;
  std::vector<Anatomy> anatomies;
  std::vector<std::string> warnings;
};

Result<void> applyTo(Work& work, LabelStep step, const Progress& progress) {
  if (step.preset) {
    const Preset* preset = presetNamed(*step.preset);
    const std::string& modality = work.volume.modality;
    if (preset != nullptr && !modality.empty() && preset->modality != modality) {
      work.warnings.push_back("The preset " + preset->name + " is made for " + preset->modality +
                              ", this scan is " + modality + "; check the result by eye.");
    }
    if (step.label.empty() && preset != nullptr) step.label = preset->label;
  }
  if (step.label.empty()) step.label = kUnnamedLabel;
  Result<LabelState> after = applyStep(work.volume, work.state, step, progress);
  if (!after) return fail(after.error());
  dressNewRows(work.state.table, after->table, work.anatomies);
  work.state = std::move(*after);
  work.recipe.steps.push_back(std::move(step));
  return {};
}

/// Where it went wrong in --recipe or --step. What is wrong in a recipe is a wrong file, not a
/// wrong command line.
Error ofStep(Error error, const SegmentOptions& options, std::size_t step) {
  const bool inFile = !options.recipe.empty();
  if (error.kind == ErrorKind::Cancelled || (!inFile && options.steps.empty())) return error;
  const std::string where = "step[" + std::to_string(step) + "]";
  error.field = error.field ? where + "." + *error.field : where;
  if (!inFile) return error;
  if (error.kind == ErrorKind::Usage) error.kind = ErrorKind::InputRefused;
  error.file = options.recipe.string();
  return error;
}

Result<Work> openCase(const fs::path& folder) {
  Work work;
  const auto datasets = datasetsFolder();
  if (!datasets) return fail(datasets.error());
  auto anatomies = readAnatomies(*datasets / "labels.toml");
  if (!anatomies) return fail(anatomies.error());
  work.anatomies = std::move(*anatomies);
  Result<Volume> volume = readCaseVolume(folder);
  if (!volume) return fail(volume.error());
  work.volume = std::move(*volume);
  if (const Result<void> writable = checkWritable(folder); !writable) {
    return fail(writable.error());
  }
  if (!caseHasLabels(folder)) return work;
  Result<LabelState> state = readCaseLabelState(folder);
  if (!state) return fail(state.error());
  work.state = std::move(*state);
  work.recipe = readCaseRecipe(folder);
  if (work.recipe.steps.empty()) work.recipe.whole = false;
  return work;
}

Result<CommandOutput> runSegment(const SegmentOptions& options, const CommandContext& context) {
  if (!options.from.empty()) {
    const bool partOptions = options.largest || options.minMm3 > 0.0;
    return segmentFromFile({options.caseFolder, options.from, options.label, partOptions}, context);
  }
  const Result<std::vector<LabelStep>> steps = stepsOf(options);
  if (!steps) return fail(steps.error());
  context.progress(0.0, "Reading the case");
  Result<Work> work = openCase(options.caseFolder);
  if (!work) return fail(work.error());
  for (std::size_t i = 0; i < steps->size(); ++i) {
    const Result<void> applied = applyTo(*work, (*steps)[i], context.progress);
    if (!applied) return fail(ofStep(applied.error(), options, i));
  }
  if (context.progress.cancelled()) return fail(cancelled());
  if (const Result<void> written =
          writeCaseLabels(options.caseFolder, work->state.labels, work->state.table);
      !written) {
    return fail(written.error());
  }
  if (const Result<void> written = writeCaseRecipe(options.caseFolder, work->recipe); !written) {
    return fail(written.error());
  }
  context.progress(1.0, "Segmented");
  return labelReport(work->state.labels, work->state.table, std::move(work->warnings));
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
  how->add_option("--step", options->steps,
                  "A step of a recipe on one line: tool = 'margin', label = 'bone', operation = "
                  "'close', mm = 2; repeatable");
  how->add_option("--from", options->from,
                  "Labels of a file: DICOM SEG, MetaImage, NRRD, STL, PLY or OBJ");
  how->require_option(1);
  sub->add_option("--label", options->label, "Label to replace (default: the preset's)");
  sub->add_flag("--largest", options->largest, "Keep only the largest connected part");
  sub->add_option("--min-mm3", options->minMm3, "Drop connected parts smaller than this")
      ->check(CLI::NonNegativeNumber);
}

}  // namespace palpate
