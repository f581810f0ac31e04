#include "imaging/segment/recipe_reader.h"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

std::string oneOf(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

}  // namespace

Error recipeRefused(const std::filesystem::path& file, const std::string& field,
                    const std::string& message, const std::string& expected) {
  Error error = inputRefused(message).inField(field).wants(expected).advise(
      "Correct the recipe and run the command again.");
  return file.empty() ? error : std::move(error).inFile(file.string());
}

std::string RecipeReader::name(const std::string& key) const {
  if (key.empty()) return where_;
  return where_.empty() ? key : where_ + "." + key;
}

const toml::node* RecipeReader::node(const char* key) {
  known_.insert(key);
  return table_->get(key);
}

void RecipeReader::refuse(const std::string& key, const std::string& message,
                          const std::string& expected) {
  if (!error_) error_ = recipeRefused(file_, name(key), message, expected);
}

void RecipeReader::take(const RecipeReader& other) {
  if (!error_) error_ = other.error_;
}

void RecipeReader::refuseOthers() {
  for (const auto& [key, value] : *table_) {
    if (known_.contains(std::string(key.str()))) continue;
    refuse(std::string(key.str()), "The recipe has an unknown key.",
           oneOf({known_.begin(), known_.end()}));
  }
}

std::optional<std::string> RecipeReader::optionalText(const char* key) {
  const toml::node* found = node(key);
  if (found == nullptr) return {};
  auto value = found->value_exact<std::string>();
  if (!value) refuse(key, "The value is of the wrong type.", "a text in quotes");
  return value;
}

std::string RecipeReader::text(const char* key, std::optional<std::string> fallback) {
  const auto value = optionalText(key);
  if (value && !value->empty()) return *value;
  if (!fallback) refuse(key, "The text is missing.", "a text in quotes");
  return fallback.value_or("");
}

bool RecipeReader::flag(const char* key, bool fallback) {
  const toml::node* found = node(key);
  if (found == nullptr) return fallback;
  const auto value = found->value_exact<bool>();
  if (!value) refuse(key, "The value is of the wrong type.", "true or false");
  return value.value_or(fallback);
}

double RecipeReader::number(const char* key, double least, std::optional<double> fallback) {
  const std::string expected = least == 0.0 ? "a number, 0 or more" : "a number";
  const toml::node* found = node(key);
  if (found == nullptr) {
    if (!fallback) refuse(key, "The number is missing.", expected);
    return fallback.value_or(least);
  }
  const auto value = found->is_number() ? found->value<double>() : std::nullopt;
  if (!value) {
    refuse(key, "The value is of the wrong type.", expected);
  } else if (!std::isfinite(*value) || *value < least) {
    refuse(key, "The number is out of range.", expected);
  }
  return value.value_or(least);
}

std::int64_t RecipeReader::count(const char* key, std::int64_t least, std::int64_t fallback) {
  const toml::node* found = node(key);
  if (found == nullptr) return fallback;
  const auto value = found->value_exact<std::int64_t>();
  if (!value || *value < least) {
    refuse(key, "The value is not a count.",
           "a whole number, " + std::to_string(least) + " or more");
    return fallback;
  }
  return *value;
}

std::optional<ThresholdRange> RecipeReader::optionalRange(const char* key) {
  const toml::node* found = node(key);
  if (found == nullptr) return {};
  const toml::array* pair = found->as_array();
  if (pair != nullptr && pair->size() == 2 && (*pair)[0].is_number() && (*pair)[1].is_number()) {
    const double low = *(*pair)[0].value<double>(), high = *(*pair)[1].value<double>();
    if (std::isfinite(low) && std::isfinite(high) && low <= high) return ThresholdRange{low, high};
  }
  refuse(key, "The threshold is not a range.", "[low, high], low <= high");
  return ThresholdRange{};
}

std::size_t RecipeReader::choice(const char* key, const std::vector<std::string>& words) {
  const toml::node* found = node(key);
  const auto word = found != nullptr ? found->value_exact<std::string>() : std::nullopt;
  const auto it = word ? std::find(words.begin(), words.end(), *word) : words.end();
  if (it == words.end()) {
    refuse(key, found == nullptr ? "The choice is missing." : "There is no such choice.",
           oneOf(words));
    return 0;
  }
  return static_cast<std::size_t>(it - words.begin());
}

std::vector<double> RecipeReader::numbersOf(const toml::node* found, const std::string& field,
                                            std::size_t count) {
  std::vector<double> out;
  const toml::array* list = found != nullptr ? found->as_array() : nullptr;
  const auto good = [](const toml::node& n) {
    return n.is_number() && std::isfinite(*n.value<double>());
  };
  if (list == nullptr || list->size() != count || !std::all_of(list->begin(), list->end(), good)) {
    if (!error_) {
      error_ = recipeRefused(file_, field, "The numbers are missing or wrong.",
                             "a list of " + std::to_string(count) + " numbers");
    }
    return out;
  }
  for (const toml::node& n : *list) out.push_back(*n.value<double>());
  return out;
}

template <int N>
std::vector<Eigen::Matrix<double, N, 1>> RecipeReader::list(const char* key) {
  std::vector<Eigen::Matrix<double, N, 1>> out;
  const toml::node* found = node(key);
  const toml::array* array = found != nullptr ? found->as_array() : nullptr;
  if (array == nullptr || array->empty()) {
    refuse(key, "The points are missing.",
           "a list of lists of " + std::to_string(N) + " numbers, at least one");
    return out;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    const auto numbers =
        numbersOf(array->get(i), name(key) + "[" + std::to_string(i) + "]", std::size_t{N});
    if (numbers.empty()) return out;
    out.push_back(Eigen::Map<const Eigen::Matrix<double, N, 1>>(numbers.data()));
  }
  return out;
}

std::vector<Eigen::Vector3d> RecipeReader::points(const char* key) {
  return list<3>(key);
}

std::vector<Eigen::Vector2d> RecipeReader::corners(const char* key) {
  auto outline = list<2>(key);
  if (!error_ && outline.size() < 3) {
    refuse(key, "The outline is no area.", "at least three [u, v]");
  }
  return outline;
}

std::vector<RecipeReader> RecipeReader::tables(const char* key) {
  std::vector<RecipeReader> out;
  const toml::node* found = node(key);
  const toml::array* array = found != nullptr ? found->as_array() : nullptr;
  if (array == nullptr || array->empty()) {
    const std::string plural = std::string(key) == "step" ? "steps" : key;
    refuse(key, "The recipe has no " + plural + ".", "at least one [[" + name(key) + "]]");
    return out;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    const std::string where = name(key) + "[" + std::to_string(i) + "]";
    const toml::table* table = array->get(i)->as_table();
    if (table == nullptr) {
      if (!error_)
        error_ = recipeRefused(file_, where, "It is not a table.", "[[" + name(key) + "]]");
      return out;
    }
    out.emplace_back(*table, file_, where);
  }
  return out;
}

}  // namespace palpate
