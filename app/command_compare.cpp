#include <memory>

#include "app/case_label.h"
#include "app/command.h"
#include "app/commands.h"
#include "app/compare_reference.h"
#include "app/text_table.h"
#include "imaging/case_folder.h"
#include "imaging/segment/agreement.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct CompareOptions {
  fs::path caseFolder;
  std::string label;
  fs::path reference;
  std::optional<std::string> referenceLabel;
  std::optional<double> toleranceDice;
};

nlohmann::ordered_json summaryJson(const DistanceSummary& summary) {
  nlohmann::ordered_json json;
  json["mean"] = summary.mean;
  json["median"] = summary.median;
  json["p95"] = summary.p95;
  json["worst"] = summary.worst;
  return json;
}

nlohmann::ordered_json surfaceJson(const std::optional<SurfaceAgreement>& surface) {
  if (!surface) return nullptr;
  nlohmann::ordered_json json = summaryJson(surface->symmetric);
  json["to_reference"] = summaryJson(surface->aToB);
  json["from_reference"] = summaryJson(surface->bToA);
  return json;
}

std::string tables(const Agreement& agreement) {
  TextTable volumes({"", "label", "reference"});
  volumes.add({"voxels", std::to_string(agreement.voxels[0]), std::to_string(agreement.voxels[1])});
  volumes.add({"mm³", decimal(agreement.mm3[0], 1), decimal(agreement.mm3[1], 1)});
  TextTable shares({"in common", ""});
  shares.add({"Dice", decimal(agreement.dice, 4)});
  shares.add({"Jaccard", decimal(agreement.jaccard, 4)});
  std::string text = volumes.text() + "\n" + shares.text();
  if (!agreement.surface) return text;
  TextTable distances({"surface distance, mm", "mean", "median", "p95", "worst"});
  const auto add = [&distances](const char* way, const DistanceSummary& summary) {
    distances.add({way, decimal(summary.mean, 3), decimal(summary.median, 3),
                   decimal(summary.p95, 3), decimal(summary.worst, 3)});
  };
  add("label to reference", agreement.surface->aToB);
  add("reference to label", agreement.surface->bToA);
  add("symmetric", agreement.surface->symmetric);
  return text + "\n" + distances.text();
}

CommandOutput report(const CompareOptions& options, const Reference& reference,
                     const Agreement& agreement) {
  CommandOutput output;
  output.json["label"] = options.label;
  output.json["reference"] = reference.name;
  output.json["voxels"] = agreement.voxels;
  output.json["mm3"] = agreement.mm3;
  output.json["dice"] = agreement.dice;
  output.json["jaccard"] = agreement.jaccard;
  output.json["surface_mm"] = surfaceJson(agreement.surface);
  output.text = tables(agreement);
  output.warnings = reference.warnings;
  if (options.toleranceDice && agreement.dice < *options.toleranceDice) {
    output.checkFailed = true;
    output.warnings.push_back("The Dice coefficient " + decimal(agreement.dice, 6) +
                              " is below the tolerance " + decimal(*options.toleranceDice, 6) +
                              ".");
  }
  return output;
}

Result<CommandOutput> runCompare(const CompareOptions& options, const CommandContext& context) {
  context.progress(0.0, "Reading the labels");
  const auto table = readCaseLabelTable(options.caseFolder);
  if (!table) return fail(table.error());
  const auto value = labelValue(*table, options.label);
  if (!value) return fail(value.error());
  const auto labels = readCaseLabels(options.caseFolder);
  if (!labels) return fail(labels.error());
  if (context.progress.cancelled()) return fail(cancelled());
  context.progress(0.1, "Reading the reference");
  const auto reference =
      readReference({options.reference, options.referenceLabel, options.label, labels->geometry});
  if (!reference) return fail(reference.error());
  const auto agreement =
      compareMasks({*labels, *value}, {reference->grid, reference->value}, context.progress);
  if (!agreement) {
    Error error = agreement.error();
    if (error.kind == ErrorKind::InputRefused) error.inFile(options.reference.string());
    return fail(error);
  }
  return report(options, *reference, *agreement);
}

}  // namespace

void addCompareCommand(CommandSet& commands) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* sub = commands.add(
      "compare", "Measures how far a label agrees with a reference",
      [options](const CommandContext& context) { return runCompare(*options, context); });
  sub->add_option("CASE", options->caseFolder, "The case's folder")->required();
  sub->add_option("--label", options->label, "The label, by name")->required();
  sub->add_option(
         "--reference", options->reference,
         "A label volume on the same grid (NIfTI, NRRD, MetaImage), an InVesalius project, "
         "or another case's folder")
      ->required();
  sub->add_option("--reference-label", options->referenceLabel,
                  "Value in a label volume (default: all but 0), mask of a project by name or "
                  "number (default: the first), label of a case (default: of the same name)");
  sub->add_option("--tolerance-dice", options->toleranceDice,
                  "Exit 1 where the Dice coefficient is below this")
      ->check(CLI::Range(0.0, 1.0));
}

}  // namespace palpate
