#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/text_table.h"
#include "imaging/exchange/label_exchange.h"

namespace palpate {
namespace {

CommandOutput report(const ExportRequest& request, const ExportReport& done) {
  CommandOutput output;
  output.json["file"] = request.file.string();
  output.json["format"] = exchangeFormatName(done.format);
  output.json["labels"] = nlohmann::ordered_json::array();
  TextTable table({"label", "value", "voxels"});
  for (const ExportedLabel& label : done.labels) {
    output.json["labels"].push_back(
        {{"name", label.name}, {"value", label.value}, {"voxels", label.voxels}});
    table.add({label.name, std::to_string(label.value), std::to_string(label.voxels)});
  }
  output.text = table.text();
  if (isSurface(done.format)) {
    output.json["triangles"] = done.triangles;
    output.text += std::to_string(done.triangles) + " triangles\n";
  }
  output.warnings = done.warnings;
  return output;
}

Result<CommandOutput> runExport(const ExportRequest& request, const CommandContext& context) {
  const Result<ExportReport> done = exportLabels(request, context.progress);
  if (!done) return fail(done.error());
  return report(request, *done);
}

}  // namespace

void addExportCommand(CommandSet& commands) {
  const auto request = std::make_shared<ExportRequest>();
  request->programVersion = PALPATE_VERSION;
  CLI::App* sub = commands.add(
      "export", "Labels of a case as a file for other programs",
      [request](const CommandContext& context) { return runExport(*request, context); });
  sub->add_option("CASE", request->caseFolder, "The case's folder")->required();
  sub->add_option("--out", request->file,
                  "DICOM SEG (.dcm), label volume (.mha, .nrrd, .seg.nrrd) or surface (.stl, .ply, "
                  ".obj)")
      ->required();
  sub->add_option("--label", request->labels, "Only this label; may be given again")
      ->expected(1)
      ->take_all();
  sub->add_flag("--force", request->overwrite, "Replace a file of that name");
}

}  // namespace palpate
