#pragma once
/// The steps that made a case's labels, kept beside them (CASE/segment.toml), so that the case can
/// be rebuilt: `palpate segment OTHER --recipe CASE/segment.toml`.

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "imaging/segment/tools.h"

namespace palpate {

inline constexpr const char* kCaseRecipe = "segment.toml";

struct CaseRecipe {
  std::vector<LabelStep> steps;
  bool whole = true;  ///< False: the labels had a beginning that is not among the steps.
};

/// Empty where the case has none, and not whole where it cannot be read.
[[nodiscard]] CaseRecipe readCaseRecipe(const std::filesystem::path& caseFolder);
/// Whole or not at all. Without steps the file goes.
[[nodiscard]] Result<void> writeCaseRecipe(const std::filesystem::path& caseFolder,
                                           const CaseRecipe& recipe);
/// What the steps say of a label, under its new name.
void renameLabel(std::vector<LabelStep>& steps, const std::string& from, const std::string& to);

}  // namespace palpate
