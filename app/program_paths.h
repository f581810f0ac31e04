#pragma once
/// Where the program finds its own data and the user's cases.

#include <filesystem>

#include "core/base/error.h"

namespace palpate {

/// The folder that holds `datasets/` and `shaders/`: PALPATE_DATA_DIR where set, else
/// `../share/palpate` from the executable (the same rule in the build tree and where installed).
/// Refused (Machine) where it is not there, saying where was looked.
[[nodiscard]] Result<std::filesystem::path> programDataFolder();

/// `datasets/` in it: instruments/, materials.toml.
[[nodiscard]] Result<std::filesystem::path> datasetsFolder();
/// `shaders/` in it.
[[nodiscard]] Result<std::filesystem::path> shadersFolder();

/// The program itself, for the child process that imports.
[[nodiscard]] std::filesystem::path programFile();

/// XDG_DATA_HOME/palpate, else ~/.local/share/palpate. Not created here.
[[nodiscard]] std::filesystem::path userFolder();
/// userFolder()/cases/demo-head: what packaging/run.sh prepares.
[[nodiscard]] std::filesystem::path demoCaseFolder();
/// Cranium.inv3 of Debian's invesalius-examples, or the copy beside the build that
/// packaging/setup.sh made; empty when there is none.
[[nodiscard]] std::filesystem::path demoScanFile();

}  // namespace palpate
