#pragma once
/// A recipe: the steps of a segmentation as a TOML file, so that a case can be rebuilt.
///
/// `[[step]]` tables, one a step, in order. Without `tool` a step is a threshold (`preset` or
/// `threshold`); `label`, `over_others` and `only` go with every tool. README.md of this folder has
/// every tool's keys.

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "imaging/segment/tools.h"

namespace palpate {

/// Refuses unknown keys, wrong types and values out of range, by file, step and key.
[[nodiscard]] Result<std::vector<LabelStep>> readRecipe(const std::filesystem::path& tomlFile);
/// The same from text; `file` is for messages.
[[nodiscard]] Result<std::vector<LabelStep>> parseRecipe(const std::string& text,
                                                         const std::filesystem::path& file);
/// Steps as inline tables ("tool = 'margin', label = 'bone', operation = 'close', mm = 2"), as a
/// command line gives them: what is wrong in them is a usage error, by step and key.
[[nodiscard]] Result<std::vector<LabelStep>> readSteps(
    const std::vector<std::string>& inlineTables);
/// What readRecipe() reads back to the last bit.
[[nodiscard]] std::string recipeText(const std::vector<LabelStep>& steps);

}  // namespace palpate
