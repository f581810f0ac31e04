#include "core/scene/material.h"

#include <algorithm>
#include <cmath>

#include "core/scene/toml_reader.h"

namespace palpate {
namespace {

MaterialPair readPair(TomlFile& file, const toml::table& table, const std::string& prefix) {
  TomlTable row(file, table, prefix, {"name", "friction", "restitution"});
  MaterialPair pair;
  row.text("name", pair.other, Need::Required);
  row.number("friction", pair.friction, {0.0, 2.0}, Need::Required);
  row.number("restitution", pair.restitution, {0.0, 1.0});
  return pair;
}

const Material* named(const std::vector<Material>& materials, const std::string& name) {
  const auto found = std::find_if(materials.begin(), materials.end(),
                                  [&name](const Material& m) { return m.name == name; });
  return found == materials.end() ? nullptr : &*found;
}

const MaterialPair* told(const Material* material, const std::string& other) {
  if (material == nullptr) return nullptr;
  const auto found = std::find_if(material->with.begin(), material->with.end(),
                                  [&other](const MaterialPair& p) { return p.other == other; });
  return found == material->with.end() ? nullptr : &*found;
}

/// A pair with a material that is not in the file would be ignored in silence.
void checkPairs(const std::vector<Material>& materials, TomlTable& root) {
  for (const Material& material : materials) {
    for (const MaterialPair& pair : material.with) {
      if (pair.other == kSteel || named(materials, pair.other) != nullptr) continue;
      root.refuse("material", "A pair names a material that is not in the file.",
                  material.name + " with " + pair.other, "the name of a material, or steel");
    }
  }
}

Material readMaterial(TomlFile& file, const toml::table& table, std::size_t number) {
  TomlTable row(file, table, "material[" + std::to_string(number) + "].",
                {"name", "stiffness_N_per_mm", "friction", "restitution", "density_kg_per_m3",
                 "critical", "source", "with"});
  Material material;
  row.text("name", material.name, Need::Required);
  row.number("stiffness_N_per_mm", material.stiffness_NPerMm, {0.01, 100.0}, Need::Required);
  row.number("friction", material.friction, {0.0, 2.0}, Need::Required);
  row.number("restitution", material.restitution, {0.0, 1.0});
  row.number("density_kg_per_m3", material.density_kgPerM3, {100.0, 25000.0}, Need::Required);
  row.flag("critical", material.critical);
  row.text("source", material.source, Need::Required);
  if (table.contains("with")) {
    for (const toml::table* pair : row.tables("with")) {
      const std::string prefix = row.fieldName("with[") + std::to_string(material.with.size());
      material.with.push_back(readPair(file, *pair, prefix + "]."));
    }
  }
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
  checkPairs(materials, root);
  if (file->error) return fail(*file->error);
  return materials;
}

MaterialPair pairOf(const std::vector<Material>& materials, const std::string& a,
                    const std::string& b) {
  const Material* const first = named(materials, a);
  const Material* const second = named(materials, b);
  if (const MaterialPair* pair = told(first, second != nullptr ? b : kSteel)) return *pair;
  if (const MaterialPair* pair = told(second, first != nullptr ? a : kSteel)) return *pair;
  MaterialPair out;
  out.other = b;
  if (first == nullptr || second == nullptr) {
    const Material* const one = first != nullptr ? first : second;
    if (one == nullptr) return out;
    out.friction = one->friction;
    out.restitution = one->restitution;
    return out;
  }
  out.friction = std::sqrt(first->friction * second->friction);
  out.restitution = std::min(first->restitution, second->restitution);
  return out;
}

}  // namespace palpate
