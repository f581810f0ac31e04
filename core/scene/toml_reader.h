#pragma once
/// Reads Palpate's small TOML files strictly: every key is known, typed and in range, or refused.
///
/// The first thing that is wrong is kept and names file, key, what was found and what was
/// expected; the readers after it do nothing, so that a caller reads all keys and asks once. For
/// the .cpp files of this room only.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/toml.h"

namespace palpate {

/// A closed range of numbers.
struct Range {
  double least = 0.0, most = 0.0;
};

enum class Need : std::uint8_t { Optional, Required };

/// One file: what it holds, and the first error met while reading it.
struct TomlFile {
  std::string path;  ///< As the user gave it.
  toml::table root;
  std::optional<Error> error;
};

/// A missing, unreadable or malformed file is refused with the line where it breaks.
[[nodiscard]] Result<TomlFile> parseTomlFile(const std::filesystem::path& path);
/// The same from text; `path` is only for messages.
[[nodiscard]] Result<TomlFile> parseTomlText(const std::string& text, const std::string& path);

/// A table of the file. `out` keeps its value where an optional key is absent.
class TomlTable {
 public:
  /// Refuses keys that are not in `known`, naming them all.
  TomlTable(TomlFile& file, const toml::table& table, std::string prefix,
            std::initializer_list<const char*> known);

  void number(const char* key, double& out, Range range, Need need = Need::Optional);
  void integer(const char* key, std::uint32_t& out, Range range, Need need = Need::Optional);
  void flag(const char* key, bool& out);
  void text(const char* key, std::string& out, Need need = Need::Optional);
  void texts(const char* key, std::vector<std::string>& out);
  /// `count` numbers.
  void numbers(const char* key, double* out, std::size_t count, Range range, Need need);
  void colour(const char* key, std::array<std::uint8_t, 3>& out);
  /// A table under this one, or null.
  [[nodiscard]] const toml::table* table(const char* key);
  /// Tables under [[key]]; an error where there are none.
  [[nodiscard]] std::vector<const toml::table*> tables(const char* key);
  void refuse(const char* key, std::string message, std::string found, std::string expected);
  [[nodiscard]] bool failed() const { return file_.error.has_value(); }
  [[nodiscard]] std::string fieldName(const char* key) const { return prefix_ + key; }

 private:
  [[nodiscard]] const toml::node* find(const char* key, Need need);
  void wrongType(const char* key, const toml::node& node, const char* expected);
  bool checkRange(const std::string& key, double value, Range range);

  TomlFile& file_;
  const toml::table& table_;
  std::string prefix_;
};

/// Shortest text that reads back to the same number.
[[nodiscard]] std::string exactText(double value);
/// A number in millimetres that reads back, times 1e-3, to exactly `value_m` where one exists.
[[nodiscard]] double exactMillimetres(double value_m);
/// With quotes, escaped.
[[nodiscard]] std::string quoted(const std::string& text);

}  // namespace palpate
