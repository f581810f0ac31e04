#include "core/session/session_scene.h"

#include <limits>

#include "core/scene/scene_text.h"
#include "core/session/deflate.h"
#include "core/simulation/fingerprint.h"

namespace palpate {
namespace {

void put(Packer& to, const Eigen::Isometry3d& X) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) to.put(X.matrix()(i, j));
  }
}

void get(Unpacker& from, Eigen::Isometry3d& X) {
  X.setIdentity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) from.get(X.matrix()(i, j));
  }
}

void put(Packer& to, const Eigen::Vector3d& v) {
  for (int axis = 0; axis < 3; ++axis) to.put(v[axis]);
}

void get(Unpacker& from, Eigen::Vector3d& v) {
  for (int axis = 0; axis < 3; ++axis) from.get(v[axis]);
}

std::vector<std::uint8_t> packGeometry(const GridGeometry& geometry) {
  Packer to;
  for (const auto n : geometry.dims) to.put(n);
  put(to, geometry.spacing);
  put(to, geometry.X_PV);
  return to.bytes();
}

bool unpackGeometry(const std::vector<std::uint8_t>& bytes, GridGeometry& geometry) {
  Unpacker from(bytes);
  for (auto& n : geometry.dims) from.get(n);
  get(from, geometry.spacing);
  get(from, geometry.X_PV);
  // Sizes come from outside: no more voxels than a volume can have, before memory is taken.
  double voxels = 1.0;
  for (const auto n : geometry.dims) voxels *= n > 0 ? static_cast<double>(n) : 1e300;
  return from.finished() && voxels < 1e10 && geometry.spacing.minCoeff() > 0.0;
}

std::vector<std::uint8_t> packFeltLabels(const PreparedScene& scene, const FeltLabels& felt) {
  std::vector<std::uint8_t> labels = scene.labels->labels;
  for (auto& label : labels) {
    if (!felt[label]) label = 0;
  }
  return deflated(labels);
}

std::vector<std::uint8_t> packTable(const PreparedScene& scene, const FeltLabels& felt) {
  Packer to;
  std::uint64_t count = 0;
  for (const auto& label : scene.table) count += felt[label.value] ? 1U : 0U;
  to.put(count);
  for (const auto& label : scene.table) {
    if (!felt[label.value]) continue;
    to.put(label.name);
    to.put(label.value);
    for (const auto channel : label.colour) to.put(channel);
    to.put(label.material);
  }
  return to.bytes();
}

bool unpackTable(const std::vector<std::uint8_t>& bytes, LabelTable& table) {
  Unpacker from(bytes);
  table.resize(from.count(8));
  for (auto& label : table) {
    from.get(label.name);
    from.get(label.value);
    for (auto& channel : label.colour) from.get(channel);
    from.get(label.material);
  }
  return from.finished();
}

std::vector<std::uint8_t> packMaterials(const std::vector<Material>& materials) {
  Packer to;
  to.put(static_cast<std::uint64_t>(materials.size()));
  for (const auto& material : materials) {
    to.put(material.name);
    to.put(material.stiffness_NPerMm);
    to.put(material.friction);
    to.put(material.restitution);
    to.put(material.density_kgPerM3);
    to.put(material.critical);
    to.put(material.source);
  }
  return to.bytes();
}

bool unpackMaterials(const std::vector<std::uint8_t>& bytes, std::vector<Material>& materials) {
  Unpacker from(bytes);
  materials.resize(from.count(32));
  for (auto& material : materials) {
    from.get(material.name);
    from.get(material.stiffness_NPerMm);
    from.get(material.friction);
    from.get(material.restitution);
    from.get(material.density_kgPerM3);
    from.get(material.critical);
    from.get(material.source);
  }
  return from.finished();
}

/// How materials meet, and what the instrument is made of. Not in sessions of format 1.
std::vector<std::uint8_t> packPairs(const PreparedScene& scene) {
  Packer to;
  to.put(scene.instrument.material);
  for (const auto& material : scene.materials) {
    to.put(static_cast<std::uint64_t>(material.with.size()));
    for (const auto& pair : material.with) {
      to.put(pair.other);
      to.put(pair.friction);
      to.put(pair.restitution);
    }
  }
  return to.bytes();
}

