#include "imaging/segment/case_recipe.h"

#include <fstream>
#include <system_error>

#include "core/base/whole_file.h"
#include "imaging/segment/recipe.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWhole = "# All that made the labels of this case, in order.\n\n";
constexpr const char* kPart =
    "# What was done to the labels of this case after they were there: their beginning is not "
    "here.\n\n";

}  // namespace

CaseRecipe readCaseRecipe(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / kCaseRecipe, error)) return {};
  CaseRecipe recipe;
  auto steps = readRecipe(folder / kCaseRecipe);
  std::ifstream file(folder / kCaseRecipe);
  std::string first;
  std::getline(file, first);
  recipe.whole = steps.has_value() && first + "\n\n" == kWhole;
  if (steps) recipe.steps = std::move(*steps);
  return recipe;
}

Result<void> writeCaseRecipe(const fs::path& folder, const CaseRecipe& recipe) {
  if (recipe.steps.empty()) {
    std::error_code error;
    fs::remove(folder / kCaseRecipe, error);
    return {};
  }
  return writeWholeFile(folder / kCaseRecipe,
                        (recipe.whole ? kWhole : kPart) + recipeText(recipe.steps));
}

void renameLabel(std::vector<LabelStep>& steps, const std::string& from, const std::string& to) {
  const auto rename = [&](std::string& name) {
    if (name == from) name = to;
  };
  for (LabelStep& step : steps) {
    rename(step.label);
    if (auto* split = std::get_if<tool::Split>(&step.tool)) {
      for (auto& seeds : split->seeds) rename(seeds.label);
    } else if (auto* combine = std::get_if<tool::Combine>(&step.tool)) {
      rename(combine->other);
    }
  }
}

}  // namespace palpate
