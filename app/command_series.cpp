#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/grid_report.h"
#include "app/text_table.h"
#include "core/base/counted.h"
#include "core/base/hexadecimal.h"
#include "imaging/import.h"

namespace palpate {
namespace {

using nlohmann::ordered_json;

struct SeriesOptions {
  std::filesystem::path path;
  bool names = false, thumbnails = false;
};

ordered_json thumbnailJson(const std::optional<GreyPicture>& picture) {
  if (!picture) return nullptr;
  return {
      {"width", picture->width}, {"height", picture->height}, {"grey", hexadecimal(picture->grey)}};
}

ordered_json seriesJson(const SeriesInfo& series, const SeriesOptions& options) {
  ordered_json json;
  json["uid"] = series.uid;
  json["modality"] = series.modality;
  json["description"] = series.description;
  json["study"] = series.study;
  json["files"] = series.files;
  json["bytes"] = series.bytes;
  json["importable"] = series.importable;
  json["reason"] = series.importable ? ordered_json(nullptr) : ordered_json(series.reason);
  json["repair"] = series.repair.empty() ? ordered_json(nullptr) : ordered_json(series.repair);
  if (series.importable) {
    addGridFields(json, series.geometry);
  } else {
    addNullGridFields(json);
  }
  if (options.names) {
    json["patient_name"] = series.patientName;
    json["patient_id"] = series.patientId;
    json["study_date"] = series.studyDate;
  }
  if (options.thumbnails) json["thumbnail"] = thumbnailJson(series.thumbnail);
  return json;
}

Result<CommandOutput> runSeries(const SeriesOptions& options, const CommandContext& context) {
  const Result<SeriesList> list = listSeries(options.path, context.progress, options.thumbnails);
  if (!list) return fail(list.error());
  CommandOutput output;
  output.json["series"] = ordered_json::array();
  TextTable table({"modality", "files", "importable", "volume", "description", "uid"});
  for (const SeriesInfo& series : list->series) {
    output.json["series"].push_back(seriesJson(series, options));
    table.add({series.modality, std::to_string(series.files), series.importable ? "yes" : "no",
               series.importable ? gridSentence(series.geometry) : series.reason,
               series.description, series.uid});
  }
  output.json["skipped_files"] = list->skippedFiles;
  output.warnings = list->warnings;
  output.text =
      table.text() + counted(list->skippedFiles, "other file", "other files") + " skipped\n";
  return output;
}

}  // namespace

void addSeriesCommand(CommandSet& commands) {
  const auto options = std::make_shared<SeriesOptions>();
  CLI::App* sub = commands.add(
      "series", "What a file, folder or archive holds",
      [options](const CommandContext& context) { return runSeries(*options, context); });
  sub->add_option("PATH", options->path, "File, folder, DICOMDIR, zip, tar or volume file")
      ->required();
  sub->add_flag("--names", options->names,
                "With --json: patient name, identifier and date of each study too");
  sub->add_flag("--thumbnails", options->thumbnails, "With --json: a small grey picture of each");
}

}  // namespace palpate