bool unpackPairs(const std::vector<std::uint8_t>& bytes, std::vector<Material>& materials,
                 Instrument& instrument) {
  Unpacker from(bytes);
  from.get(instrument.material);
  for (auto& material : materials) {
    material.with.resize(from.count(16));
    for (auto& pair : material.with) {
      from.get(pair.other);
      from.get(pair.friction);
      from.get(pair.restitution);
    }
  }
  return from.finished();
}

/// What the governor could step down to. Only of scenes with levels, from format 3 on.
std::vector<std::uint8_t> packLevels(const std::vector<GovernorLevel>& levels) {
  Packer to;
  to.put(static_cast<std::uint64_t>(levels.size()));
  for (const auto& level : levels) {
    to.put(level.name);
    to.put(level.perceptualBound);
    to.put(level.contactBudget);
    to.put(static_cast<std::int32_t>(level.stopLevel));
    to.put(level.solverIterations);
    to.put(level.stepP99_us);
    to.put(level.forceErrorP95_N);
    to.put(level.depthErrorP95_mm);
  }
  return to.bytes();
}

bool unpackLevels(const std::vector<std::uint8_t>& bytes, std::vector<GovernorLevel>& levels) {
  Unpacker from(bytes);
  levels.resize(from.count(48));
  for (auto& level : levels) {
    std::int32_t stopLevel = 0;
    from.get(level.name);
    from.get(level.perceptualBound);
    from.get(level.contactBudget);
    from.get(stopLevel);
    from.get(level.solverIterations);
    from.get(level.stepP99_us);
    from.get(level.forceErrorP95_N);
    from.get(level.depthErrorP95_mm);
    level.stopLevel = stopLevel;
  }
  return from.finished();
}

std::vector<std::uint8_t> packInstrument(const Instrument& instrument) {
  Packer to;
  to.put(instrument.name);
  to.put(instrument.title);
  to.put(instrument.description);
  to.put(instrument.source);
  for (const auto channel : instrument.colour) to.put(channel);
  to.put(instrument.shellSpacing);
  to.put(instrument.massProperties.mass);
  put(to, instrument.massProperties.p_TC);
  for (int i = 0; i < 9; ++i) to.put(instrument.massProperties.I_C.data()[i]);
  to.put(static_cast<std::uint64_t>(instrument.mesh_T.vertices.size()));
  for (const auto& vertex : instrument.mesh_T.vertices) put(to, vertex);
  to.put(static_cast<std::uint64_t>(instrument.mesh_T.triangles.size()));
  for (const auto& triangle : instrument.mesh_T.triangles) {
    for (const auto index : triangle) to.put(index);
  }
  return to.bytes();
}

bool unpackInstrument(const std::vector<std::uint8_t>& bytes, Instrument& instrument) {
  Unpacker from(bytes);
  from.get(instrument.name);
  from.get(instrument.title);
  from.get(instrument.description);
  from.get(instrument.source);
  for (auto& channel : instrument.colour) from.get(channel);
  from.get(instrument.shellSpacing);
  from.get(instrument.massProperties.mass);
  get(from, instrument.massProperties.p_TC);
  for (int i = 0; i < 9; ++i) from.get(instrument.massProperties.I_C.data()[i]);
  instrument.mesh_T.vertices.resize(from.count(24));
  for (auto& vertex : instrument.mesh_T.vertices) get(from, vertex);
  instrument.mesh_T.triangles.resize(from.count(12));
  bool indicesFit = true;
  for (auto& triangle : instrument.mesh_T.triangles) {
    for (auto& index : triangle) {
      from.get(index);
      indicesFit = indicesFit && index < instrument.mesh_T.vertices.size();
    }
  }
  return from.finished() && indicesFit;
}

const std::vector<std::uint8_t>* find(const SessionParts& parts, const char* name) {
  const auto part = parts.find(name);
  return part == parts.end() ? nullptr : &part->second;
}

}  // namespace

Error damaged(const std::string& file, const std::string& part) {
  return inputRefused("The session file is damaged.")
      .inFile(file)
      .inField(part)
      .advise("Use a copy of the file that is whole.");
}

