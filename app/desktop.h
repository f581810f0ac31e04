#pragma once
/// The desktop: the window of ui/ wired to imaging, the simulation and the session.
///
/// Thread: call on the main thread; returns when the window closes. Long work runs on background
/// threads or, for import, in a child process, so that the window never freezes.

#include <filesystem>
#include <optional>
#include <string>

namespace palpate {

/// What the command line chose. Paths need not exist: the window says what is missing.
struct DesktopOptions {
  std::optional<std::filesystem::path>
      casePath;                    ///< Opened at start; else the last, else the demo.
  std::filesystem::path datasets;  ///< The folder with instruments/ and materials.toml.
  std::filesystem::path shaders;   ///< The folder of GLSL stages.
  std::filesystem::path fonts;     ///< Empty: /usr/share/fonts.
  std::optional<std::filesystem::path> demoCase;  ///< The prepared demo case, offered in Library.
  std::optional<std::filesystem::path> demoScan;  ///< Cranium.inv3, imported when there is no case.
  std::filesystem::path
      userFolder;  ///< Cases, sessions, recent list. Empty: ~/.local/share/palpate.

  /// Renders `frames` frames at a fixed size, camera and clock, writes the PNG and returns. The
  /// simulation advances a fixed number of ticks a frame under the built-in hand; no wall times
  /// show.
  std::optional<std::filesystem::path> screenshot;
  int frames = 60;
  bool demoHand = false;  ///< Start with the built-in searching hand instead of the mouse, running.
  std::optional<std::filesystem::path>
      uiScript;  ///< Input events fed to the window (ui/ui_script.h).
  std::optional<std::filesystem::path>
      frameReport;  ///< What the script's frames cost (app/frame_report.h), written at the end.

  /// Above 0: the built-in hand works for so many seconds on the real clock, then the run's report
  /// is written and the window closes.
  double soak_s = 0.0;
  std::filesystem::path soakReport;

  std::string task;      ///< "library", "segment", "simulate", "review"; empty: what fits the case.
  float uiScale = 0.0F;  ///< 0: from the display.
  bool lightTheme = false;
  int width = 1280, height = 800;  ///< Of the window, screen units, before scaling.
  std::string palpateExecutable;   ///< Started for `import` and `series`.
};

/// Exit code as in interface.md: 0 closed by the user or picture written; 4 no display, no OpenGL
/// 3.3, or a picture that could not be written; 3 a case that was refused in a --screenshot run.
/// The last line on stderr is then a sentence.
[[nodiscard]] int runDesktop(const DesktopOptions& options);

}  // namespace palpate
