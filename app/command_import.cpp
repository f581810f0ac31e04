#include <memory>

#include "app/command.h"
#include "app/commands.h"
#include "app/grid_report.h"
#include "app/scene_loading.h"
#include "app/text_table.h"
#include "core/base/whole_file.h"
#include "imaging/case_folder.h"
#include "imaging/import.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct ImportOptions {
  ImportRequest request;
  std::string series;
  std::vector<std::string> repairs;
  fs::path caseFolder;
};

ordered_json importJson(const fs::path& folder, const ImportedScan& scan, const CaseInfo& info,
                        const std::vector<std::string>& warnings) {
  ordered_json json;
  json["case"] = folder.string();
  json["modality"] = scan.volume.modality;
  addGridFields(json, scan.volume.geometry);
  json["voxel_type"] = scan.volume.type == VoxelType::Int16 ? "int16" : "float32";
  const auto [low, high] = valueRange(scan.volume);
  if (scan.volume.type == VoxelType::Int16) {
    json["value_range"] = {static_cast<int>(low), static_cast<int>(high)};
  } else {
    json["value_range"] = {low, high};
  }
  json["voxels_sha256"] = info.voxelsSha256;
  json["repairs"] = scan.repairs;
  json["warnings"] = warnings;
  return json;
}

std::string importText(const fs::path& folder, const ImportedScan& scan) {
  std::string text = "Imported " + scan.sourceFormat + " into " + folder.string() + "\n";
  text += gridSentence(scan.volume.geometry) + "\n";
  for (const std::string& repair : scan.repairs) text += "Repaired: " + repair + "\n";
  const std::string& modality = scan.volume.modality;
  text += "Next: palpate segment " + folder.string() +
          (modality == "MR"                       ? " --preset mr-tissue\n"
           : modality == "CT" || modality.empty() ? " --preset ct-bone\n"
                                                  : " --threshold LO HI\n");
  return text;
}

/// The scene goes into the case after it is whole: a case without one has the default anyway.
Result<void> addDefaultScene(const fs::path& folder) {
  std::error_code error;
  fs::remove(folder / "scene.toml", error);
  return writeScene(defaultScene(), folder / "scene.toml");
}

Result<CommandOutput> runImport(const ImportOptions& options, const CommandContext& context) {
  ImportRequest request = options.request;
  if (!options.series.empty()) request.seriesUid = options.series;
  for (const std::string& repair : options.repairs) {
    (repair == "tilt" ? request.repairTilt : request.repairSpacing) = true;
  }
  if (const Result<void> writable = checkWritable(options.caseFolder); !writable) {
    return fail(writable.error());
  }
  Result<ImportedScan> scan = importScan(request, context.progress);
  if (!scan) return fail(scan.error());
  if (context.progress.cancelled()) return fail(cancelled());
  context.progress(0.95, "Writing the case");
  const Result<CaseInfo> written = writeNewCase(options.caseFolder, *scan);
  if (!written) return fail(written.error());
  if (const Result<void> scene = addDefaultScene(options.caseFolder); !scene) {
    return fail(scene.error());
  }
  context.progress(1.0, "Imported");
  CommandOutput output;
  output.warnings = scan->warnings;
  output.json = importJson(options.caseFolder, *scan, *written, output.warnings);
  output.text = importText(options.caseFolder, *scan);
  return output;
}

}  // namespace

void addImportCommand(CommandSet& commands) {
  const auto options = std::make_shared<ImportOptions>();
  CLI::App* sub = commands.add(
      "import", "A scan into a case",
      [options](const CommandContext& context) { return runImport(*options, context); });
  sub->add_option("PATH", options->request.path,
                  "File, folder, DICOMDIR, zip, tar, .inv3, NIfTI, NRRD or MetaImage")
      ->required();
  sub->add_option("--out", options->caseFolder, "The case, a folder of its own")->required();
  sub->add_option("--series", options->series, "UID, where there are several ('palpate series')");
  sub->add_option("--repair", options->repairs, "Leave to resample: tilt, spacing or both")
      ->delimiter(',')
      ->check(CLI::IsMember({"tilt", "spacing"}));
  sub->add_flag("--keep-names", options->request.keepNames,
                "Keep the patient's name and identifier in the case");
}

}  // namespace palpate
