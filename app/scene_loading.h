#pragma once
/// From a case on disk to a scene that is ready to run: the wiring that `simulate`, `tradeoff` and
/// the desktop share.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/progress.h"
#include "core/simulation/prepared_scene.h"

namespace palpate {

/// What the user asked for over what scene.toml says.
struct SceneOverrides {
  std::optional<std::string> instrument, device;
};

/// What `import` writes into a new case: all labels, the ball burr, a simulated Touch X.
[[nodiscard]] Scene defaultScene();

/// Where a scene asks for reach = "device" and names no workspace: that of its device's model.
void knowWorkspace(Scene& scene);

/// Refuses a name that is none, with the list.
[[nodiscard]] Result<Instrument> instrumentNamed(const std::string& name,
                                                 const std::filesystem::path& datasets);

/// CASE (a folder) or SCENE (a scene.toml inside a case). A case without scene.toml gets the
/// default scene. Refuses a path that is neither, a case without labels, an unknown instrument
/// (with the list).
[[nodiscard]] Result<std::shared_ptr<const PreparedScene>> loadScene(
    const std::filesystem::path& caseOrScene, const std::filesystem::path& datasets,
    const SceneOverrides& overrides, const Progress& progress);

/// Only the scene file of CASE or SCENE, or the default where a case has none.
[[nodiscard]] Result<Scene> loadSceneFile(const std::filesystem::path& caseOrScene);

}  // namespace palpate
