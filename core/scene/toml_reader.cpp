#include "core/scene/toml_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "core/geometry/units.h"

namespace palpate {
namespace {

std::string joined(std::initializer_list<const char*> words) {
  std::string all;
  for (const char* word : words) all += (all.empty() ? "" : ", ") + std::string(word);
  return all;
}

std::string rangeText(Range range) {
  return exactText(range.least) + " to " + exactText(range.most);
}

const char* typeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

}  // namespace

std::string exactText(double value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

double exactMillimetres(double value_m) {
  const double guess = millimetres(value_m);
  for (const double candidate :
       {guess, std::nextafter(guess, INFINITY), std::nextafter(guess, -INFINITY)}) {
    if (metres(candidate) == value_m) return candidate;
  }
  return guess;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (code < 0x20 || code == 0x7F) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04X", static_cast<unsigned>(code));
      out += escape.data();
    } else {
      out += c;
    }
  }
  return out + "\"";
}

Result<TomlFile> parseTomlText(const std::string& text, const std::string& path) {
  TomlFile file;
  file.path = path;
  try {
    file.root = toml::parse(text);
  } catch (const toml::parse_error& why) {
    return fail(inputRefused("The file is not valid TOML.")
                    .inFile(path)
                    .inField("line " + std::to_string(why.source().begin.line))
                    .butFound(std::string(why.description()))
                    .advise("Correct that line."));
  }
  return file;
}

Result<TomlFile> parseTomlFile(const std::filesystem::path& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code)) {
    return fail(
        inputRefused("There is no such file.").inFile(path.string()).advise("Check the path."));
  }
  // These files are small; a large one is something else under a wrong name.
  constexpr std::uintmax_t kMostBytes = 4U << 20U;
  if (std::filesystem::file_size(path, code) > kMostBytes) {
    return fail(inputRefused("The file is too large to be a settings file.")
                    .inFile(path.string())
                    .wants("at most 4 MiB"));
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream text;
  if (!stream || !(text << stream.rdbuf())) {
    return fail(inputRefused("The file cannot be read, or is empty.")
                    .inFile(path.string())
                    .advise("Check that it has content and that you may read it."));
  }
  return parseTomlText(text.str(), path.string());
}

TomlTable::TomlTable(TomlFile& file, const toml::table& table, std::string prefix,
                     std::initializer_list<const char*> known)
    : file_(file), table_(table), prefix_(std::move(prefix)) {
  if (failed()) return;
  for (const auto& [key, node] : table_) {
    const std::string name(key.str());
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    refuse(name.c_str(), "The file has a key that is not known.", name, "one of: " + joined(known));
    file_.error->advise("Remove it or correct its spelling.");
    return;
  }
}

void TomlTable::refuse(const char* key, std::string message, std::string found,
                       std::string expected) {
  if (failed()) return;
  file_.error = inputRefused(std::move(message))
                    .inFile(file_.path)
                    .inField(fieldName(key))
                    .butFound(std::move(found))
                    .wants(std::move(expected));
}

const toml::node* TomlTable::find(const char* key, Need need) {
  if (failed()) return nullptr;
  const toml::node* node = table_.get(key);
  if (node == nullptr && need == Need::Required) {
    refuse(key, "The file lacks a key that it must have.", "nothing", std::string(key));
  }
  return node;
}

void TomlTable::wrongType(const char* key, const toml::node& node, const char* expected) {
  refuse(key, "A value has the wrong type.", typeName(node), expected);
}

bool TomlTable::checkRange(const std::string& key, double value, Range range) {
  if (value >= range.least && value <= range.most) return true;  // false for NaN, too
  refuse(key.c_str(), "A number is out of range.", exactText(value), rangeText(range));
  return false;
}

void TomlTable::number(const char* key, double& out, Range range, Need need) {
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value) return wrongType(key, *node, "a number");
  if (checkRange(key, *value, range)) out = *value;
}

void TomlTable::integer(const char* key, std::uint32_t& out, Range range, Need need) {
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  if (!node->is_integer()) return wrongType(key, *node, "a whole number");
  const auto value = node->value<std::int64_t>();
  if (checkRange(key, static_cast<double>(*value), range)) out = static_cast<std::uint32_t>(*value);
}

void TomlTable::flag(const char* key, bool& out) {
  const toml::node* node = find(key, Need::Optional);
  if (node == nullptr) return;
  if (!node->is_boolean()) return wrongType(key, *node, "true or false");
  out = *node->value<bool>();
}

void TomlTable::text(const char* key, std::string& out, Need need) {
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  if (!node->is_string()) return wrongType(key, *node, "a text");
  out = *node->value<std::string>();
}

void TomlTable::texts(const char* key, std::vector<std::string>& out) {
  const toml::node* node = find(key, Need::Optional);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr) return wrongType(key, *node, "an array of texts");
  out.clear();
  for (const auto& item : *array) {
    if (!item.is_string()) return wrongType(key, item, "an array of texts");
    out.push_back(*item.value<std::string>());
  }
}

void TomlTable::numbers(const char* key, double* out, std::size_t count, Range range, Need need) {
  const toml::node* node = find(key, need);
  if (node == nullptr) return;
  const std::string wanted = "an array of " + std::to_string(count) + " numbers";
  const toml::array* array = node->as_array();
  if (array == nullptr) return wrongType(key, *node, wanted.c_str());
  if (array->size() != count) {
    return refuse(key, "An array has the wrong length.", std::to_string(array->size()), wanted);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const toml::node& item = *array->get(i);
    if (!item.is_number()) return wrongType(key, item, wanted.c_str());
    const double value = *item.value<double>();
    if (!checkRange(std::string(key) + "[" + std::to_string(i) + "]", value, range)) return;
    out[i] = value;
  }
}

void TomlTable::colour(const char* key, std::array<std::uint8_t, 3>& out) {
  double channels[3] = {0, 0, 0};
  if (find(key, Need::Optional) == nullptr) return;
  numbers(key, channels, 3, {0, 255}, Need::Required);
  if (failed()) return;
  for (std::size_t c = 0; c < 3; ++c) {
    out[c] = static_cast<std::uint8_t>(std::lround(channels[c]));
  }
}

const toml::table* TomlTable::table(const char* key) {
  const toml::node* node = find(key, Need::Optional);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) wrongType(key, *node, "a table");
  return node->as_table();
}

std::vector<const toml::table*> TomlTable::tables(const char* key) {
  std::vector<const toml::table*> all;
  const toml::node* node = find(key, Need::Required);
  if (node == nullptr) return all;
  const toml::array* array = node->as_array();
  if (array == nullptr) {
    wrongType(key, *node, "an array of tables");
    return all;
  }
  for (const auto& item : *array) {
    if (!item.is_table()) {
      wrongType(key, item, "an array of tables");
      return {};
    }
    all.push_back(item.as_table());
  }
  return all;
}

}  // namespace palpate
