#include "app/segment_recipe.h"

#include <toml++/toml.h>
#include <array>
#include <cmath>
#include <string_view>

namespace palpate {
namespace {

namespace fs = std::filesystem;

Error refused(const fs::path& file, const std::string& field, const std::string& message,
              const std::string& expected) {
  return inputRefused(message)
      .inFile(file.string())
      .inField(field)
      .wants(expected)
      .advise("Correct the recipe and run the command again.");
}

constexpr std::array<std::string_view, 5> kKeys{"preset", "threshold", "label", "largest",
                                                "min_mm3"};

Result<void> checkKeys(const toml::table& table, const fs::path& file, const std::string& where) {
  for (const auto& [key, node] : table) {
    bool known = false;
    for (const std::string_view candidate : kKeys) known = known || key.str() == candidate;
    if (!known) {
      return fail(refused(file, where + "." + std::string(key.str()),
                          "The recipe has an unknown key.",
                          "preset, threshold, label, largest, min_mm3"));
    }
  }
  return {};
}

Result<ThresholdRange> thresholdOf(const toml::node& node, const fs::path& file,
                                   const std::string& field) {
  const toml::array* pair = node.as_array();
  const auto low = pair != nullptr && pair->size() == 2 ? (*pair)[0].value<double>() : std::nullopt;
  const auto high =
      pair != nullptr && pair->size() == 2 ? (*pair)[1].value<double>() : std::nullopt;
  if (!low || !high || !std::isfinite(*low) || !std::isfinite(*high) || *low > *high) {
    return fail(refused(file, field, "The threshold is not a range.", "[low, high], low <= high"));
  }
  return ThresholdRange{*low, *high};
}

/// An optional value of type T; a present one of another type is refused.
template <class T>
Result<std::optional<T>> optionalValue(const toml::table& table, std::string_view key,
                                       const fs::path& file, const std::string& where,
                                       const char* expected) {
  const toml::node* node = table.get(key);
  if (node == nullptr) return std::optional<T>{};
  const std::optional<T> value = node->value<T>();
  if (value) return value;
  return fail(
      refused(file, where + "." + std::string(key), "The value is of the wrong type.", expected));
}

Result<SegmentStep> readStep(const toml::table& table, const fs::path& file,
                             const std::string& where) {
  if (const Result<void> keys = checkKeys(table, file, where); !keys) return fail(keys.error());
  const auto preset = optionalValue<std::string>(table, "preset", file, where, "a preset's name");
  if (!preset) return fail(preset.error());
  const auto label = optionalValue<std::string>(table, "label", file, where, "a name");
  if (!label) return fail(label.error());
  const auto largest = optionalValue<bool>(table, "largest", file, where, "true or false");
  if (!largest) return fail(largest.error());
  const auto smallest = optionalValue<double>(table, "min_mm3", file, where, "a volume in mm³");
  if (!smallest) return fail(smallest.error());

  SegmentStep step{
      *preset, {}, label->value_or(""), largest->value_or(false), smallest->value_or(0.0)};
  if (const toml::node* node = table.get("threshold")) {
    const Result<ThresholdRange> range = thresholdOf(*node, file, where + ".threshold");
    if (!range) return fail(range.error());
    step.threshold = *range;
  }
  if (step.preset.has_value() == step.threshold.has_value()) {
    return fail(refused(file, where, "A step takes a preset or a threshold.", "exactly one"));
  }
  if (step.threshold && step.label.empty()) {
    return fail(refused(file, where + ".label", "A threshold needs a label.", "a name"));
  }
  if (!std::isfinite(step.minMm3) || step.minMm3 < 0.0) {
    return fail(refused(file, where + ".min_mm3", "The volume is negative.", "0 or more mm³"));
  }
  return step;
}

}  // namespace

Result<std::vector<SegmentStep>> readSegmentRecipe(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    return fail(inputRefused("There is no recipe of that name.")
                    .inFile(file.string())
                    .wants("a TOML file with [[step]] tables")
                    .advise("Check the path."));
  }
  toml::table root;
  try {
    root = toml::parse_file(file.string());
  } catch (const toml::parse_error& problem) {
    return fail(refused(file, "line " + std::to_string(problem.source().begin.line),
                        "The recipe is not TOML: " + std::string(problem.description()) + ".",
                        "TOML"));
  }
  for (const auto& [key, node] : root) {
    if (key.str() != "step") {
      return fail(refused(file, std::string(key.str()), "The recipe has an unknown key.", "step"));
    }
  }
  const toml::array* list = root["step"].as_array();
  if (list == nullptr || list->empty()) {
    return fail(refused(file, "step", "The recipe has no steps.", "at least one [[step]]"));
  }
  std::vector<SegmentStep> steps;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string where = "step[" + std::to_string(i) + "]";
    const toml::table* table = (*list)[i].as_table();
    if (table == nullptr) return fail(refused(file, where, "A step is not a table.", "[[step]]"));
    const Result<SegmentStep> step = readStep(*table, file, where);
    if (!step) return fail(step.error());
    steps.push_back(*step);
  }
  return steps;
}

}  // namespace palpate