SessionParts partsOf(const PreparedScene& scene) {
  const FeltLabels felt = feltLabelsOf(scene);
  Scene nameless = scene.scene;
  nameless.name.clear();
  nameless.X_WD.reset();
  const std::string text = sceneText(nameless);
  Packer exact;  // numbers that the text gives in other units, to the bit
  put(exact, scene.X_WD);
  exact.put(scene.scene.setting.shellSpacing);
  exact.put(scene.scene.setting.stepPeriod);
  SessionParts parts{{"scene", {text.begin(), text.end()}},
                     {"exact", exact.bytes()},
                     {"geometry", packGeometry(scene.labels->geometry)},
                     {"labels", packFeltLabels(scene, felt)},
                     {"label_table", packTable(scene, felt)},
                     {"materials", packMaterials(scene.materials)},
                     {"pairs", packPairs(scene)},
                     {"instrument", packInstrument(scene.instrument)}};
  if (!scene.levels.empty()) parts["levels"] = packLevels(scene.levels);
  return parts;
}

Result<Scene> sceneOf(const SessionParts& parts, const std::string& file) {
  const auto* text = find(parts, "scene");
  const auto* exact = find(parts, "exact");
  if (text == nullptr) return fail(damaged(file, "scene"));
  if (exact == nullptr) return fail(damaged(file, "exact"));
  Scene absent;
  absent.reach = Reach::All;  // sessions of format 2 and before leave nothing out
  auto scene = sceneFromText({text->begin(), text->end()}, file, absent);
  if (!scene) return fail(scene.error());
  Eigen::Isometry3d X_WD;
  Unpacker from(*exact);
  get(from, X_WD);
  from.get(scene->setting.shellSpacing);
  from.get(scene->setting.stepPeriod);
  if (!from.finished()) return fail(damaged(file, "exact"));
  scene->X_WD = X_WD;
  return scene;
}

Result<std::shared_ptr<const PreparedScene>> prepareParts(const SessionParts& parts,
                                                          const std::string& file,
                                                          const Progress& progress) {
  auto scene = sceneOf(parts, file);
  if (!scene) return fail(scene.error());
  auto labels = std::make_shared<LabelGrid>();
  const auto* geometry = find(parts, "geometry");
  if (geometry == nullptr || !unpackGeometry(*geometry, labels->geometry)) {
    return fail(damaged(file, "geometry"));
  }
  const auto* packed = find(parts, "labels");
  auto volume = packed == nullptr ? std::nullopt : inflated(*packed, labels->geometry.voxelCount());
  if (!volume) return fail(damaged(file, "labels"));
  labels->labels = std::move(*volume);
  LabelTable table;
  const auto* tableBytes = find(parts, "label_table");
  if (tableBytes == nullptr || !unpackTable(*tableBytes, table)) {
    return fail(damaged(file, "label_table"));
  }
  std::vector<Material> materials;
  const auto* materialBytes = find(parts, "materials");
  if (materialBytes == nullptr || !unpackMaterials(*materialBytes, materials)) {
    return fail(damaged(file, "materials"));
  }
  Instrument instrument;
  const auto* instrumentBytes = find(parts, "instrument");
  if (instrumentBytes == nullptr || !unpackInstrument(*instrumentBytes, instrument)) {
    return fail(damaged(file, "instrument"));
  }
  const auto* pairBytes = find(parts, "pairs");
  if (pairBytes != nullptr && !unpackPairs(*pairBytes, materials, instrument)) {
    return fail(damaged(file, "pairs"));
  }
  std::vector<GovernorLevel> levels;
  const auto* levelBytes = find(parts, "levels");
  if (levelBytes != nullptr && !unpackLevels(*levelBytes, levels)) {
    return fail(damaged(file, "levels"));
  }
  auto prepared = prepareScene(*scene, std::move(labels), table, materials, instrument, progress);
  if (!prepared || levels.empty()) return prepared;
  auto governed = withLevels(**prepared, std::move(levels));
  if (!governed) return fail(damaged(file, "levels"));
  return governed;
}

}  // namespace palpate
