#include "imaging/labels_file.h"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>

#include "core/base/toml.h"

namespace palpate {
namespace fs = std::filesystem;
namespace {

constexpr std::array<std::string_view, 4> kKeys{"name", "value", "colour", "material"};

Error wrong(const fs::path& file, const toml::node& where, std::string field, std::string found,
            std::string wanted) {
  return inputRefused("The table of labels cannot be used.")
      .inFile(file.string())
      .inField("line " + std::to_string(where.source().begin.line) + ", " + std::move(field))
      .butFound(std::move(found))
      .wants(std::move(wanted))
      .advise("Correct labels.toml, or segment again.");
}

Result<LabelInfo> readRow(const toml::table& row, const fs::path& file) {
  for (const auto& [key, value] : row) {
    if (std::find(kKeys.begin(), kKeys.end(), key.str()) == kKeys.end()) {
      return fail(wrong(file, value, std::string(key.str()), "an unknown key",
                        "name, value, colour or material"));
    }
  }
  LabelInfo info;
  const auto name = row["name"].value<std::string>();
  const auto material = row["material"].value<std::string>();
  const auto value = row["value"].value<std::int64_t>();
  if (!name || name->empty()) return fail(wrong(file, row, "name", "nothing", "a name"));
  if (!material || material->empty()) {
    return fail(wrong(file, row, "material", "nothing", "the name of a material"));
  }
  if (!value || *value < 1 || *value > 255) {
    return fail(wrong(file, row, "value", value ? std::to_string(*value) : "nothing",
                      "a whole number from 1 to 255"));
  }
  info.name = *name;
  info.material = *material;
  info.value = static_cast<std::uint8_t>(*value);
  const toml::array* colour = row["colour"].as_array();
  if (colour == nullptr || colour->size() != 3) {
    return fail(wrong(file, row, "colour", "another value", "three numbers from 0 to 255"));
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const auto part = (*colour)[c].value<std::int64_t>();
    if (!part || *part < 0 || *part > 255) {
      return fail(wrong(file, row, "colour", "another value", "three numbers from 0 to 255"));
    }
    info.colour[c] = static_cast<std::uint8_t>(*part);
  }
  return info;
}

}  // namespace

std::string labelTableText(const LabelTable& table) {
  toml::array rows;
  for (const LabelInfo& info : table) {
    rows.push_back(
        toml::table{{"name", info.name},
                    {"value", info.value},
                    {"colour", toml::array{info.colour[0], info.colour[1], info.colour[2]}},
                    {"material", info.material}});
  }
  std::ostringstream out;
  out << "# The labels of labels.mha.\n"
      << toml::toml_formatter(toml::table{{"label", rows}}) << "\n";
  return out.str();
}

Result<void> checkLabelTable(const LabelTable& table) {
  std::set<std::string> names;
  std::set<int> values;
  for (const LabelInfo& info : table) {
    if (info.name.empty() || info.value == 0 || !names.insert(info.name).second ||
        !values.insert(info.value).second) {
      return fail(inputRefused("Two labels share a name or a value, or one has none.")
                      .inField(info.name.empty() ? "name" : info.name)
                      .butFound("value " + std::to_string(info.value))
                      .wants("names and values (1 to 255) that occur once")
                      .advise("Give each label its own name and value."));
    }
  }
  return {};
}

Result<LabelTable> readLabelTable(const fs::path& file) {
  toml::table document;
  try {
    document = toml::parse_file(file.string());
  } catch (const toml::parse_error& e) {
    return fail(inputRefused("The table of labels is not TOML.")
                    .inFile(file.string())
                    .inField("line " + std::to_string(e.source().begin.line))
                    .butFound(std::string(e.description()))
                    .advise("Correct labels.toml, or segment again."));
  }
  LabelTable table;
  for (const auto& [key, value] : document) {
    const toml::array* rows = value.as_array();
    if (key.str() != "label" || rows == nullptr) {
      return fail(wrong(file, value, std::string(key.str()), "an unknown key", "[[label]]"));
    }
    for (const auto& row : *rows) {
      if (!row.is_table()) return fail(wrong(file, row, "label", "no table", "[[label]]"));
      auto info = readRow(*row.as_table(), file);
      if (!info) return fail(info.error());
      table.push_back(std::move(*info));
    }
  }
  if (auto fits = checkLabelTable(table); !fits) {
    return fail(std::move(fits.error()).inFile(file.string()));
  }
  return table;
}

}  // namespace palpate
