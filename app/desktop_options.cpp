#include "app/desktop_options.h"

#include <cstdlib>

#include "app/program_paths.h"

namespace palpate {
namespace {

constexpr const char* kGroup = "Window";

}  // namespace

void addDesktopOptions(CLI::App& program, DesktopOptions& options) {
  CLI::App& app = program;
  const auto group = [](CLI::Option* option) { option->group(kGroup); };
  group(app.add_option("--case", options.casePath, "Case to open (default: the last, the demo)"));
  group(app.add_option("--task", options.task, "Task to open on")
            ->check(CLI::IsMember({"library", "segment", "simulate", "review"})));
  group(app.add_flag("--demo-hand", options.demoHand, "Start with the built-in hand, running"));
  CLI::Option* soak = app.add_option("--soak", options.soak_s,
                                     "Seconds to work under the built-in hand, then report")
                          ->check(CLI::Range(1.0, 86400.0));
  group(soak);
  CLI::Option* report = app.add_option("--report", options.soakReport, "JSON that --soak writes");
  group(report);
  soak->needs(report);
  report->needs(soak);
  group(app.add_option("--screenshot", options.screenshot,
                       "Render --frames frames deterministically, write this PNG and leave"));
  group(app.add_option("--frames", options.frames, "Frames before the picture")
            ->check(CLI::Range(1, 100000))
            ->capture_default_str());
  CLI::Option* script =
      app.add_option("--ui-script", options.uiScript, "Input events to feed to the window");
  group(script);
  CLI::Option* frames =
      app.add_option("--frame-report", options.frameReport, "JSON: what the script's frames cost");
  group(frames);
  frames->needs(script);
  group(app.add_option("--ui-scale", options.uiScale, "Display scale (default: the display's)")
            ->check(CLI::Range(0.5F, 4.0F)));
  group(app.add_flag("--light", options.lightTheme, "Light theme"));
  group(app.add_option("--width", options.width, "Window width")
            ->check(CLI::Range(640, 16384))
            ->capture_default_str());
  group(app.add_option("--height", options.height, "Window height")
            ->check(CLI::Range(480, 16384))
            ->capture_default_str());
}

std::string givenDesktopOption(const CLI::App& program) {
  const auto given = [](const CLI::Option* option) {
    return option->get_group() == kGroup && option->count() > 0;
  };
  const auto options = program.get_options(given);
  return options.empty() ? std::string() : options.front()->get_name();
}

bool displayIsThere() {
  const char* display = std::getenv("DISPLAY");
  return display != nullptr && *display != '\0';
}

Result<void> completeDesktopOptions(DesktopOptions& options) {
  if (!displayIsThere()) {
    return fail(machineError("There is no display to open the window on (DISPLAY is not set).")
                    .advise("Start it from a desktop session or under xvfb-run, or run "
                            "'palpate simulate CASE --headless'; 'palpate --help' lists all that "
                            "works without a window."));
  }
  const Result<std::filesystem::path> datasets = datasetsFolder();
  if (!datasets) return fail(datasets.error());
  const Result<std::filesystem::path> shaders = shadersFolder();
  if (!shaders) return fail(shaders.error());
  options.datasets = *datasets;
  options.shaders = *shaders;
  options.demoCase = demoCaseFolder();
  const std::filesystem::path scan = demoScanFile();
  if (!scan.empty()) options.demoScan = scan;
  options.userFolder = userFolder();
  options.palpateExecutable = programFile().string();
  return {};
}

}  // namespace palpate
