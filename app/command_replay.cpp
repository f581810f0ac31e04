#include <memory>

#include "app/accuracy.h"
#include "app/command.h"
#include "app/commands.h"
#include "app/setting_report.h"
#include "app/text_table.h"
#include "core/geometry/units.h"
#include "core/session/replay.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

struct ReplayOptions {
  fs::path file;
  std::string accuracy;
};

/// Changes of level as they were recorded, the governor's or another's.
void addLevels(const ReplayReport& report, const std::vector<GovernorLevel>& levels,
               CommandOutput& output) {
  output.json["level_changes"] = ordered_json::array();
  for (const RecordedLevel& change : report.levels) {
    const std::string name = change.level < levels.size() ? levels[change.level].name : "";
    output.json["level_changes"].push_back(
        {{"step", change.step}, {"level", change.level}, {"name", name}});
  }
  if (report.levels.empty()) return;
  output.text += std::to_string(report.levels.size()) + " changes of level were recorded\n";
}

CommandOutput reportReplay(const ReplayReport& report, bool otherSetting) {
  CommandOutput output;
  output.json["identical"] = report.identical;
  output.json["steps"] = report.steps;
  output.json["first_difference"] = nullptr;
  output.text = std::to_string(report.steps) +
                " steps replayed: " + (report.identical ? "identical" : "not identical") + "\n";
  if (report.firstDifference) {
    const StepDifference& difference = *report.firstDifference;
    output.json["first_difference"] = {{"step", difference.step},
                                       {"expected", hashText(difference.expectedHash)},
                                       {"found", hashText(difference.foundHash)}};
    output.text += "first difference at step " + std::to_string(difference.step) + "\n";
  }
  if (otherSetting) {
    output.json["force_error_max_N"] = report.forceErrorMax;
    output.json["depth_error_max_mm"] = millimetres(report.depthErrorMax);
    output.text += "against the recording: force within " + decimal(report.forceErrorMax, 3) +
                   " N, depth within " + decimal(millimetres(report.depthErrorMax), 3) + " mm\n";
  }
  // Played at another setting the states differ by intent; the errors are the answer then.
  output.checkFailed = !report.identical && !otherSetting;
  return output;
}

Result<CommandOutput> runReplay(const ReplayOptions& options, const CommandContext& context) {
  const Result<SessionHeader> header = readSessionHeader(options.file);
  if (!header) return fail(header.error());
  auto scene = prepareSession(options.file, context.progress);
  if (!scene) return fail(scene.error());
  const std::vector<GovernorLevel> levels = (*scene)->levels;  // as it was recorded
  const bool otherSetting = !options.accuracy.empty() && options.accuracy != kRecordedAccuracy;
  if (otherSetting) {
    const Result<SimulationSetting> setting =
        settingOfAccuracy(options.accuracy, (*scene)->scene.setting);
    if (!setting) return fail(setting.error());
    scene = withSetting(**scene, *setting, context.progress);
    if (!scene) return fail(scene.error());
  }
  const Result<ReplayReport> report = replaySession(options.file, *scene, context.progress);
  if (!report) return fail(report.error());
  CommandOutput output = reportReplay(*report, otherSetting);
  addLevels(*report, levels, output);
  if (!header->exact) {
    output.warnings.emplace_back("The recorder dropped entries: this session is inexact.");
  }
  if (!header->finished) {
    output.warnings.emplace_back("The session was not closed; up to its last second is missing.");
  }
  if (output.checkFailed) {
    output.warnings.emplace_back(
        "The replay is not identical to the recording: a different build, or a damaged file.");
  }
  return output;
}

}  // namespace

void addReplayCommand(CommandSet& commands) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* sub = commands.add(
      "replay", "Replays a session without a device; exit code 1 where not identical",
      [options](const CommandContext& context) { return runReplay(*options, context); });
  sub->add_option("FILE", options->file, "A session")->required();
  sub->add_option("--accuracy", options->accuracy,
                  "Simulate it again at another setting and say how far off the recording was: " +
                      accuracyNames());
}

}  // namespace palpate
