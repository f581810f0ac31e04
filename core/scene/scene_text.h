#pragma once
/// A scene as the text of scene.toml, for files and for sessions that carry their scene.

#include <string>

#include "core/scene/scene.h"

namespace palpate {

[[nodiscard]] std::string sceneText(const Scene& scene);
/// `path` is only for messages.
[[nodiscard]] Result<Scene> sceneFromText(const std::string& text, const std::string& path);

}  // namespace palpate
