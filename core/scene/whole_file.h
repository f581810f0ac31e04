#pragma once
/// Writes a file whole or not at all.

#include <filesystem>
#include <string_view>

#include "core/base/error.h"

namespace palpate {

/// Writes beside the final name, syncs, and renames over it. On an error the old file, if any, is
/// untouched and nothing new is left. Not for the loops.
[[nodiscard]] Result<void> writeWholeFile(const std::filesystem::path& file,
                                          std::string_view content);

/// Makes the last rename in this folder survive a power cut.
void syncFolder(const std::filesystem::path& folder);

}  // namespace palpate
