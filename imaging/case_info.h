#pragma once
/// case.toml: to text and back. The keys are fixed; an unknown key is an error, so that a case of a
/// newer program is not half understood.

#include <filesystem>
#include <string>

#include "imaging/case_folder.h"

namespace palpate {

[[nodiscard]] std::string caseInfoText(const CaseInfo& info);
[[nodiscard]] Result<CaseInfo> parseCaseInfo(const std::filesystem::path& file);

}  // namespace palpate
