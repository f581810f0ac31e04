#pragma once
/// `segment CASE --from FILE`: labels of another program into a case.

#include <filesystem>
#include <string>

#include "app/command.h"

namespace palpate {

struct SegmentFromFile {
  std::filesystem::path caseFolder, file;
  std::string label;         ///< Renames the file's one label, or chooses one of several.
  bool partOptions = false;  ///< --largest or --min-mm3 was given: refused (usage).
};

/// The case's labels are replaced together or not at all; the report is segment's own.
[[nodiscard]] Result<CommandOutput> segmentFromFile(const SegmentFromFile& request,
                                                    const CommandContext& context);

}  // namespace palpate
