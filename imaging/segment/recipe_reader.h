#pragma once
/// Reads the keys of a recipe's tables; the first thing that is wrong is kept, with its field.
///
/// Not for use outside this folder.

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/toml.h"
#include "imaging/segmentation.h"

namespace palpate {

[[nodiscard]] Error recipeRefused(const std::filesystem::path& file, const std::string& field,
                                  const std::string& message, const std::string& expected);

/// Every accessor returns a default once something is wrong, so that reading goes on in a straight
/// line; error() says what it was.
class RecipeReader {
 public:
  RecipeReader(const toml::table& table, std::filesystem::path file, std::string where)
      : table_(&table), file_(std::move(file)), where_(std::move(where)) {}

  [[nodiscard]] bool has(const char* key) const { return table_->contains(key); }
  [[nodiscard]] std::optional<std::string> optionalText(const char* key);
  /// Without a fallback the key has to be there.
  [[nodiscard]] std::string text(const char* key, std::optional<std::string> fallback = {});
  [[nodiscard]] bool flag(const char* key, bool fallback);
  [[nodiscard]] double number(const char* key, double least, std::optional<double> fallback = {});
  [[nodiscard]] std::int64_t count(const char* key, std::int64_t least, std::int64_t fallback);
  [[nodiscard]] std::optional<ThresholdRange> optionalRange(const char* key);
  /// The index of the word; 0 where it is none of them.
  [[nodiscard]] std::size_t choice(const char* key, const std::vector<std::string>& words);
  template <int N>
  [[nodiscard]] Eigen::Matrix<double, N, 1> vector(const char* key) {
    Eigen::Matrix<double, N, 1> out = Eigen::Matrix<double, N, 1>::Zero();
    const std::vector<double> numbers = numbersOf(node(key), name(key), N);
    for (std::size_t i = 0; i < numbers.size(); ++i) out[static_cast<Eigen::Index>(i)] = numbers[i];
    return out;
  }
  [[nodiscard]] std::vector<Eigen::Vector3d> points(const char* key);
  [[nodiscard]] std::vector<Eigen::Vector2d> corners(const char* key);
  /// The tables of an array; at least one.
  [[nodiscard]] std::vector<RecipeReader> tables(const char* key);

  /// Refuses keys that nobody asked for.
  void refuseOthers();
  void refuse(const std::string& key, const std::string& message, const std::string& expected);
  /// Takes over another reader's error.
  void take(const RecipeReader& other);
  [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }

 private:
  [[nodiscard]] std::string name(const std::string& key) const;
  [[nodiscard]] const toml::node* node(const char* key);
  [[nodiscard]] std::vector<double> numbersOf(const toml::node* node, const std::string& field,
                                              std::size_t count);
  template <int N>
  std::vector<Eigen::Matrix<double, N, 1>> list(const char* key);

  const toml::table* table_;
  std::filesystem::path file_;
  std::string where_;
  std::set<std::string> known_;
  std::optional<Error> error_;
};

/// TOML values of what a recipe holds.
namespace recipe {
template <class V>
[[nodiscard]] toml::array vector(const V& v) {
  toml::array out;
  for (Eigen::Index i = 0; i < v.size(); ++i) out.push_back(v[i]);
  return out;
}
template <class V>
[[nodiscard]] toml::array vectors(const std::vector<V>& list) {
  toml::array out;
  for (const V& v : list) out.push_back(vector(v));
  return out;
}
[[nodiscard]] inline toml::array range(const ThresholdRange& r) {
  return toml::array{r.low, r.high};
}
}  // namespace recipe

}  // namespace palpate
