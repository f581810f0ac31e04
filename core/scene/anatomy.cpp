#include "core/scene/anatomy.h"

#include <algorithm>

#include "core/scene/toml_reader.h"

namespace palpate {

Result<std::vector<Anatomy>> readAnatomies(const std::filesystem::path& path) {
  auto file = parseTomlFile(path);
  if (!file) return fail(file.error());
  TomlTable root(*file, file->root, "", {"label"});
  std::vector<Anatomy> anatomies;
  for (const toml::table* table : root.tables("label")) {
    TomlTable row(*file, *table, "label[" + std::to_string(anatomies.size()) + "].",
                  {"name", "title", "colour", "material"});
    Anatomy anatomy;
    row.text("name", anatomy.name, Need::Required);
    row.text("title", anatomy.title, Need::Required);
    row.colour("colour", anatomy.colour);
    row.text("material", anatomy.material, Need::Required);
    const bool twice = std::any_of(anatomies.begin(), anatomies.end(),
                                   [&](const Anatomy& a) { return a.name == anatomy.name; });
    if (twice) row.refuse("name", "Two labels have one name.", anatomy.name, "another name");
    anatomies.push_back(std::move(anatomy));
  }
  if (file->error) return fail(*file->error);
  return anatomies;
}

LabelTable rowsOfAnatomies(const std::vector<Anatomy>& anatomies) {
  LabelTable rows;
  for (const Anatomy& a : anatomies) rows.push_back({a.name, 0, a.colour, a.material});
  return rows;
}

void dressNewRows(const LabelTable& before, LabelTable& after,
                  const std::vector<Anatomy>& anatomies) {
  for (LabelInfo& row : after) {
    const bool old = std::any_of(before.begin(), before.end(),
                                 [&row](const LabelInfo& l) { return l.name == row.name; });
    const auto anatomy = std::find_if(anatomies.begin(), anatomies.end(),
                                      [&row](const Anatomy& a) { return a.name == row.name; });
    if (old || anatomy == anatomies.end()) continue;
    row.colour = anatomy->colour;
    row.material = anatomy->material;
  }
}

}  // namespace palpate
