#pragma once
/// The options of `palpate` without a subcommand.

#include <CLI/CLI.hpp>

#include "app/desktop.h"
#include "core/base/error.h"

namespace palpate {

/// Adds --case, --screenshot, --frames, ... to the program.
void addDesktopOptions(CLI::App& program, DesktopOptions& options);
/// The name of the first desktop option that was given; empty: none.
[[nodiscard]] std::string givenDesktopOption(const CLI::App& program);
/// Folders of the program and the user; refuses (Machine) where there is no display or no data.
[[nodiscard]] Result<void> completeDesktopOptions(DesktopOptions& options);
/// True if a window could be opened: DISPLAY is set (VTK speaks X11; on Wayland through XWayland).
[[nodiscard]] bool displayIsThere();

}  // namespace palpate
