#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/grid_report.h"
#include "app/text_table.h"
#include "imaging/import.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

ordered_json seriesJson(const SeriesInfo& series) {
  ordered_json json;
  json["uid"] = series.uid;
  json["modality"] = series.modality;
  json["description"] = series.description;
  json["files"] = series.files;
  json["importable"] = series.importable;
  json["reason"] = series.importable ? ordered_json(nullptr) : ordered_json(series.reason);
  if (series.importable) {
    addGridFields(json, series.geometry);
  } else {
    addNullGridFields(json);
  }
  return json;
}

Result<CommandOutput> runSeries(const std::filesystem::path& path, const CommandContext& context) {
  const Result<SeriesList> list = listSeries(path, context.progress);
  if (!list) return fail(list.error());
  CommandOutput output;
  output.json["series"] = ordered_json::array();
  TextTable table({"modality", "files", "importable", "volume", "description", "uid"});
  for (const SeriesInfo& series : list->series) {
    output.json["series"].push_back(seriesJson(series));
    table.add({series.modality, std::to_string(series.files), series.importable ? "yes" : "no",
               series.importable ? gridSentence(series.geometry) : series.reason,
               series.description, series.uid});
  }
  output.json["skipped_files"] = list->skippedFiles;
  output.text = table.text() + std::to_string(list->skippedFiles) + " other files skipped\n";
  return output;
}

}  // namespace

void addSeriesCommand(CommandSet& commands) {
  const auto path = std::make_shared<std::filesystem::path>();
  CLI::App* sub =
      commands.add("series", "What a file, folder or archive holds",
                   [path](const CommandContext& context) { return runSeries(*path, context); });
  sub->add_option("PATH", *path, "File, folder, DICOMDIR, zip, tar or volume file")->required();
}

}  // namespace palpate
