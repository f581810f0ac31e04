#include "core/scene/instrument.h"

#include <algorithm>
#include <numbers>

#include "core/geometry/units.h"
#include "core/scene/instrument_mesh.h"
#include "core/scene/toml_reader.h"

namespace palpate {
namespace {

CrossSection readSection(TomlFile& file, const toml::table& table, std::size_t number) {
  TomlTable row(file, table, "section[" + std::to_string(number) + "].",
                {"at_mm", "half_axes_mm", "twist_deg"});
  double at_mm[3] = {0, 0, 0};
  double halfAxes_mm[2] = {0, 0};
  double twist_deg = 0.0;
  row.numbers("at_mm", at_mm, 3, {-500.0, 500.0}, Need::Required);
  row.numbers("half_axes_mm", halfAxes_mm, 2, {0.0, 100.0}, Need::Required);
  row.number("twist_deg", twist_deg, {-360.0, 360.0});
  CrossSection section;
  section.p_T = Eigen::Vector3d(metres(at_mm[0]), metres(at_mm[1]), metres(at_mm[2]));
  section.halfAxes = Eigen::Vector2d(metres(halfAxes_mm[0]), metres(halfAxes_mm[1]));
  section.twist = twist_deg * std::numbers::pi / 180.0;
  return section;
}

Error inThisFile(Error error, const std::filesystem::path& path) {
  if (!error.file) error.inFile(path.string());
  return error;
}

}  // namespace

Result<Instrument> readInstrument(const std::filesystem::path& path) {
  auto file = parseTomlFile(path);
  if (!file) return fail(file.error());
  Instrument instrument;
  instrument.name = path.stem().string();
  TomlTable root(*file, file->root, "",
                 {"title", "description", "source", "colour", "material", "density_kg_per_m3",
                  "shell_spacing_mm", "around", "section"});
  double density = 0.0;
  double spacing_mm = millimetres(instrument.shellSpacing);
  std::uint32_t around = 24;
  root.text("title", instrument.title, Need::Required);
  root.text("description", instrument.description, Need::Required);
  root.text("source", instrument.source, Need::Required);
  root.colour("colour", instrument.colour);
  root.text("material", instrument.material);
  root.number("density_kg_per_m3", density, {100.0, 25000.0}, Need::Required);
  root.number("shell_spacing_mm", spacing_mm, {0.05, 20.0});
  root.integer("around", around, {6, 256});
  std::vector<CrossSection> sections;
  for (const toml::table* table : root.tables("section")) {
    sections.push_back(readSection(*file, *table, sections.size()));
  }
  if (file->error) return fail(*file->error);
  instrument.shellSpacing = metres(spacing_mm);

  auto mesh = sweepSections(sections, around);
  if (!mesh) return fail(inThisFile(mesh.error(), path));
  instrument.mesh_T = std::move(*mesh);
  const auto mass = massPropertiesOf(instrument.mesh_T, density);
  if (!mass) return fail(inThisFile(mass.error(), path));
  instrument.massProperties = *mass;
  return instrument;
}

Result<std::vector<Instrument>> readInstruments(const std::filesystem::path& folder) {
  std::error_code code;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, code)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  if (code || files.empty()) {
    return fail(inputRefused("The folder holds no instruments.")
                    .inFile(folder.string())
                    .wants("files named *.toml")
                    .advise("Give the folder datasets/instruments of the program."));
  }
  std::sort(files.begin(), files.end());
  std::vector<Instrument> instruments;
  for (const auto& file : files) {
    auto instrument = readInstrument(file);
    if (!instrument) return fail(instrument.error());
    instruments.push_back(std::move(*instrument));
  }
  return instruments;
}

}  // namespace palpate
