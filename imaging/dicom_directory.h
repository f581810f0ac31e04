#pragma once
/// What a DICOMDIR says is on its disc (PS3.10 8, PS3.3 F.3).

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The files that its records in use refer to, as directoryKey() of their paths from its folder; at
/// most 200,000. Empty when it cannot be read to its end. Nothing that it names is opened.
[[nodiscard]] std::optional<std::vector<std::string>> filesOfDirectory(
    const std::filesystem::path& dicomdir);

/// One way to write a path of a disc, for comparing: parts in capitals, without the version (";1")
/// and the last dot that some systems show.
[[nodiscard]] std::string directoryKey(const std::string& path);

}  // namespace palpate
