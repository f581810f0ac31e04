#include "app/scene_loading.h"

#include <algorithm>
#include <utility>

#include "core/devices/arm_model.h"
#include "core/geometry/units.h"
#include "imaging/case_folder.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct Place {
  fs::path caseFolder;
  std::optional<fs::path> sceneFile;
};

/// A folder is a case; a file is a scene inside one.
Result<Place> placeOf(const fs::path& caseOrScene) {
  std::error_code error;
  if (fs::is_directory(caseOrScene, error)) {
    Place place{caseOrScene, {}};
    const fs::path scene = caseOrScene / "scene.toml";
    if (fs::is_regular_file(scene, error)) place.sceneFile = scene;
    return place;
  }
  if (fs::is_regular_file(caseOrScene, error)) {
    return Place{fs::absolute(caseOrScene, error).parent_path(), caseOrScene};
  }
  return fail(inputRefused("There is no case or scene of that name.")
                  .inFile(caseOrScene.string())
                  .wants("a case folder, or a scene.toml inside one")
                  .advise("Make a case with 'palpate import SCAN --out CASE'."));
}

Result<Scene> sceneAt(const Place& place) {
  return place.sceneFile ? readScene(*place.sceneFile) : Result<Scene>(defaultScene());
}

std::string instrumentNames(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

Result<Instrument> instrumentNamed(const std::string& name, const fs::path& datasets) {
  const fs::path folder = datasets / "instruments";
  const fs::path file = folder / (name + ".toml");
  std::error_code error;
  const bool plain = name.find('/') == std::string::npos;
  if (plain && fs::is_regular_file(file, error)) return readInstrument(file);
  return fail(inputRefused("There is no instrument of that name.")
                  .inField("instrument")
                  .butFound(name)
                  .wants("one of " + instrumentNames(folder))
                  .advise("Choose one with --instrument, or add a file to datasets/instruments."));
}

Scene defaultScene() {
  Scene scene;
  scene.name = "default";
  return scene;
}

void knowWorkspace(Scene& scene) {
  if (scene.reach != Reach::Device || scene.workspace) return;
  for (const ArmParameters& arm : armModels()) {
    if (arm.info.model != scene.device) continue;
    scene.workspace.emplace();
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      scene.workspace->least_mm[axis] = millimetres(arm.info.workspaceMin[a]);
      scene.workspace->most_mm[axis] = millimetres(arm.info.workspaceMax[a]);
    }
  }
}

Result<Scene> loadSceneFile(const fs::path& caseOrScene) {
  const Result<Place> place = placeOf(caseOrScene);
  if (!place) return fail(place.error());
  return sceneAt(*place);
}

Result<std::shared_ptr<const PreparedScene>> loadScene(const fs::path& caseOrScene,
                                                       const fs::path& datasets,
                                                       const SceneOverrides& overrides,
                                                       const Progress& progress) {
  const Result<Place> place = placeOf(caseOrScene);
  if (!place) return fail(place.error());
  Result<Scene> scene = sceneAt(*place);
  if (!scene) return fail(scene.error());
  if (overrides.instrument) scene->instrument = *overrides.instrument;
  if (overrides.device) scene->device = *overrides.device;

  knowWorkspace(*scene);

  const Result<Instrument> instrument = instrumentNamed(scene->instrument, datasets);
  if (!instrument) return fail(instrument.error());
  const Result<std::vector<Material>> materials = readMaterials(datasets / "materials.toml");
  if (!materials) return fail(materials.error());
  Result<LabelState> state = readCaseLabelState(place->caseFolder);
  if (!state) return fail(state.error());
  return prepareScene(*scene, std::make_shared<const LabelGrid>(std::move(state->labels)),
                      state->table, *materials, *instrument, progress, place->caseFolder);
}

}  // namespace palpate
