#include "core/scene/material.h"

#include <algorithm>

#include "core/scene/toml_reader.h"

namespace palpate {
namespace {

Material readMaterial(TomlFile& file, const toml::table& table, std::size_t number) {
  TomlTable row(file, table, "material[" + std::to_string(number) + "].",
                {"name", "stiffness_N_per_mm", "friction", "restitution", "density_kg_per_m3",
                 "critical", "source"});
  Material material;
  row.text("name", material.name, Need::Required);
  row.number("stiffness_N_per_mm", material.stiffness_NPerMm, {0.01, 100.0}, Need::Required);
  row.number("friction", material.friction, {0.0, 2.0}, Need::Required);
  row.number("restitution", material.restitution, {0.0, 1.0});
  row.number("density_kg_per_m3", material.density_kgPerM3, {100.0, 25000.0}, Need::Required);
  row.flag("critical", material.critical);
  row.text("source", material.source, Need::Required);
  if (!row.failed() && material.name.empty()) {
    row.refuse("name", "A material has no name.", "an empty text", "a name");
  }
  return material;
}

}  // namespace

Result<std::vector<Material>> readMaterials(const std::filesystem::path& path) {
  auto file = parseTomlFile(path);
  if (!file) return fail(file.error());
  TomlTable root(*file, file->root, "", {"material"});
  std::vector<Material> materials;
  for (const toml::table* table : root.tables("material")) {
    Material material = readMaterial(*file, *table, materials.size());
    const bool twice = std::any_of(materials.begin(), materials.end(), [&](const Material& other) {
      return other.name == material.name;
    });
    if (twice) {
      root.refuse("material", "Two materials have one name.", material.name, "names that differ");
    }
    if (file->error) return fail(*file->error);
    materials.push_back(std::move(material));
  }
  if (file->error) return fail(*file->error);
  return materials;
}

}  // namespace palpate
