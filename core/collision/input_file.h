#pragma once
/// A whole file as bytes, or the sentence why not.

#include <filesystem>
#include <string>

#include "core/base/error.h"

namespace palpate {

/// Refuses a path that is missing, not a regular file, or unreadable (InputRefused, with the file).
[[nodiscard]] Result<std::string> readInputFile(const std::filesystem::path& file);

}  // namespace palpate
